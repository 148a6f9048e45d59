"""The FMU `PlantCorner`: order 4 through contact with two walls, whichever is met first, or both at one instant.

The truth is that of `tests.convergence.corner`. What one wall alone does is tested in `tests.convergence.test_plant`.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from adaptimp_fmu import build
from fmus.plant import plant
from tests.convergence.corner import CornerThrow
from tests.convergence.test_plant import ALL, FLOOR, LEVELS, ORDER, slope, throw_start
from tests.convergence.truth import ATOL, MAX_STEP, RTOL, crossing, solve
from tests.driver import Driver
from tests.property.samples import EPS

Open = Callable[..., Driver]

FIRST = CornerThrow(v=(-1.5, 0.4), turn=-0.6, turn2=0.9, distance=0.012, distance2=0.013)
SECOND = replace(FIRST, distance=0.016, distance2=0.009)
ROUGH = replace(SECOND, mu=0.3, mu2=0.2, friction_velocity=0.3, friction_velocity2=0.3, viscous=(0.5, 0.3))
DAMPED = replace(ROUGH, D_f=5.0, D_f2=2.0, tau=(-64.0, -7.0), K_f2=5e4)
END = 2.0**-5  # s, after both contacts


@pytest.fixture(scope="module")
def corner(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU `PlantCorner`."""
    return build(plant(name="PlantCorner", walls=2), tmp_path_factory.mktemp("corner"))


def corner_start(throw: CornerThrow) -> dict[str, float]:
    """Return the start values of the FMU `PlantCorner` for a throw."""
    second = throw.second
    values = {f"wall_normal2[{i + 1}]": float(second.normal[i]) for i in range(2)}
    values |= {f"{name}2": getattr(second, name) for name in ("K_f", "D_f", "mu", "friction_velocity")}
    return throw_start(throw) | values | {"wall_offset2": second.offset}


def end(driver: Driver, throw: CornerThrow, T: float, dt_max: float) -> np.ndarray:
    """Return the state (q, dq) at T, s, after a single step, shape (4,)."""
    driver.initialize(corner_start(throw) | {"dt_max": dt_max})
    driver.step(0.0, T)
    final = driver.get("q[1]", "q[2]", "dq[1]", "dq[2]")
    driver.close()
    return final


def together(throw: CornerThrow) -> CornerThrow:
    """Return the throw with its second wall moved to where the tip is at the instant when it meets the first one."""
    free = dict.fromkeys(throw.indicators, False)
    flight = solve_ivp(
        lambda _, y: throw.derivative(y, free),
        (0.0, END),
        throw.start,
        "DOP853",
        events=crossing(throw.gap, rising=True),
        rtol=RTOL,
        atol=ATOL,
        max_step=MAX_STEP,
    )
    moved = throw.tip(flight.y[:2, -1]) - throw.tip(throw.start[:2])
    return replace(throw, distance2=float(throw.second.normal @ moved))


def later(throw: CornerThrow, distance: float) -> CornerThrow:
    """Return the throw with its first wall moved away by a distance, m."""
    return replace(throw, distance=throw.distance + distance)


SLIDE = ["+contact2", "+contact"]
ONE_INSTANT = ["+contact", "+contact2"]
LEAVE = ["-contact", "-contact2"]
CASES = {
    "first wall first": (FIRST, [*ONE_INSTANT, "-contact2"]),
    "second wall first": (SECOND, [*ONE_INSTANT, "-contact2", "-contact"]),
    "friction": (ROUGH, [*ONE_INSTANT, *LEAVE]),
    "damping, one stiffness half the other": (DAMPED, ONE_INSTANT),
    "both at one instant": (together(FIRST), [*ONE_INSTANT, *LEAVE]),
    "both at one instant, friction": (together(ROUGH), [*ONE_INSTANT, *LEAVE]),
    "both at one instant, damping": (together(DAMPED), [*ONE_INSTANT, "-pushing"]),
    "one 20 us after the other": (later(together(FIRST), 3e-5), [*SLIDE, *LEAVE]),
}


@cache
def truth(name: str) -> tuple[np.ndarray, list[str]]:
    """Return the state of the reference at the end of a case, and the events on the way."""
    return solve(CASES[name][0], END)


@pytest.mark.parametrize("name", CASES)
def test_order_is_4_through_contact_with_two_walls(open_fmu: Open, corner: Path, name: str) -> None:
    throw, events = CASES[name]
    expected, seen = truth(name)
    assert seen == events  # the case is what its name says
    errors = [float(np.abs(end(open_fmu(corner), throw, END, dt) - expected).max()) for dt in LEVELS]
    assert min(errors) > FLOOR
    assert slope(LEVELS, errors) >= ORDER, errors


@pytest.mark.parametrize("name", ["both at one instant", "one 20 us after the other"])
def test_the_error_goes_down_to_rounding(open_fmu: Open, corner: Path, name: str) -> None:
    # The truncation error at 1.5e-5 s is 4^-4 of that at 6e-5 s, which is 2.1e-9: 8e-12. The rest is rounding, FLOOR.
    assert np.abs(end(open_fmu(corner), CASES[name][0], END, 2.0**-16) - truth(name)[0]).max() <= 8e-12 + FLOOR


def shown(driver: Driver, start: dict[str, float], names: list[str]) -> np.ndarray:
    """Return outputs at the start and after each of 64 steps of 2^-11 s, shape (65, n_names)."""
    driver.initialize(start)
    rows = [driver.get(*names)]
    for k in range(64):
        driver.step(k * 2.0**-11, 2.0**-11)
        rows.append(driver.get(*names))
    return np.array(rows)


def pair(name: str) -> list[str]:
    """Return the names of both elements of a vector."""
    return [f"{name}[1]", f"{name}[2]"]


def test_with_a_wall_far_away_it_is_the_plant_to_the_last_bit(open_fmu: Open, corner: Path) -> None:
    names = [n for v in ("q", "dq", "ddq", "x", "dx", "F_ext") for n in pair(v)] + ["gap", "penetration"]
    alone = shown(open_fmu("Plant"), throw_start(ALL), names)
    far = {"wall_normal2[1]": 1.0, "wall_normal2[2]": 0.0, "wall_offset2": 100.0, "mu2": 0.3, "D_f2": 1e-3}
    assert (alone[:, names.index("penetration")] > 0).any()
    # The force of the far wall is +0 or -0, so only the sign of a zero may differ.
    np.testing.assert_array_equal(shown(open_fmu(corner), throw_start(ALL) | far, names), alone)


def test_one_wall_declared_twice_is_one_wall_of_both_stiffnesses(open_fmu: Open, corner: Path) -> None:
    """Both gaps have the same bits, so that all events of both walls happen at one instant."""
    names = [*pair("q"), *pair("dq"), *pair("F_ext")]
    whole = shown(open_fmu("Plant"), throw_start(ALL), names)
    numbers = throw_start(ALL)
    twice = {f"{n}2": numbers[n] for n in ("wall_offset", "D_f", "mu", "friction_velocity")}
    twice |= {f"wall_normal2[{i}]": numbers[f"wall_normal[{i}]"] for i in (1, 2)}
    halves = {"K_f": numbers["K_f"] / 2, "K_f2": numbers["K_f"] / 2}
    found = shown(open_fmu(corner), numbers | twice | halves, [*names, *pair("F_wall"), *pair("F_wall2")])
    assert (found[:, 6:8] != 0).any()
    np.testing.assert_array_equal(found[:, 6:8], found[:, 8:10])
    # A crossing is located to 4 EPS of a sub-step, and rounding is multiplied by sqrt(K_f / m) T = 10 at most.
    np.testing.assert_allclose(found[:, :4], whole[:, :4], rtol=0, atol=1e4 * EPS)
    np.testing.assert_allclose(found[:, 4:6], whole[:, 4:6], rtol=0, atol=1e4 * EPS * numbers["K_f"])


@pytest.mark.parametrize("throw", [SECOND, together(FIRST), together(DAMPED)])
def test_the_mirrored_arm_in_the_mirrored_corner_moves_as_the_arm_does(
    open_fmu: Open, corner: Path, throw: CornerThrow
) -> None:
    """The mirror swaps the walls, so the events that one run locates first are those that the other locates last."""
    names = [*pair("q"), *pair("dq"), *pair("F_wall"), *pair("F_wall2"), "gap", "gap2"]
    start = corner_start(replace(throw, gravity=0.0))
    mirrored = start | {name: -start[name] for v in ("q_start", "dq_start", "tau") for name in pair(v)}
    numbers = ("wall_normal[1]", "wall_offset", "K_f", "D_f", "mu", "friction_velocity")
    for name in numbers:
        other = name.replace("[1]", "2[1]") if "[" in name else f"{name}2"
        mirrored[name], mirrored[other] = start[other], start[name]
    mirrored |= {"wall_normal[2]": -start["wall_normal2[2]"], "wall_normal2[2]": -start["wall_normal[2]"]}
    one, other = (shown(open_fmu(corner), values, names) for values in (start, mirrored))
    assert (one[:, 8] > 0).any()
    assert (one[:, 9] > 0).any()
    np.testing.assert_allclose(other[:, :4], -one[:, :4], rtol=0, atol=1e4 * EPS)
    force = 1e4 * EPS * throw.K_f
    np.testing.assert_allclose(other[:, 4:6], one[:, 6:8] * [1.0, -1.0], rtol=0, atol=force)
    np.testing.assert_allclose(other[:, 6:8], one[:, 4:6] * [1.0, -1.0], rtol=0, atol=force)


def test_on_the_bisector_both_walls_take_the_same_force(open_fmu: Open, corner: Path) -> None:
    throw = CornerThrow(v=(-1.5, 0.0), turn=-np.pi / 4, turn2=np.pi / 4, distance=-0.01, distance2=-0.01)
    driver = open_fmu(corner)
    driver.initialize(corner_start(throw))
    first, second, whole = (driver.get(*pair(name)) for name in ("F_wall", "F_wall2", "F_ext"))
    rounding = 20 * EPS * throw.K_f  # N; the gap is known to some EPS times 1 m
    assert abs(first @ throw.normal - 1000.0) <= rounding
    assert abs(second @ throw.second.normal - 1000.0) <= rounding
    np.testing.assert_allclose(whole, [-2 * 1000.0 * np.cos(np.pi / 4), 0.0], rtol=0, atol=2 * rounding)
    np.testing.assert_array_equal(whole, first + second)


@pytest.mark.parametrize("throw", [FIRST, SECOND, together(FIRST)])
def test_a_corner_without_damping_keeps_the_energy(open_fmu: Open, corner: Path, throw: CornerThrow) -> None:
    errors = []
    for dt in LEVELS:
        states = shown(open_fmu(corner), corner_start(throw) | {"dt_max": dt}, [*pair("q"), *pair("dq")])
        energies = np.array([throw.energy(state) for state in states])
        assert max(min(throw.gap(s), throw.second.gap(s)) for s in states) > 1e-3  # the tip was in both walls at once
        errors.append(float(np.abs(energies - energies[0]).max()))
    kinetic = 0.5 * throw.start[2:] @ throw.inertia(np.array(throw.q)) @ throw.start[2:]
    # As in `test_plant`, for the faster of the two swings of the tip between both springs, each of half a period.
    J, n = throw.jacobian(np.array(throw.q)), np.stack([throw.normal, throw.second.normal])
    mobility = J @ np.linalg.solve(throw.inertia(np.array(throw.q)), J.T)
    w = np.sqrt(throw.K_f * np.linalg.eigvalsh(n @ mobility @ n.T).max())
    assert errors[-1] <= 2 * 2 * np.pi / 72 * (w * LEVELS[-1]) ** 5 * kinetic + 100 * EPS * kinetic, (
        errors,
        w,
        kinetic,
    )
    assert slope(LEVELS, errors) >= ORDER
