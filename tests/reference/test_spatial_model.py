"""The reference of the arm in space agrees with physics and with SciPy, without an import from the project."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from tests.reference.segment import Solver

from .spatial.arm import JOINTS, TOOL, hold, moved, pin, puma, symmetric, ten_of_body
from .spatial.laws import HOGAN, Kinematics
from .spatial.loop import Plant, Setup, sensor_noise, virtual_trajectory
from .spatial.segment import Segment

Q = np.array([0.1, -1.2, 2.8, 0.4, 1.3, -0.6])
DQ = np.array([0.5, -0.4, 0.7, 1.0, -0.8, 0.6])
NONE3, NONE6 = (0.0,) * 3, (0.0,) * 6


def setup(**changed):
    """A setup of the arm at Q, moving with DQ, whose other numbers are plain ones; the wall is a table below it."""
    numbers = {
        "controller": HOGAN, "q_start": tuple(Q), "dq_start": tuple(DQ), "sample_time": 1e-4, "stop_time": 2.0,
        "gravity": (0.0, 0.0, -9.81), "reference_rpy": (np.pi, 0.0, np.pi), "coulomb_velocity": 1e-2,
        **dict.fromkeys(("viscous", "coulomb", "assumed_viscous", "assumed_coulomb"), NONE6),
        "payload_mass": 1.0, "payload_center": (0.02, 0.0, -0.05), "payload_inertia": (2e-3, 0, 2e-3, 0, 0, 1e-3),
        **dict.fromkeys(("contact_point", "orientation", "tilt", "sensor_position", "sensor_rpy", "task_rpy"), NONE3),
        "wall_normal": (0.0, 0.0, -1.0), "wall_offset": 0.04, "K_f": 1e5, "D_f": 0.0, "mu": 0.0,
        "friction_velocity": 1e-2, "center": (0.5, 0.15, 0.1), "plane_rpy": (np.pi, -np.pi / 2, 0.0),
        "semi_axis": (0.15, 0.2), "period": 2.0, "depth": 0.01, "noise_std": 0.0, "noise_bound": 0.0,
        "noise_period": 0.0, "contact_gated": 1.0, "seed": 0.0, "sensor_L": 0.15, "tau_max": (1e9,) * 6,
        "M": (2.0,) * 6, "B": (340.0,) * 6, "K": (4000.0,) * 6, "p_hat": (0.0,) * 10,
    }  # fmt: skip
    return Setup(**(numbers | changed))


SETUP = setup()
BODY = (1.3, (0.02, -0.01, 0.05), (2.2e-3, 3e-4, 2e-3, -2e-4, 1e-4, 1.2e-3))  # kg, m, kg.m2


def test_a_payload_is_pinocchios_body_at_the_tip():
    """The arm that holds ten parameters is the arm to which Pinocchio appends the body itself, at the tool's frame."""
    mass, center, six = BODY
    bare, appended = puma(SETUP.gravity), puma(SETUP.gravity)
    body = pin.Inertia(mass, np.array(center), symmetric(six))
    appended.appendBodyToJoint(JOINTS, body, pin.SE3(np.eye(3), np.array(TOOL)))
    held = hold(bare, ten_of_body(*BODY))
    tau = np.arange(6.0)
    both = [pin.aba(model, model.createData(), Q, DQ, tau) for model in (held, appended)]
    assert_allclose(both[0], both[1], rtol=1e-12)
    assert_allclose(ten_of_body(*BODY), body.toDynamicParameters(), rtol=1e-15, atol=1e-18)
    assert_allclose(
        moved(TOOL) @ body.toDynamicParameters(),
        pin.SE3(np.eye(3), np.array(TOOL)).act(body).toDynamicParameters(),
        rtol=1e-14,
        atol=1e-17,
    )


@pytest.mark.parametrize("reference", [(np.pi, 0.0, np.pi), (1.0, 0.3, -0.4)])
def test_rates_of_the_task_are_derivatives_of_the_coordinates(reference):
    """The rates J dq and J ddq + dJ dq are the central differences of x and dx along a motion of the joints."""
    kinematics, h = Kinematics(puma(SETUP.gravity), reference), 1e-5
    ddq = np.array([0.3, -0.2, 0.5, -0.4, 0.9, 0.1])
    at = {s: kinematics.tip(Q + s * h * DQ + (s * h) ** 2 / 2 * ddq, DQ + s * h * ddq) for s in (-1, 0, 1)}
    # Central differences err by h^2/6 of a third derivative of some 10, and by 1e-16/h of rounding.
    assert_allclose((at[1].x - at[-1].x) / (2 * h), at[0].dx, rtol=0, atol=1e-8)
    assert_allclose((at[1].dx - at[-1].dx) / (2 * h), at[0].J @ ddq + at[0].dJ @ DQ, rtol=0, atol=1e-7)


def test_a_wrench_has_the_power_of_its_force():
    """The power dx' F is v' f + w' m, with v and w of Pinocchio's velocity of the tip."""
    model = puma(SETUP.gravity)
    tip, wrench = Kinematics(model, (1.0, 0.3, -0.4)).tip(Q, DQ), np.array([3.0, -2.0, 5.0, 0.4, -0.3, 0.2])
    data = model.createData()
    pin.forwardKinematics(model, data, Q, DQ)
    twist = pin.getFrameVelocity(model, data, model.getFrameId("tip"), pin.LOCAL_WORLD_ALIGNED).vector
    assert_allclose(tip.dx @ tip.force(wrench), twist @ wrench, rtol=1e-12)


def start_above(depth_rate):
    """A plant whose contact point is 0.5 mm before the wall, and moves into it at `depth_rate`, m/s; and its state."""
    options = {"contact_point": (0.01, -0.02, 0.03), "D_f": 0.5, "mu": 0.3, "viscous": (0.5,) * 6}
    plant = Plant(setup(**options))
    place, _ = plant.touching(Q, DQ)
    plant = Plant(setup(wall_offset=-place[2] + 5e-4, **options))
    J = pin.computeFrameJacobian(plant.model, plant.data, Q, plant.touch, pin.LOCAL_WORLD_ALIGNED)[:3]
    dq = np.linalg.lstsq(J, np.array([0.2, 0.1, -depth_rate]), rcond=None)[0]
    return plant, np.concatenate([Q, dq])


@pytest.mark.parametrize("rate", [0.1, 0.5])
def test_a_bounce_agrees_with_solve_ivp(rate):
    """The segment's events and steps give what SciPy gives for a force law that is switched by the state itself."""
    plant, y = start_above(rate)
    tau, duration, events = np.zeros(6), 0.03, []
    segment = Segment(plant, Solver())
    segment.begin(y)
    end = y
    for _ in range(300):
        before = segment.contact
        end = segment.advance(end, tau, 1e-4)
        events += [segment.contact] if segment.contact != before else []
    assert events == [True, False][: len(events)] and events  # noqa: PT018 - one statement about one list

    def flow(_, y):
        gap, along = plant.event(0, y, y)
        return plant.flow(y, tau, gap > 0.0 and 1.0 + SETUP.D_f * along > 0.0)

    expected = solve_ivp(flow, (0.0, duration), y, "DOP853", rtol=1e-12, atol=1e-14, max_step=1e-5).y[:, -1]
    # SciPy steps across the corners of the force, where its steps of 1e-5 s err by dt^2 times the jump of the jerk,
    # K_f rate / m of some 1e4 m/s3 at the tip: 1e-6 m/s; halving such steps to its tolerance makes it far less.
    assert_allclose(end, expected, rtol=0, atol=1e-9)


def test_energy_is_conserved_without_friction():
    """Kinetic, gravity's and the spring's energy stay what they were, through a bounce without damping."""
    plant, y = start_above(0.3)
    plant = Plant(setup(wall_offset=plant.setup.wall_offset, contact_point=plant.setup.contact_point))
    segment, energies, touched = Segment(plant, Solver()), [], False
    segment.begin(y)
    for _ in range(300):
        q, dq = y[:JOINTS], y[JOINTS:]
        gap = plant.event(0, y, y)[0]
        touched |= gap > 0
        upper = np.triu(pin.crba(plant.model, plant.data, q))
        kinetic = 0.5 * dq @ (upper + np.triu(upper, 1).T) @ dq
        stored = pin.computePotentialEnergy(plant.model, plant.data, q) + 0.5 * SETUP.K_f * max(gap, 0.0) ** 2
        energies.append(kinetic + stored)
        y = segment.advance(y, np.zeros(6), 1e-4)
    assert touched
    # 300 segments round an energy of some 100 J to 1e-14 J each.
    assert_allclose(energies, energies[0], rtol=0, atol=1e-11)


def test_the_virtual_trajectory_is_clipped_and_tilts():
    """Derivatives are those of the path, which stays within `depth` of the wall; the angles come back."""
    given = setup(depth=0.004, tilt=(0.2, -0.3, 0.25), orientation=(0.1, 0.0, 0.0))
    h = 1e-4
    path = virtual_trajectory(given, np.arange(20001) * h)
    deepest = given.wall_offset + given.depth
    depth = path[:, 0, :3] @ given.wall_normal
    assert depth.max() <= deepest + 1e-15
    inside = depth >= deepest - 1e-12
    assert 1000 < np.count_nonzero(inside) < 2000
    assert not np.any(path[inside, 1:, 2])
    smooth = ~inside[1:-1] & ~inside[:-2] & ~inside[2:]
    for order in (1, 2):
        difference = (path[2:, order - 1] - path[:-2, order - 1]) / (2 * h)
        # h^2/6 of the third derivative, pi^3 times 0.2 m
        assert_allclose(difference[smooth], path[1:-1, order][smooth], rtol=0, atol=1e-7)
    assert_allclose(path[0, 0, 3:], given.orientation)
    assert_allclose(path[10000, 0, 3:], np.add(given.orientation, given.tilt), atol=1e-15)
    assert_allclose(path[-1, 0, 3:], given.orientation, atol=1e-15)


def test_the_noise_is_bounded_and_held():
    """No error (f, m / L) exceeds the bound, all six elements vary alike, and a draw serves its ticks."""
    noise = sensor_noise(setup(noise_std=5.0, noise_bound=30.0, noise_period=2e-4, seed=3.0), 20000)
    newtons = noise / np.array([1.0] * 3 + [0.15] * 3)
    assert np.linalg.norm(newtons, axis=1).max() <= 30.0
    # bound / sqrt(3) is 3.5 deviations, which takes less than 2 % from them; 10,000 draws scatter by 0.7 %.
    assert_allclose(newtons.std(axis=0), 5.0, rtol=0.05)
    assert_allclose(np.corrcoef(newtons.T), np.eye(6), atol=0.05)
    assert np.array_equal(noise[::2], noise[1::2])
    assert not np.array_equal(noise[0], noise[2])
