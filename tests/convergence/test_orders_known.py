"""The order and the error of every algorithm, measured on problems with an exact solution.

The problems are those of `tests.reference.problems`. To test another algorithm, add a line to `ALGORITHMS`.

Inputs that are polynomials of degree p give order p + 1. The first step has no past. A first step that is only
extrapolated errs by the second power of the step. Outputs with direct feedthrough show this error in the rows of the
first step. With parallel exchange and parabolas the motion after the first step shows it, too.
"""

import numpy as np
import pytest

from orchestration import simulate
from orchestration.master.algorithm import FIXED_POINT, NEWTON, PARALLEL, SEQUENTIAL, Algorithm, Correction, Tolerance
from tests.reference.problems import PROBLEMS, damper_pair, force_displacement, wall

TIGHT = Tolerance(1e-12)  # tolerance of corrections; it adds less than a hundredth to every error here


def corrected(method: str, exchange: str, order: int) -> Algorithm:
    """Return an algorithm whose inputs are converged polynomials of degree `order`."""
    return Algorithm(f"{method} {exchange} {order}", exchange, order, Correction(method, TIGHT))


def str_of(algorithm: str | Algorithm) -> str:
    """Return the name of an algorithm."""
    return algorithm if isinstance(algorithm, str) else algorithm.name


ALGORITHMS: list[tuple[str | Algorithm, int]] = [  # algorithm, order
    ("jacobi", 1),
    ("gauss-seidel", 1),
    (Algorithm("sequential 1", SEQUENTIAL, 1), 2),
    (Algorithm("parallel 1", PARALLEL, 1), 2),
    *((corrected(FIXED_POINT, PARALLEL, order), order + 1) for order in (0, 1)),
    *((corrected(NEWTON, PARALLEL, order), order + 1) for order in (0, 1)),
    *((corrected(NEWTON, SEQUENTIAL, order), order + 1) for order in (0, 1, 2)),
]
PARABOLIC = [Algorithm("sequential 2", SEQUENTIAL, 2), Algorithm("parallel 2", PARALLEL, 2)]
LEVELS = 4
# The next term of the error is at most 0.1 of the first at the largest step (`Problem.span`), and halves with the step.
# The slope fitted to log2(1 + 0.1 / 2^i), i = 0..3, is 0.04. The bound is an estimate, so twice that is accepted.
SLOPE = 0.08
DAMPED = {"d1": 0.3, "d2": 0.2, "d_c": 0.5}  # N.s/m, rates up to 1/s beside modes of 6 rad/s
WALL = {"m": 2.0, "k": 50.0}


def cases() -> list[tuple[str, dict[str, float]]]:
    """Return every problem with its own numbers, and the problems with dampers also damped."""
    damped = ("force-displacement", "displacement-displacement")
    return [(name, {}) for name in PROBLEMS] + [(name, DAMPED) for name in damped]


def error(name: str, algorithm: str | Algorithm, level: int, numbers: dict[str, float], skipped: int = 0) -> float:
    """Return the largest error at the communication points of level 0, relative to the largest value of each output.

    The first `skipped` points are left out, because they show the error of a first step without a past.
    """
    problem = PROBLEMS[name]
    stop, step = problem.span
    result = simulate(problem.system(step / 2**level, stop, **numbers), algorithm=algorithm)
    exact = problem.exact(result.time, **numbers)
    rows = slice(skipped * 2**level, None, 2**level)
    return max(float(np.abs(result[o] - exact[o])[rows].max() / np.abs(exact[o]).max()) for o in exact)


@pytest.mark.parametrize(("algorithm", "order"), ALGORITHMS, ids=[str_of(a) for a, _ in ALGORITHMS])
@pytest.mark.parametrize(("name", "numbers"), cases())
def test_order(name: str, numbers: dict[str, float], algorithm: str | Algorithm, order: int) -> None:
    levels = LEVELS if order < 3 else 3  # beyond that, at 1e-10, the integration within the FMUs shows (`DT_MAX`)
    errors = [error(name, algorithm, level, numbers, skipped=0 if order == 1 else 4) for level in range(levels)]
    slope = -np.polyfit(np.arange(levels), np.log2(errors), 1)[0]
    assert abs(slope - order) <= SLOPE, (slope, errors)


@pytest.mark.parametrize("algorithm", PARABOLIC, ids=str_of)
@pytest.mark.parametrize(("name", "numbers"), cases())
def test_parabolas_lose_no_order(name: str, numbers: dict[str, float], algorithm: Algorithm) -> None:
    """Parabolas have at least the order of straight lines; how much more depends on the weight of the first step."""
    errors = [error(name, algorithm, level, numbers, skipped=4) for level in range(LEVELS)]
    slope = -np.polyfit(np.arange(LEVELS), np.log2(errors), 1)[0]
    assert slope >= 2 - SLOPE, (slope, errors)
    straight = Algorithm("straight", algorithm.exchange, 1)
    assert errors[-1] <= error(name, straight, LEVELS - 1, numbers, skipped=4)


@pytest.mark.parametrize(("algorithm", "factor", "second"), [("gauss-seidel", 1, -1 / 8), ("jacobi", 3, -29 / 24)])
@pytest.mark.parametrize("q", [1e-2, 1e-3, 1e-4])
def test_the_growth_in_the_step_map_is_the_formula(algorithm: str, factor: int, second: float, q: float) -> None:
    """The spectral radius rho of the step map is 1 + factor q / 4 (1 + second q + ...), with q = k h^2 / m.

    Gauss-Seidel has rho = sqrt(1 + q / 2). Jacobi (`tests.reference.problems.wall`) has s = r phi(s) with r^2 = -q and
    phi = exp(-3 s/4 + s^2/48 + ...). By Lagrange, the series of s has the terms -3/4 r^2 and -19/16 r^4. So
    Re s = 3 q/4 - 19 q^2/16, and rho - 1 = Re s + (Re s)^2 / 2.
    """
    h = np.sqrt(q * WALL["m"] / WALL["k"])
    miss = (wall.growth(algorithm, h, **WALL) - 1) / (factor * q / 4) - 1
    # The further terms grow by factors of about (19/16) / (3/4) 3/2 = 2.4, so 4 q^2 bounds them. Rounding of an
    # eigenvalue near 1 is divided by q / 4.
    assert abs(miss - second * q) <= 4 * q**2 + 100 * np.finfo(float).eps / q


@pytest.mark.parametrize(("algorithm", "h"), [("gauss-seidel", 8e-3), ("gauss-seidel", 4e-3), ("jacobi", 4e-3)])
def test_the_wall_grows_as_its_step_map(algorithm: str, h: float) -> None:
    growth = wall.growth(algorithm, h, **WALL) - 1
    # The logarithm of the energy swings around a line by at most A = 3 sqrt(q) / 2 (the delay 3 h / 2 times twice the
    # frequency, halved), by the angle 2 sqrt(q) in a step. This moves a fitted slope by at most
    # 12 A / (n^2 2 sqrt(q)) = 9 / n^2. Half of the slope is the growth; with n = 4 / growth it is off by 0.3 growth^2.
    # The second term of the series is above growth^2, so with Jacobi the formula for small h does not pass for the map.
    n = round(4 / growth)
    result = simulate(wall.system(h, n * h, **WALL), algorithm=algorithm)
    measured = np.polyfit(np.arange(n + 1), np.log(wall.energy(result, **WALL)), 1)[0] / 2
    assert np.expm1(measured) == pytest.approx(growth, rel=growth)


@pytest.mark.parametrize(("algorithm", "factor"), [("gauss-seidel", 1), ("jacobi", 3)])
def test_a_bounce_gains_speed_as_the_delay_says(algorithm: str, factor: int) -> None:
    """Contact lasts pi / w, so the speed is multiplied by 1 + factor pi w h / 4."""
    h, start = 2e-5, wall.BOUNCE
    w = np.sqrt(wall.Numbers().k)
    result = simulate(wall.system(h, 0.5, **start), algorithm=algorithm)
    gain = -result["mass.v"][-1] / start["v"] - 1
    # Contact begins and ends somewhere in a step. With Jacobi the force is off then by up to k v0 3 h / 2, on average
    # by half of it, for up to 3 h / 2, and this twice. In all this is 2.25 (w h)^2 of v0, or 0.95 w h = 2e-4 of the
    # formula. The next term of the formula is half the gain, 2.4e-4. Twice the sum of both is accepted; with
    # Gauss-Seidel both are smaller.
    assert gain == pytest.approx(factor * np.pi * w * h / 4, rel=1e-3)


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_every_step_is_the_step_map(algorithm: str) -> None:
    """Every step of a run is the step map, also in an unstable run: the damper pair at q = d_c h / m1 = 10."""
    columns = ["left.x", "left.v", "right.x", "right.v", "right.F"]
    for module, h, n in ((force_displacement, 1e-2, 400), (damper_pair, 1e-2, 40)):
        result = simulate(module.system(h, n * h), algorithm=algorithm)
        rows = np.column_stack([result[column] for column in columns])
        one = module.step_map(algorithm, h)
        # Runge-Kutta 4 misses exp(-r dt) by (r dt)^5 / 120 in each of n sub-steps: 10 with r dt = 6e-3, or 100 with
        # r dt = 1e-2, 8e-11. Each state has its own physical unit, so each is compared on the scale of its own terms.
        predicted = rows[:-1] @ one.T
        scale = np.abs(rows[:-1]) @ np.abs(one.T)
        assert (np.abs(rows[1:] - predicted) <= 1e-10 * scale).all()


def test_gauss_seidel_diverges_on_the_stiff_damper_as_predicted() -> None:
    for q in (1.0, 10.0, 30.0, 60.0):
        radius = np.abs(np.linalg.eigvals(damper_pair.step_map("gauss-seidel", q * 1e-3, k1=1e-9))).max()
        # Momentum is a mode with the eigenvalue 1, because the spring that would make it swing is switched off.
        assert radius == pytest.approx(max(1, abs(1 - q) * np.exp(-q / 10)), rel=1e-4)


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_the_oscillator_gains_energy_as_the_delays_say(algorithm: str) -> None:
    problem = PROBLEMS["force-displacement"]
    stop, step = problem.span
    misses = []
    for level in range(2, 2 + LEVELS):
        h = step / 2**level
        energy = force_displacement.energy(simulate(problem.system(h, stop), algorithm=algorithm))
        predicted = force_displacement.energy_drift(algorithm, h, np.linspace(0, stop, 2001))
        misses.append(abs((energy[-1] - energy[0]) / predicted - 1))
    # The prediction is the first order. Its error halves with h, and starts at 0.1 / 4 (`Problem.span`), or twice that
    # for a square.
    assert misses[0] <= 0.05, misses
    assert -np.polyfit(np.arange(LEVELS), np.log2(misses), 1)[0] == pytest.approx(1, abs=SLOPE), misses
