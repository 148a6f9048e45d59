"""The exact solutions of the known problems satisfy their equations, and the FMUs tend to the exact solutions."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestration import simulate
from tests.reference.problems import PROBLEMS, feedthrough, force_displacement, quarter_car, two_masses, wall

EPS = np.finfo(float).eps
TIMES = np.linspace(0, 1, 11)
VARIANTS: list[tuple[str, dict[str, float]]] = [
    *((name, {}) for name in PROBLEMS),
    ("force-displacement", {"d1": 0.3, "d2": 0.2, "d_c": 0.5, "m2": 3.0, "v1": -0.1}),
    ("displacement-displacement", {"d1": 0.3, "d2": 0.2, "d_c": 0.5, "m2": 3.0, "v1": -0.1}),
    ("feedthrough", {"a": 0.5, "b": 2.0, "c": 0.7, "g": -1.5, "r": -0.3}),
    ("quarter car", {"m_s": 400.0, "m_u": 40.0, "w": 25.0, "v_u": 0.1}),
    ("wall", {"m": 2.0, "d": 1.0, "v": 0.5}),
]


@pytest.mark.parametrize(("name", "numbers"), VARIANTS)
def test_row_0_is_exact(name: str, numbers: dict[str, float]) -> None:
    problem = PROBLEMS[name]
    result = simulate(problem.system(*reversed(problem.span), **numbers))
    exact = problem.exact(result.time, **numbers)
    assert set(exact) == set(result.names)
    for column, values in exact.items():
        assert result[column][0] == pytest.approx(values[0], rel=8 * EPS, abs=8 * EPS * np.abs(values).max())


@pytest.mark.parametrize(("name", "numbers"), VARIANTS)
def test_the_fmus_tend_to_the_exact_solution(name: str, numbers: dict[str, float]) -> None:
    """With a small step, the rows are the exact solution, once Richardson's extrapolation removes the first order."""
    problem, finer = PROBLEMS[name], 16
    stop, step = problem.span
    coarse, fine = (simulate(problem.system(step / n, stop, **numbers)) for n in (finer, 2 * finer))
    exact = problem.exact(coarse.time, **numbers)
    scale = {column: np.abs(values).max() for column, values in exact.items()}
    first = max(np.abs(fine[c][::2] - coarse[c]).max() / scale[c] for c in exact) * 2
    # The second term is at most 0.1 / 16 of the first term, `first` (`Problem.span`). Extrapolation leaves half of the
    # second term. Twice that is accepted, because the numbers of a variant are up to 1.5 times as fast.
    for column, values in exact.items():
        extrapolated = 2 * fine[column][::2] - coarse[column]
        assert np.abs(extrapolated - values).max() <= 0.1 / finer * first * scale[column], column


@pytest.mark.parametrize("name", [name for name, problem in PROBLEMS.items() if problem.energy])
def test_energy_of_the_exact_solution(name: str) -> None:
    """The energy of the exact solution is constant without dampers, and never grows."""
    problem = PROBLEMS[name]
    assert problem.energy is not None
    energies = problem.energy(problem.exact(TIMES))
    rounding = 1000 * EPS * energies[0]  # expm squares up to 10 times, and each square doubles the rounding
    assert (np.diff(energies) <= rounding).all()
    if name != "damper pair":
        assert np.ptp(energies) <= rounding


@pytest.mark.parametrize("name", [name for name, problem in PROBLEMS.items() if problem.bonds])
def test_a_bond_crosses_one_coupling_both_ways(name: str) -> None:
    system = PROBLEMS[name].system(1e-3, 1.0)
    wires = {(f"{c.source}.{c.output}", c.target) for c in system.connections}
    for force, velocity in PROBLEMS[name].bonds:
        assert (force, velocity.partition(".")[0]) in wires
        assert (velocity, force.partition(".")[0]) in wires


@pytest.mark.parametrize("name", PROBLEMS)
def test_times_of_any_shape(name: str) -> None:
    exact = PROBLEMS[name].exact
    flat, square = exact(TIMES[:9]), exact(TIMES[:9].reshape(3, 3))
    for column, values in flat.items():
        np.testing.assert_array_equal(square[column].ravel(), values)
        assert exact(np.float64(0.3))[column].shape == ()


@pytest.mark.parametrize("numbers", [{}, feedthrough.CONTRACTING, feedthrough.EXPANDING])
def test_the_closed_algebraic_loop(numbers: dict[str, float]) -> None:
    n, z, dt = feedthrough.Numbers(**numbers), feedthrough.exact(TIMES, **numbers), 1e-4
    x, y, u = z["plant.x"], z["plant.y"], z["gain.y"]
    largest = max(np.abs(v).max() for v in z.values())
    # Three products and three sums are rounded.
    assert np.abs(y - n.c * x - n.d * u).max() <= 8 * EPS * largest
    assert np.abs(u - n.g * y - n.r).max() <= 8 * EPS * (1 + abs(n.g)) * largest
    rate = (
        feedthrough.exact(TIMES + dt, **numbers)["plant.x"] - feedthrough.exact(TIMES - dt, **numbers)["plant.x"]
    ) / (2 * dt)
    # Central differences miss dt^2 / 6 of the third derivative, |A|^3 |x| with |A| <= 3/s. Rounding is EPS / dt.
    assert np.abs(rate - n.a * x - n.b * u).max() <= (dt**2 / 6 * 27 + 2 * EPS / dt) * 2 * largest


def test_a_loop_without_a_solution_is_refused() -> None:
    with pytest.raises(ValueError, match=r"d g = 0.5 \* 2 = 1"):
        feedthrough.exact(TIMES, d=0.5, g=2.0)


def test_the_quarter_car_against_its_equations() -> None:
    n = quarter_car.Numbers()

    def rates(t: float, y: np.ndarray) -> list[float]:
        z_s, v_s, z_u, v_u = y
        F = n.k_s * (z_s - z_u) + n.c_s * (v_s - v_u)
        r = n.R * np.sin(n.w * t / 2) ** 2
        return [v_s, -F / n.m_s, v_u, (F - n.k_t * (z_u - r)) / n.m_u]

    start = [n.z_s, n.v_s, n.z_u, n.v_u]
    solution = solve_ivp(rates, (0, 1), start, "DOP853", t_eval=TIMES, rtol=1e-12, atol=1e-14)
    exact = quarter_car.exact(TIMES)
    for i, column in enumerate(["body.z", "body.v", "wheel.z", "wheel.v"]):
        # rtol bounds the error of one step. A second has some hundred steps, so a hundred times that is accepted.
        np.testing.assert_allclose(exact[column], solution.y[i], rtol=0, atol=1e-10 * np.abs(exact[column]).max())


def test_two_masses_oscillate_at_their_eigenfrequencies() -> None:
    n = two_masses.Numbers()
    stiffness = np.array([[n.k1 + n.k_c, -n.k_c], [-n.k_c, n.k2 + n.k_c]]) / np.array([[n.m1], [n.m2]])
    squares, modes = np.linalg.eig(stiffness)
    for square, mode in zip(squares, modes.T, strict=True):
        z = force_displacement.exact(TIMES, x1=mode[0], x2=mode[1], v1=0.0, v2=0.0)
        for column, amplitude in zip(["left.x", "right.x"], mode, strict=True):
            # The tolerance is that of `test_energy_of_the_exact_solution`.
            np.testing.assert_allclose(z[column], amplitude * np.cos(np.sqrt(square) * TIMES), rtol=0, atol=1000 * EPS)


def test_a_bounce() -> None:
    """A bounce is continuous and free outside of contact, and slower by exp(-d pi / (2 m w)) afterwards."""
    start = wall.BOUNCE | {"d": 2.0}
    n = wall.Numbers(**start)
    w = np.sqrt(n.k / n.m - (n.d / (2 * n.m)) ** 2)
    begin = -n.x / n.v
    end = begin + np.pi / w
    t = np.array([0, begin - 1e-9, begin + 1e-9, end - 1e-9, end + 1e-9, end + 0.1])
    z = wall.exact(t, **start)
    leaving = -n.v * np.exp(-n.d / (2 * n.m) * np.pi / w)
    # 1e-9 s away from an event, positions are 1e-9 m from 0, and velocities 1e-9 k / m = 1e-7 m/s from their limits.
    np.testing.assert_allclose(z["mass.x"], [n.x, 0, 0, 0, 0, leaving * 0.1], rtol=0, atol=2e-9)
    np.testing.assert_allclose(z["mass.v"], [n.v, n.v, n.v, leaving, leaving, leaving], rtol=0, atol=1e-7)
    assert (z["wall.F"][[0, 1, 4, 5]] == 0).all()


@pytest.mark.parametrize("numbers", [{"x": 0.1}, {"x": -0.1, "v": -1.0}, {"x": -0.1, "v": 1.0, "d": 100.0}])
def test_what_does_not_bounce_is_refused(numbers: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="A bounce needs"):
        wall.exact(TIMES, bilateral=False, **numbers)
