"""Tests of rule 11: impossible experiments, steps and communication points are refused, others are accepted."""

import math
import time
from collections.abc import Callable

import pytest

from tests.conformance.binary import ERROR, OK, Binary, Instance
from tests.conformance.calls import assert_refused
from tests.conformance.container import CONTAINER, of_models
from tests.conformance.scenes import H

Create = Callable[..., Instance]
Load = Callable[[str], Binary]


def test_11_experiment_must_be_set_up(binary: Binary, create: Create) -> None:
    instance = create(binary)
    before = instance.blob()
    assert_refused(instance, instance.call("fmi2EnterInitializationMode"), before, "fmi2SetupExperiment")


@pytest.mark.parametrize(
    ("t0", "stop"), [(math.nan, None), (math.inf, None), (1.25, 1.125), (0.0, math.nan), (0.0, math.inf)]
)
def test_11_experiment_must_make_sense(load: Load, create: Create, t0: float, stop: float | None) -> None:
    instance = create(load("Actuator"))
    before = instance.blob()
    said = [f"{t0:.17g}"] if stop is None else [f"{t0:.17g}", f"{stop:.17g}"]
    assert_refused(instance, instance.setup(t0, stop), before, *said)


@pytest.mark.parametrize("h", [0.0, -0.0, -H, math.nan, math.inf, -math.inf])
def test_11_step_must_be_positive_and_finite(binary: Binary, create: Create, h: float) -> None:
    instance = create(binary).initialize(t0=0.3)
    before = instance.blob()
    assert_refused(instance, instance.step(h), before, f"{0.3:.17g} s", f"{h:.17g} s")
    assert instance.step(H) == OK


@pytest.mark.parametrize("t", [0.0, 0.4 + 2 * H, 5.0, -1e300, 1e300])
def test_11_communication_point_must_follow(binary: Binary, create: Create, t: float) -> None:
    instance = create(binary).initialize(t0=0.4)
    assert instance.step(H) == OK
    before = instance.blob()
    assert_refused(instance, instance.step(H, t), before, f"{t:.17g} s", f"{0.4 + H:.17g} s")
    assert instance.step(H) == OK


@pytest.mark.parametrize("skipped", [0.5, 1.0, -1.0])
@pytest.mark.parametrize("t0", [0.0, 1e5, -1e6, 1e7])
def test_11_a_step_that_is_left_out_is_noticed(binary: Binary, create: Create, t0: float, skipped: float) -> None:
    """A tolerance of 1e-9 |t| alone is as long as a step of 1e-4 s at t = 1e5 s."""
    instance = create(binary).initialize(t0=t0)
    assert instance.step(H) == OK
    before = instance.blob()
    t = t0 + (1 + skipped) * H
    assert_refused(instance, instance.step(H, t), before, f"{t:.17g} s", f"{t0 + H:.17g} s")
    assert instance.step(H, round(t0 + H, 9)) == OK
    assert instance.step(H, math.nextafter(t0 + 2 * H, math.inf)) == OK


@pytest.mark.parametrize("t", [math.nan, math.inf, -math.inf])
def test_11_communication_point_must_be_finite(binary: Binary, create: Create, t: float) -> None:
    instance = create(binary).initialize()
    before = instance.blob()
    assert_refused(instance, instance.step(H, t), before, f"{t:.17g} s", f"{H:.17g} s")


def test_11_summed_and_rounded_clocks_are_accepted(binary: Binary, create: Create) -> None:
    """A host may sum its time, or round it to a nanosecond; a nanosecond is 1e-9 max(1, |t|)."""
    h = H if binary.name == CONTAINER else H / 3
    for clock in (lambda k: round(100 + k * h, 9), lambda k: sum([h] * k, 100.0)):
        instance = create(binary).initialize(t0=100.0)
        assert all(instance.step(h, clock(k)) == OK for k in range(300)), instance.last


def test_11_no_step_past_the_stop_time(binary: Binary, create: Create) -> None:
    instance = create(binary).initialize(stop=3 * H)
    assert instance.step(2 * H) == OK
    before = instance.blob()
    assert_refused(instance, instance.step(2 * H), before, f"{4 * H:.17g} s", f"{3 * H:.17g} s")
    assert_refused(instance, instance.step(1e300), before, "1e+300", f"{3 * H:.17g} s")
    assert instance.step(H) == OK
    before = instance.blob()
    assert_refused(instance, instance.step(H), before, "stop time")


def test_11_a_summed_clock_reaches_the_stop_time(binary: Binary, create: Create) -> None:
    instance, t = create(binary).initialize(stop=0.1), 0.0
    for _ in range(1000):
        assert instance.step(H, t) == OK, instance.last
        t += H


@pytest.mark.parametrize("h", [1.1e3, 1e9, 1e300, 1.7e308])
def test_11_a_huge_step_is_refused_at_once(binary: Binary, create: Create, h: float) -> None:
    """More than 1e7 ticks or sub-steps of 1e-4 s: minutes of work; refusing takes microseconds of the processor."""
    instance = create(binary).initialize()
    start = time.thread_time()
    assert instance.step(h) == ERROR
    assert time.thread_time() - start < 1  # s of this thread, whatever else the machine does
    assert f"{h:.17g} s" in instance.last
    assert f"{H:.17g} s" in instance.last
    assert instance.call("fmi2Reset") == OK
    instance.initialize()
    assert instance.step(H) == OK


@of_models
def test_11_a_tiny_sample_time_is_refused_at_once(binary: Binary, create: Create) -> None:
    period = "sample_time" if "sample_time" in binary.variables else "dt_max"
    instance = create(binary, start={period: 1e-12}).initialize()
    start = time.thread_time()
    assert instance.step(1.0) == ERROR
    assert time.thread_time() - start < 1  # s of this thread, whatever else the machine does
    assert period in instance.last
