"""The tick rule (DESIGN, semantics 2) on one FMU: no tick missed, none doubled, by exact arithmetic.

The FMU counts: tick k shows k. A host's clock gives times t and steps h as doubles that only
approximate what it means, a whole number of nanoseconds or a ratio; the truth is the number of
ticks in [0, position), position being that exact sum. After the step it shows one less.
"""

import ctypes as ct
import math
from collections.abc import Callable
from itertools import accumulate

import numba
import numpy as np
import pytest

from adaptimp_fmu import SampledModel, build
from tests.conformance.binary import ERROR, OK, Binary, Instance
from tests.conformance.scenes import scene

TICKS = 1_000_000
Clock = Callable[[np.ndarray, float], tuple[np.ndarray, np.ndarray]]
Create = Callable[..., Instance]


def counter() -> SampledModel:
    """A model that counts: n becomes n + 1 at each tick; it shows n, its time, and what the input was."""
    model = SampledModel("Counter", "Counts its ticks")
    u = model.input("u", 0.0, description="Sampled at each tick")
    n = model.state("n", u * 0)
    model.update(n, n + 1)
    model.output("n", n, description="Number of this tick", scalar=True)
    model.output("t", model.time, unit="s", description="Time of this tick", scalar=True)
    model.output("u_held", u, description="Input at this tick", scalar=True)
    return model


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Binary:
    """The counting FMU."""
    folder = tmp_path_factory.mktemp("counter")
    return Binary(build(counter(), folder), folder / "unpacked")


@pytest.fixture(scope="module")
def count(fmu: Binary) -> Callable[[Instance, np.ndarray, np.ndarray], np.ndarray]:
    """Takes all steps in compiled code: what is shown after each, shorter where a step fails."""
    # Pointers are passed as integers of their size, which numba can compute.
    pointer = ct.c_size_t
    step = ct.CFUNCTYPE(ct.c_int, pointer, ct.c_double, ct.c_double, ct.c_int)(address(fmu, "fmi2DoStep"))
    get = ct.CFUNCTYPE(ct.c_int, pointer, pointer, pointer, pointer)(address(fmu, "fmi2GetReal"))

    @numba.njit
    def loop(component: int, t: np.ndarray, h: np.ndarray, reference: np.ndarray) -> np.ndarray:
        shown, value = np.empty(len(t), np.int64), np.empty(1)
        for i in range(len(t)):
            if step(component, t[i], h[i], 1) != 0:
                return shown[:i]
            get(component, reference.ctypes.data, 1, value.ctypes.data)
            shown[i] = np.int64(value[0])
        return shown

    def run(instance: Instance, t: np.ndarray, h: np.ndarray) -> np.ndarray:
        reference = np.array([fmu.variables["n"].valueReference], np.uint32)
        assert instance.component is not None
        return loop(instance.component, t, h, reference)

    return run


def address(fmu: Binary, function: str) -> int:
    """Address of a C function."""
    return ct.cast(fmu[function], ct.c_void_p).value or 0


# Clocks: from the ends of the steps in units of `unit` seconds (integers), start included.


def exact(position: np.ndarray, unit: float) -> tuple[np.ndarray, np.ndarray]:
    """Every time and step is the double nearest to what is meant."""
    return position[:-1] * unit, np.diff(position) * unit


def summed(position: np.ndarray, unit: float) -> tuple[np.ndarray, np.ndarray]:
    """The next time is t + h."""
    h = np.diff(position) * unit
    return np.concatenate(([0.0], np.cumsum(h)[:-1])), h


def rounded(position: np.ndarray, unit: float) -> tuple[np.ndarray, np.ndarray]:
    """Times are rounded to a nanosecond, and a step is the difference of two of them (libcosim)."""
    t = np.round(position * unit, 9)
    return t[:-1], np.diff(t)


CLOCKS = [exact, summed, rounded]


def positions(period: int, step: int) -> np.ndarray:
    """Ends of equal steps that cover the ticks, in the unit of period and step."""
    return np.arange(TICKS * period // step + 2, dtype=np.int64) * step


def expected(position: np.ndarray, period: int) -> np.ndarray:
    """What the last tick in [0, position) shows: ceil(position / period) - 1."""
    return -(-position[1:] // period) - 1


def assert_counts(shown: np.ndarray, truth: np.ndarray, instance: Instance) -> None:
    """Every tick of the truth, no other, and at least a million of them."""
    assert len(shown) == len(truth), instance.last
    wrong = np.flatnonzero(shown != truth)
    assert not len(wrong), f"first at step {wrong[0]}: shows {shown[wrong[0]]}, not {truth[wrong[0]]}"
    assert truth[-1] >= TICKS - 1


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize(
    ("period", "step", "unit"),
    [
        pytest.param(100_000, 50_000, 1e-9, id="half"),
        pytest.param(100_000, 100_000, 1e-9, id="equal"),
        pytest.param(100_000, 300_000, 1e-9, id="triple"),
        pytest.param(100_000, 70_000, 1e-9, id="seven tenths"),
        pytest.param(300_000, 100_000, 1e-9, id="a third"),
        pytest.param(1_000_000, 999_999, 1e-9, id="just less"),
        pytest.param(1_000_000, 1_000_001, 1e-9, id="just more"),
        pytest.param(1000, 700, 1e-9, id="a microsecond"),
        pytest.param(10, 7, 1e-3, id="ten milliseconds"),
    ],
)
def test_ticks_of_equal_steps(
    fmu: Binary, create: Create, count: Callable, clock: Clock, period: int, step: int, unit: float
) -> None:
    position = positions(period, step)
    instance = create(fmu, start={"sample_time": period * unit}).initialize()
    assert_counts(count(instance, *clock(position, unit)), expected(position, period), instance)


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("grid", [1, 10_000, 25_000], ids=["rarely together", "tenths", "quarters"])
def test_ticks_of_random_steps(fmu: Binary, create: Create, count: Callable, clock: Clock, grid: int) -> None:
    """Steps up to three periods long; on a grid they often end on a tick."""
    period, rng = 100_000, np.random.default_rng(1991)
    h = rng.integers(1, 3 * period // grid, size=TICKS, endpoint=True) * grid
    position = np.concatenate(([0], np.cumsum(h)))
    instance = create(fmu).initialize()
    assert_counts(count(instance, *clock(position, 1e-9)), expected(position, period), instance)


def test_ticks_of_steps_that_are_arbitrary_doubles(fmu: Binary, create: Create, count: Callable) -> None:
    """Summed exactly, as integers of 2^-80 s.

    Ends within 1e-9 of a tick count as that tick; a million of them come so near with probability
    0.002, and with this seed none does.
    """
    rng = np.random.default_rng(2005)
    h = rng.uniform(1e-6, 2e-4, size=TICKS)
    period = int(math.ldexp(1e-4, 80))
    sums = accumulate(int(math.ldexp(value, 80)) for value in h.tolist())
    truth = np.array([-(-total // period) - 1 for total in sums])
    t = np.concatenate(([0.0], np.cumsum(h)[:-1]))
    instance = create(fmu).initialize()
    shown = count(instance, t, h)
    assert len(shown) == len(truth), instance.last
    np.testing.assert_array_equal(shown, truth)


@pytest.mark.parametrize("t0", [-50.0, 1e3, 1e5])
@pytest.mark.parametrize("step", [50_000, 70_000, 100_000, 300_000])
def test_ticks_far_from_zero(fmu: Binary, create: Create, count: Callable, t0: float, step: int) -> None:
    """At 1e5 s a double resolves 1.5e-11 s, 1.5e-7 ticks: a step as a difference of times is off by that."""
    position = positions(100_000, step)
    t = t0 + position * 1e-9
    instance = create(fmu).initialize(t0=t0)
    assert_counts(count(instance, t[:-1], np.diff(t)), expected(position, 100_000), instance)


def test_ticks_survive_a_rollback(fmu: Binary, create: Create, count: Callable) -> None:
    """Every step is taken twice, from the saved state: the count is part of it."""
    period, step = 100_000, 70_000
    position = np.arange(2001, dtype=np.int64) * step
    t, h = exact(position, 1e-9)
    instance, shown = create(fmu).initialize(), []
    for i in range(len(t)):
        saved = instance.blob()
        count(instance, t[i : i + 1], h[i : i + 1])
        assert instance.restore(saved) == OK
        shown.append(count(instance, t[i : i + 1], h[i : i + 1])[0])
    np.testing.assert_array_equal(shown, expected(position, period))


def test_ticks_first_is_shown_before_it_runs(fmu: Binary, create: Create) -> None:
    instance = create(fmu).initialize(t0=0.5)
    assert instance.get("n", "t").tolist() == [0.0, 0.5]
    assert instance.step(1e-4) == OK
    assert instance.get("n", "t").tolist() == [0.0, 0.5]
    assert instance.step(1e-4) == OK
    assert instance.get("n", "t").tolist() == [1.0, 0.5 + 1e-4]


def test_ticks_sample_the_inputs_at_the_start_of_a_step(fmu: Binary, create: Create) -> None:
    """A tick at the start of a step uses the inputs just set; one at its end waits for the next."""
    instance = create(fmu).initialize()
    shown = []
    for k, h in enumerate([1.0, 1.0, 0.5, 0.5, 0.25, 2.5]):
        assert instance.set({"u": 10.0 + k}) == OK
        assert instance.step(h * 1e-4) == OK
        shown.append((instance.get("n")[0], instance.get("u_held")[0]))
    assert shown == [(0, 10), (1, 11), (2, 12), (2, 12), (3, 14), (5, 15)]


def test_ticks_are_at_whole_multiples_of_the_period(fmu: Binary, create: Create) -> None:
    """Tick k is at t0 + k Ts, rounded once each, however the host's clock drifts."""
    instance, t = create(fmu).initialize(t0=0.1), 0.1
    for k in range(3000):
        assert instance.step(1e-4, t) == OK
        t += 1e-4
        assert instance.get("t")[0] == 0.1 + k * 1e-4


def test_ticks_of_slow_states_are_every_nth(load: Callable[[str], Binary], create: Create) -> None:
    """Updated at ticks 0, 3, 6, ..., shown one tick later."""
    binary = load("CraigAdaptiveImpedance")
    estimates = [name for name in binary.names("output") if name.startswith("p_hat")]
    instance = create(binary, start=scene(binary) | {"update_divisor": 3}).initialize()
    rows = [instance.get(*estimates)]
    for _ in range(12):
        assert instance.step(1e-4) == OK
        rows.append(instance.get(*estimates))
    assert np.flatnonzero(np.diff(rows, axis=0).any(axis=1)).tolist() == [1, 4, 7, 10]


def test_ticks_too_many_for_one_step_are_an_error(fmu: Binary, create: Create) -> None:
    instance = create(fmu).initialize()
    assert instance.step(1e3) == OK, "1e7 ticks"
    assert instance.get("n")[0] == 1e7 - 1
    assert instance.step(1001.0) == ERROR
