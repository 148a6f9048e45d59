"""The integrator in a plant in space keeps order 4 through contact of a tool and through stops, and makes no energy.

The truth is Pinocchio's dynamics, which DOP853 integrates from event to event (`tests.convergence.spatial_truth`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from orchestration.paper.built_fmus import built
from tests.convergence.spatial_truth import AXES, FREE, N, SpatialThrow, pin
from tests.convergence.truth import solve
from tests.driver import Driver
from tests.property.samples import EPS

STATE = [f"{name}[{i + 1}]" for name in ("q", "dq") for i in range(N)]
WRENCH = [f"F_ext[{i + 1}]" for i in range(N)]
Q = (0.1, -1.53, 3.16, 0.2, 1.62, -0.3)  # rad; the tool points down, and a little aside
STIFFNESS = (2.8e5, 5.9e5, 1e5, 1.8e4, 1.6e4, 1.9e4)  # N.m/rad
NORMAL = tuple(map(float, np.array([0.2, -0.1, -0.9]) / np.linalg.norm([0.2, -0.1, -0.9])))


def rates(throw: SpatialThrow, velocity: tuple[float, ...], turning: tuple[float, ...]) -> tuple[float, ...]:
    """Return the joint rates, rad/s, at which the contact point has a velocity, m/s, and the tip turns, rad/s."""
    frame = throw.model.getFrameId("touch")
    J = pin.computeFrameJacobian(throw.model, throw.data, np.array(throw.q), frame, AXES)
    return tuple(map(float, np.linalg.solve(J, [*velocity, *turning])))


TOOL = SpatialThrow(q=Q, contact_point=(0.06, -0.04, 0.05), wall_normal=NORMAL, distance=0.012)
SPRING = replace(TOOL, dq=rates(TOOL, (0.3, 0.2, -1.2), (0.5, -1.0, 0.8)))
ALL = replace(SPRING, D_f=2.0, mu=0.4)
AGAINST_STOPS = SpatialThrow(
    q=(0.3, -1.2, 3.0, 0.2, 1.2, 0.4),
    dq=(0.8, 1.2, -0.9, 2.0, -1.5, 2.5),
    q_min=(-FREE, -FREE, 2.985, -FREE, 1.17, -FREE),
    q_max=(0.31, -1.18, FREE, 0.24, FREE, 0.45),
    stop_stiffness=STIFFNESS,
    stop_damping=(1.0,) * N,
)

DURING, AFTER = 2.0**-6, 2.0**-4  # s: in contact, and after contact
CASES = {
    "spring, in contact": (SPRING, DURING, ["+contact"]),
    "spring, after": (SPRING, AFTER, ["+contact", "-contact"]),
    "everything, in contact": (ALL, DURING, ["+contact"]),
    "everything, after": (ALL, AFTER, ["+contact", "-contact"]),
    "a stop": (AGAINST_STOPS, DURING, ["+stop1"]),
    "all stops": (AGAINST_STOPS, 2.0**-5, [f"{s}stop{k}" for s, ks in (("+", "123465"), ("-", "132645")) for k in ks]),
}
LEVELS = [2.0**-k for k in range(10, 15)]
FLOOR = 5e-12  # as in tests/convergence/test_plant.py
ORDER = 3.8


@pytest.fixture(scope="module")
def opened() -> Iterator[Driver]:
    """One instance of the plant for all tests of the file."""
    plant = Driver(built("PlantPuma560"))
    yield plant
    plant.close()


@pytest.fixture
def plant(opened: Driver) -> Iterator[Driver]:
    """The plant, not initialized yet."""
    yield opened
    opened.call("fmi2Reset")


def begin(plant: Driver, throw: SpatialThrow, more: dict[str, float] | None = None) -> None:
    """Initialize the plant for a throw, whatever it did before."""
    plant.call("fmi2Reset")
    plant.initialize(throw.parameters | (more or {}))


def end(plant: Driver, throw: SpatialThrow, T: float, dt_max: float) -> np.ndarray:
    """Return the state at T, s, after a single step, shape (12,)."""
    begin(plant, throw, {"dt_max": dt_max})
    plant.step(0, T)
    return plant.get(*STATE)


@cache
def truth(name: str) -> tuple[np.ndarray, list[str]]:
    """Return the state of the reference at the end of a case, and the events on the way."""
    return solve(*CASES[name][:2])


@pytest.mark.parametrize("name", CASES)
def test_order_is_4_through_contact_and_stops(plant: Driver, name: str) -> None:
    throw, T, events = CASES[name]
    expected, seen = truth(name)
    assert seen == events  # the case is what its name says
    errors = [float(np.abs(end(plant, throw, T, dt) - expected).max()) for dt in LEVELS]
    assert min(errors) > FLOOR
    assert np.polyfit(np.log(LEVELS), np.log(errors), 1)[0] >= ORDER, errors


def test_the_contact_keeps_its_law_and_its_power(plant: Driver) -> None:
    """Never pulls, within the cone of friction, and as much power at the tip as at the point that touches."""
    throw = ALL
    begin(plant, throw)
    n, touched = np.array(throw.wall_normal), 0
    tip = throw.model.getFrameId("tip")
    for k in range(400):
        plant.step(k * 1e-4, 1e-4)
        state, wrench = plant.get(*STATE), plant.get(*WRENCH)
        force = wrench[:3]
        depth = throw.gap(state)
        # Lengths of 1 m are known to 10 EPS, and the wall is as stiff as K_f, times damping and friction.
        assert abs(plant.get("gap")[0] - depth) <= 20 * EPS
        expected = throw.force(state) if depth > 0 and throw.factor(state) > 0 else np.zeros(3)
        np.testing.assert_allclose(force, expected, rtol=0, atol=1e3 * EPS * throw.K_f)
        pushed = n @ force
        assert pushed >= 0
        assert np.linalg.norm(force - pushed * n) <= throw.mu * pushed * (1 + 1e-12)
        J = pin.computeFrameJacobian(throw.model, throw.data, state[:N], tip, AXES)
        at_tip, at_point = wrench @ (J @ state[N:]), force @ throw.place(state)[1]
        assert abs(at_tip - at_point) <= 100 * EPS * np.abs(wrench).max() * 10
        touched += pushed > 0
    assert touched > 100


@pytest.mark.parametrize("throw", [SPRING, AGAINST_STOPS], ids=["wall", "stops"])
def test_an_elastic_impact_keeps_the_energy(plant: Driver, throw: SpatialThrow) -> None:
    """What springs of wall and stops take they give back: without damping the energy swings by the errors of RK4."""
    elastic = replace(throw, stop_damping=(0.0,) * N)
    errors, total = [], elastic.energy(elastic.start)
    for dt in LEVELS[:4]:
        begin(plant, elastic, {"dt_max": dt})
        energies = [elastic.energy(plant.get(*STATE))]
        for k in range(64):
            plant.step(k * 2.0**-10, 2.0**-10)
            energies.append(elastic.energy(plant.get(*STATE)))
        errors.append(float(np.abs(np.array(energies) - total).max()))
    # RK4 changes the energy of an oscillator by an error of order 5, and that of coupled ones by one of order 4.
    assert np.polyfit(np.log(LEVELS[:4]), np.log(errors), 1)[0] >= ORDER, errors
    assert errors[-1] < 1e-7 * abs(total)


FALL = SpatialThrow(
    q=(0.3, -1.2, 3.0, 0.2, 1.2, 0.4),
    q_min=(-2.79, -3.93, -0.785, -1.92, -1.745, -4.64),
    q_max=(2.79, 0.785, 3.93, 2.97, 1.745, 4.64),
    stop_stiffness=STIFFNESS,
    stop_damping=(1.0,) * N,
    distance=3.0,
)


def fall(plant: Driver, viscous: Sequence[float], steps: int) -> tuple[np.ndarray, np.ndarray]:
    """States (q, dq), shape (steps, 12), and torques of the stops, N.m, shape (steps, 6), of an arm without torque."""
    begin(plant, FALL, {f"p[{61 + i}]": value for i, value in enumerate(viscous)})
    rows = []
    for k in range(steps):
        plant.step(k * 1e-3, 1e-3)
        rows.append(plant.get(*STATE, *(f"tau_stop[{i + 1}]" for i in range(N))))
    found = np.array(rows)
    return found[:, : 2 * N], found[:, 2 * N :]


def test_an_arm_that_falls_on_its_stops_never_gains_energy(plant: Driver) -> None:
    states, stops = fall(plant, (0.0,) * N, 3000)
    energies = np.array([FALL.energy(state) for state in states])
    # RK4 takes energy from a smooth motion; a step rounds 40 J by some EPS.
    assert np.diff(energies).max() <= 100 * EPS * 40
    assert energies[0] - energies[-1] > 10  # J, that the stops took
    assert (stops[:, 1] < -1000).any()  # N.m: joint 2 hit its upper end


def test_stops_never_pull(plant: Driver) -> None:
    states, stops = fall(plant, (0.0,) * N, 3000)
    q = states[:, :N]
    lower, upper = np.array(FALL.q_min), np.array(FALL.q_max)
    assert (stops[q >= upper] <= 0).all()
    assert (stops[q <= lower] >= 0).all()
    assert (stops[(q < upper) & (q > lower)] == 0).all()


def test_an_arm_that_lies_on_a_stop_stays_there(plant: Driver) -> None:
    """With friction the arm comes to rest: the stop of joint 2 holds its weight, as deep as its stiffness lets it."""
    states, stops = fall(plant, (30.0, 30.0, 20.0, 1.0, 1.0, 1.0), 12_000)
    q, dq = states[-1, :N], states[-1, N:]
    assert abs(dq[1]) < 1e-5  # rad/s
    assert np.abs(dq).max() < 0.05  # the light joints still swing
    held = pin.computeGeneralizedGravity(FALL.model, FALL.data, q)
    assert stops[-1, 1] == pytest.approx(held[1], abs=0.5)  # N.m, of what still moves
    assert held[1] < -20
    assert q[1] - FALL.q_max[1] == pytest.approx(-stops[-1, 1] / STIFFNESS[1], rel=0.05)
    resting = states[-4000:, 1] - FALL.q_max[1]
    assert (resting > 0).all()


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"q_min[3]": 4.0}, "q_min must be below q_max for each joint"),
        ({"q_start[5]": 1.8}, "q_start must be between q_min and q_max for each joint"),
        ({"q_max[1]": -0.5}, "q_start must be between q_min and q_max for each joint"),
    ],
)
def test_ranges_that_cannot_be_are_refused(plant: Driver, changed: dict[str, float], sentence: str) -> None:
    plant.set(changed)
    plant.enter()
    assert plant.instance.status("fmi2ExitInitializationMode") != 0
    assert any(sentence in text for text in plant.messages)
