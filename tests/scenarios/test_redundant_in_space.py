"""Seven joints do a task of six coordinates: the Panda on a table, with a payload that its controllers do not know.

The conventional law by form (5) needs damping in the null space. Algorithm 2, extended beyond the paper to redundant
arms, finds the payload. Repulsion keeps a joint from the end of its range, at the cost of the tip only where the null
space offers no way around.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import build
from fmus.catalog import unit_of_arm
from orchestration import Result, System
from tests.property.spatial_robots import robot
from tests.scenarios.adaptive import run

STEP = 1e-4  # s
HOGAN, SLOTINE_LI = "HoganImpedance", "SlotineLiAdaptiveImpedance"
PANDA = robot("Panda")
OTHERS = {
    "trajectory": "VirtualTrajectory",
    "sensor": "ForceSensor",
    "actuator": "Actuator",
    "plant": "Plant",
}
FREE = {"controller.null_damping": 0.0, "controller.null_stiffness": 0.0}


@cache
def fmu(unit: str) -> Path:
    """The FMU of a unit of the arm, built or from the cache."""
    return build(unit_of_arm(unit, PANDA, "Panda"))


@cache
def _result(controller: str, changes: tuple[tuple[str, float], ...]) -> Result:
    order = ("trajectory", "sensor", "controller", "actuator", "plant")
    fmus = {name: fmu(OTHERS.get(name, controller)) for name in order}
    system = System.connected_by_name("panda", fmus, stop_time=2.0)
    return run(system.set(dict(changes)).with_sample_time(STEP))


def result(controller: str, changes: Mapping[str, float] | None = None) -> Result:
    """Once around the ellipse, 2 s."""
    return _result(controller, tuple((changes or {}).items()))


def largest(made: Result, name: str) -> np.ndarray:
    """Largest absolute value of each element."""
    return np.abs(made[name]).max(axis=0)


def near_the_end_of(joint: int, name: str, end: float) -> dict[str, float]:
    """Parameters for a repulsion of all joints, and another end of the range of one."""
    every = {f"controller.limit_{what}[{i + 1}]": value for i in range(7) for what, value in SPRING.items()}
    return every | {f"controller.{name}[{joint}]": end}


SPRING = {"stiffness": 2000.0, "damping": 100.0}


def test_the_tip_does_its_task_whatever_the_null_space_does() -> None:
    """Until a joint hits its stop, which an undamped null space brings about."""
    damped, free = result(HOGAN), result(HOGAN, FREE)
    lower, upper = map(np.array, PANDA.joints.ranges)
    beyond = [np.any((made["plant.q"] < lower) | (made["plant.q"] > upper), axis=1) for made in (damped, free)]
    assert not beyond[0].any()
    crash = int(np.argmax(beyond[1]))
    assert 1.0 < free.time[crash] < 1.6
    for made, rows in ((damped, slice(None)), (free, slice(crash))):
        assert 0.6 < made.time[np.flatnonzero(made["plant.F_ext"][:, 2])[0]] < 0.8  # s: the tool meets the table
        # The weight of the unknown payload, 7.8 N, pulls against K = 4000 N/m; its moment, below 0.8 N.m at the
        # payload's 0.05 m and some acceleration, against 90 N.m/rad.
        e = np.abs(made["controller.e"][rows]).max(axis=0)
        assert e[:3].max() < 7.8 / 4000
        assert e[3:].max() < 0.8 / 90
    assert largest(free, "plant.dq").max() > 5
    assert largest(damped, "plant.dq").max() < 1.2  # rad/s: those of the start, 0.98
    # The payload bends the posture, too.
    assert np.abs(damped["plant.q"][-1] - damped["plant.q"][0]).max() < 0.1


def test_algorithm_2_beyond_the_paper_finds_the_payload_and_the_target() -> None:
    conventional, adaptive = result(HOGAN), result(SLOTINE_LI)
    late = adaptive.time > 0.5
    errors = [np.abs(made["controller.e"][late]).max(axis=0) for made in (conventional, adaptive)]
    assert (errors[1] < 0.6 * errors[0]).all()
    assert np.median(errors[1] / errors[0]) < 0.2
    mass = adaptive["controller.p_hat"][-1][13 * 7]
    assert mass == pytest.approx(PANDA.payload.mass, rel=0.02)
    assert np.abs(adaptive["plant.q"][-1] - adaptive["plant.q"][0]).max() < 0.01
    assert np.abs(adaptive["controller.p_hat"][-1][: 13 * 7] - PANDA.p_start[: 13 * 7]).max() == 0  # known: Gamma = 0


def test_the_null_space_takes_a_joint_around_the_end_of_its_range() -> None:
    """Joint 1 turns up to 0.187 rad; a range that ends at 0.1 rad costs the tip nothing."""
    before, made = result(HOGAN), result(HOGAN, near_the_end_of(1, "q_max", 0.1))
    assert before["plant.q"][:, 0].max() > 0.18
    assert made["plant.q"][:, 0].max() < 0.02  # the margin begins at 0
    np.testing.assert_allclose(largest(made, "controller.e"), largest(before, "controller.e"), rtol=0.05)


def test_the_tip_leaves_its_target_where_there_is_no_way_around() -> None:
    """Joint 4, the elbow, sets the reach: it stops a little beyond the end of its range, and the tip pays."""
    before, made = result(HOGAN), result(HOGAN, near_the_end_of(4, "q_min", -2.4))
    assert before["plant.q"][:, 3].min() < -2.5
    assert -2.42 < made["plant.q"][:, 3].min() < -2.4
    assert largest(made, "controller.e")[:3].max() > 10 * largest(before, "controller.e")[:3].max()
    assert np.isfinite(made["plant.q"]).all()
