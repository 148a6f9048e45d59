"""Evidence for PlantPuma560: wrench at the wrist by Newton's and Euler's laws, moment of a contact, start values."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from fmus.catalog import model
from fmus.environment.joint_stops import FASTEST, SLOWEST, TRAVEL
from fmus.mechanics.joints import NONE
from fmus.plant import plant as declare_plant
from fmus.robots.puma560 import PUMA
from tests.convergence.spatial_truth import AXES, GRAVITY, pin
from tests.driver import Driver, RefusedError
from tests.property.samples import EPS
from tests.reference.spatial.arm import hold, puma, symmetric, ten_of_body
from tests.variant_files import file_of

N = 6
H = 1e-4  # s
MASS, CENTER, MOMENTS = 2.3, (0.05, -0.03, 0.08), (0.02, 0.001, 0.025, -0.002, 0.003, 0.015)
TOUCH = (0.04, 0.05, 0.11)
LOWEST, HIGHEST = PUMA.joints.ranges


@pytest.fixture(scope="module")
def opened() -> Iterator[Driver]:
    plant = Driver(file_of("PlantPuma560"))
    yield plant
    plant.close()


@pytest.fixture
def plant(opened: Driver) -> Iterator[Driver]:
    """The plant, not initialized yet."""
    yield opened
    opened.call("fmi2Reset")


def indexed(**vectors: object) -> dict[str, float]:
    """Values of the elements of vectors."""
    return {f"{name}[{i + 1}]": float(v) for name, vector in vectors.items() for i, v in enumerate(np.array(vector))}


def vector(plant: Driver, name: str) -> np.ndarray:
    """The six elements of an output."""
    return plant.get(*(f"{name}[{i + 1}]" for i in range(N)))


PAYLOAD = {"payload_mass": MASS} | indexed(payload_center=CENTER, payload_inertia=MOMENTS)


@pytest.mark.parametrize("seed", range(8))
def test_the_wrist_carries_payload_and_contact(plant: Driver, seed: int) -> None:
    """Newton's and Euler's laws about the centre of mass, and the moment of the contact about the tip."""
    rng = np.random.default_rng(seed)
    q, dq, tau = rng.uniform(LOWEST, HIGHEST), rng.uniform(-2, 2, N), rng.uniform(-50, 50, N)
    arm = hold(puma(GRAVITY, TOUCH), ten_of_body(MASS, CENTER, MOMENTS))
    data = arm.createData()
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    pin.framesForwardKinematics(arm, data, q)
    touching = data.oMf[arm.getFrameId("touch")].translation
    start = indexed(q_start=q, dq_start=dq, tau=tau, contact_point=TOUCH, wall_normal=normal)
    plant.initialize(PAYLOAD | start | {"wall_offset": normal @ touching - 2e-3, "mu": 0.5, "D_f": 0.1})
    for k in range(3):
        plant.step(k * H, H)
    q, dq, ddq, F_ext, F_wrist = (vector(plant, name) for name in ("q", "dq", "ddq", "F_ext", "F_wrist"))
    assert np.abs(F_ext[:3]).max() > 10  # N: the point is in the wall

    pin.forwardKinematics(arm, data, q, dq, ddq)
    pin.updateFramePlacements(arm, data)
    tip, touch = (arm.getFrameId(name) for name in ("tip", "touch"))
    w = pin.getFrameVelocity(arm, data, tip, AXES).angular
    acceleration = pin.getFrameClassicalAcceleration(arm, data, tip, AXES)
    R, lever = data.oMf[tip].rotation, data.oMf[touch].translation - data.oMf[tip].translation
    np.testing.assert_allclose(F_ext[3:], np.cross(lever, F_ext[:3]), rtol=0, atol=10 * EPS * np.abs(F_ext).max())

    c, I = R @ CENTER, R @ symmetric(MOMENTS) @ R.T
    a, dw = acceleration.linear, acceleration.angular
    force = MASS * (a + np.cross(dw, c) + np.cross(w, np.cross(w, c)) - GRAVITY)
    moment = I @ dw + np.cross(w, I @ w) + np.cross(c, force)
    expected = F_ext + np.concatenate([force, moment])
    # Accelerations follow from q and dq with the errors of both models: some hundred roundings of the largest.
    np.testing.assert_allclose(F_wrist, expected, rtol=0, atol=1e-12 * max(np.abs(expected).max(), np.abs(dw).max()))
    assert np.abs(F_wrist - F_ext).max() > 1


def test_without_a_payload_the_wrist_feels_the_contact_alone(plant: Driver) -> None:
    nothing = {"payload_mass": 0.0} | indexed(payload_inertia=[0.0] * 6)
    plant.initialize(nothing | {"wall_offset": -0.2} | indexed(contact_point=TOUCH))
    for k in range(20):
        plant.step(k * H, H)
        np.testing.assert_array_equal(vector(plant, "F_wrist"), vector(plant, "F_ext"))
    assert (vector(plant, "F_ext") != 0).any()


def test_a_contact_at_the_tip_has_no_moment(plant: Driver) -> None:
    plant.initialize({"wall_offset": -0.2, "mu": 0.3})
    plant.step(0.0, H)
    wrench = vector(plant, "F_ext")
    assert (wrench[:3] != 0).all()
    assert (wrench[3:] == 0).all()


def test_the_ranges_are_those_of_the_robot_and_stops_hold_its_torques() -> None:
    starts = {v.name: v.start or 0.0 for v in model("PlantPuma560").variables}
    assert [starts[f"q_min[{i + 1}]"] for i in range(N)] == LOWEST
    assert [starts[f"q_max[{i + 1}]"] for i in range(N)] == HIGHEST
    H_start = np.array(PUMA.arm.inertia(PUMA.start.q, PUMA.chain.p))
    against = 1 / np.diag(np.linalg.inv(H_start))
    for i, effort in enumerate(PUMA.joints.efforts):
        assert effort < NONE
        expected = np.clip(effort / TRAVEL, SLOWEST**2 * against[i], FASTEST**2 * against[i])
        assert starts[f"stop_stiffness[{i + 1}]"] == pytest.approx(expected, rel=0.05)  # two digits are kept


def test_two_walls_feel_the_same_point() -> None:
    robot: Any = PUMA  # its properties are cached, which the type checker takes for another protocol
    corner = declare_plant(robot, "Corner", walls=2)
    names = [variable.name for variable in corner.variables]
    assert [name for name in names if name.startswith("contact_point")] == [f"contact_point[{i}]" for i in (1, 2, 3)]
    assert {"F_wall[3]", "F_wall2[3]", "gap2", "F_wrist[6]"} <= set(names)
    assert [event.name for event in corner.events] == [f"stop{i + 1}" for i in range(N)] + [
        "contact", "pushing", "contact2", "pushing2",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("element", "sentence"),
    [
        (11, r"p\[11\] = -0\.5 must be at least 0 kg\."),
        (17, r"p\[17\] = -0\.5 must be at least 0 kg\.m2\."),
        (61, r"p\[61\] = -0\.5 must be at least 0 N\.m\.s/rad\."),
        (78, r"p\[78\] = -0\.5 must be at least 0 kg\.m2\."),
    ],
)
def test_what_no_arm_has_less_than_nothing_of_is_refused(plant: Driver, element: int, sentence: str) -> None:
    """Masses, moments about an axis, friction and rotors; first moments and products of inertia have both signs."""
    with pytest.raises(RefusedError, match=sentence):
        plant.initialize({f"p[{element}]": -0.5})
