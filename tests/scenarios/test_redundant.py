"""Claim C15: form (5) makes a redundant arm do the wall task; `null_damping` calms what the tip does not see.

Plant3R, HoganImpedance3R and Actuator3R come from the same definitions as their two-joint sisters.
"""

from functools import cache

import numpy as np
import pytest

from fmus import start
from orchestration import Result, System
from tests.scenarios.adaptive import files, norms, run

STEP = 1e-4  # s
DAMPING = 20.0  # 1/s
UNITS = {
    "trajectory": "VirtualTrajectory",
    "sensor": "ForceSensor",
    "controller": "HoganImpedance3R",
    "actuator": "Actuator3R",
    "plant": "Plant3R",
}
ARM = start.ARMS[3]


@cache
def result(null_damping: float) -> Result:
    """The wall task, 2 s."""
    fmus = {name: files()[identifier] for name, identifier in UNITS.items()}
    system = System.connected_by_name("redundant", fmus, stop_time=2.0)
    return run(system.set({"controller.null_damping": null_damping}).with_sample_time(STEP))


def kinematics(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """H (n, 3, 3) and J (n, 2, 3) of three point masses, from the velocities of the link ends; q (n, 3)."""
    angle, l = np.cumsum(q, axis=1), np.array(ARM.link_lengths)
    along = np.stack([-l * np.sin(angle), l * np.cos(angle)], axis=1)  # of a link at unit absolute rate, (n, 2, 3)
    ends = np.zeros((3, len(q), 2, 3))
    for i in range(3):
        for j in range(3):
            # End i moves with joint j through links j..i.
            ends[i, :, :, j] = along[:, :, j : i + 1].sum(axis=2)
    H = np.einsum("e,enki,enkj->nij", ARM.masses, ends, ends)
    return H, ends[2]


def null_space_rate(run_: Result) -> np.ndarray:
    """Norm of dq - H^-1 J' W^-1 dx, rad/s, W = J H^-1 J': what the tip does not see; shape (n_rows,)."""
    H, J = kinematics(run_["plant.q"])
    transposed = J.transpose(0, 2, 1)
    mobility = np.linalg.solve(H, transposed)
    task = np.linalg.solve(J @ mobility, run_["plant.dx"][..., None])
    return np.linalg.norm(run_["plant.dq"] - (mobility @ task)[..., 0], axis=1)


@pytest.mark.parametrize("null_damping", [0.0, DAMPING])
def test_a_redundant_arm_does_the_wall_task(null_damping: float) -> None:
    made = result(null_damping)
    x, force, e = made["plant.x"], norms(made, "plant.F_ext"), norms(made, "controller.e")
    touching = np.flatnonzero(force > 0)
    assert made.time[touching[0]] == pytest.approx(0.918, abs=0.005)  # s; the two-joint arm's contact
    assert made.time[touching[-1]] == pytest.approx(1.076, abs=0.005)
    assert x[touching[0], 1] > 0 > x[touching[-1], 1]  # down the wall, a to b
    assert 100 < force.max() < 1000  # N
    # True parameters: what is left is the force held for a tick. While it rises to its peak it is too small
    # by what it gains in half a tick, in all an impulse of Ts F / 2; a tip of at least the last mass takes it
    # up and (3) damps it.
    assert e.max() <= STEP * force.max() / (2 * ARM.masses[-1]) / (340.0 / 2.0)
    assert np.linalg.norm(x[-1] - [1.5, 0.0]) <= 1e-4


def test_the_joint_kinematics_here_are_the_plants() -> None:
    made = result(0.0)
    J = kinematics(made["plant.q"])[1]
    dx = np.einsum("nij,nj->ni", J, made["plant.dq"])
    # Rates up to 100 rad/s and lengths of 2 m: some ten roundings.
    np.testing.assert_allclose(dx, made["plant.dx"], rtol=0, atol=1e-12)


def test_damping_calms_the_null_space_and_not_the_tip() -> None:
    free, damped = result(0.0), result(DAMPING)
    rates = [null_space_rate(made) for made in (free, damped)]
    assert rates[0][0] == pytest.approx(rates[1][0])  # the same start
    largest = [rate.max() for rate in rates]
    rms = [float(np.sqrt((rate**2).mean())) for rate in rates]
    assert largest[1] < 0.25 * largest[0]
    assert rms[1] < 0.25 * rms[0]
    # The same TIRT but for the force, which is that of the tip: both tips lie within their e of one path in
    # free motion; through the bounces of 0.3 m/s the paths part by no more than both e.
    apart = np.linalg.norm(free["plant.x"] - damped["plant.x"], axis=1)
    assert apart.max() <= norms(free, "controller.e").max() + norms(damped, "controller.e").max()
    before = free.time < 0.9
    # The torque is held while the joints turn at up to 30 rad/s: e'' is wrong by 15 m/s2 * 30 rad/s * Ts / 2
    # at most, which K/M = 2000 1/s2 turns into 11 um of each.
    assert apart[before].max() <= 2.2e-5
