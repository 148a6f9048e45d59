"""The TIRT's distance from the virtual trajectory against closed forms, and against what the controller shows."""

import math

import numpy as np
import pytest

from orchestration.paper import tirt
from orchestration.paper.built_fmus import fmus
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.measure import at_ticks, contact, norms
from orchestration.paper.numbers import TARGET_INERTIA, TARGET_STIFFNESS
from orchestration.paper.scenarios import SCENARIOS

M, K = TARGET_INERTIA, TARGET_STIFFNESS
CRITICAL = 2 * math.sqrt(M * K)
DECAY = math.sqrt(K / M)  # of the critically damped impedance, 1/s
TIMES = np.arange(2001) * 1e-4


def test_a_constant_force_moves_it_as_the_step_response_says() -> None:
    """With B = 2 sqrt(M K) the step response is -F/K (1 - (1 + w t) exp(-w t))."""
    force = np.tile([30.0, -8.0], (len(TIMES), 1))
    expected = -force / K * (1 - (1 + DECAY * TIMES) * np.exp(-DECAY * TIMES))[:, None]
    assert tirt.driven(TIMES, force, CRITICAL, ()) == pytest.approx(expected, rel=1e-9, abs=1e-15)


def test_a_corner_between_ticks_moves_it_as_a_step_of_velocity_does() -> None:
    """With B = 2 sqrt(M K) a step v of d' gives v t exp(-w t), from the corner on and along x1 alone."""
    corner = tirt.Corner(time=0.04003, jump=0.7)
    found = tirt.driven(TIMES, np.zeros((len(TIMES), 2)), CRITICAL, (corner,))
    since = np.maximum(TIMES - corner.time, 0)
    assert found[:, 0] == pytest.approx(-0.7 * since * np.exp(-DECAY * since), rel=1e-9, abs=1e-15)
    assert not found[:, 1].any()


def test_the_corners_lie_where_the_ellipse_is_as_deep_as_the_segment() -> None:
    first, second = tirt.corners(1.4, 0.02)
    assert 1.5 * math.cos(math.pi * first.time) == pytest.approx(-1.42)
    assert 1.5 * math.cos(math.pi * second.time) == pytest.approx(-1.42)
    assert first.time < 1 < second.time
    slope = 1.5 * math.pi * math.sin(math.pi * first.time)
    assert (first.jump, second.jump) == pytest.approx((slope, slope))


def test_the_distance_that_the_controller_shows_without_a_force_is_that_of_its_prediction() -> None:
    """Before the contact d is zero, and the controller shows M h |d3x_v/dt3| / (2 K), its largest on the long axis."""
    scenario = SCENARIOS["fig3"]
    result = Laboratory(fmus(sorted(scenario.models.values()))).run(Job("fig3"))
    numbers = (scenario.values[name].number for name in ("controller.B[1]", "plant.wall_offset", "trajectory.depth"))
    exact = tirt.difference(result, *numbers)
    shown = at_ticks(result, "controller.x_t") - at_ticks(result, "trajectory.x_v")
    before = result.tick_times("controller.x_t[1]") < contact(result).first
    assert not exact[before].any()
    floor = tirt.sampling_offset(result.tick_times("controller.x_t[1]")).max()
    # The push at 0.5 s, and its response lags by B/K = 45 ms, on which the third derivative changes by a hundredth.
    assert norms(shown[before]).max() == pytest.approx(floor, rel=0.02)
    assert norms(exact - shown).max() < 1e-2 * norms(exact).max(), "of first order at the corner and in contact"
    assert norms(exact)[-1] < 1e-15 < norms(shown)[-1]
