"""Tests of the energy ledger of a power bond, against the mechanical energy of the simulated system."""

from pathlib import Path

import numpy as np
import pytest

from orchestration import OrchestrationError, Result, SystemDescriptionError, simulate
from orchestration.analysis.energy import PowerBond, ledger
from orchestration.master.algorithm import NEWTON, PARALLEL, Algorithm, Correction
from tests.reference.problems import PROBLEMS, wall
from tests.unit.orchestration.checked import edited, swap

H, STOP = 1e-3, 2.0  # s
K, X = 100.0, 0.1  # N/m, m: the wall problem's own numbers, with m = 1 kg, w = 10 rad/s
W = 10.0
BOND = PowerBond("wall.F", "mass.v")
IMPLICIT = Algorithm("own", PARALLEL, 1, Correction(NEWTON))


def run(algorithm: str, order: str = "wall mass"):
    system = wall.system(H, STOP).ordered(order.split())
    return system, simulate(system, algorithm=algorithm)


@pytest.mark.parametrize(
    ("algorithm", "order", "share"),
    [
        ("gauss-seidel", "wall mass", 1.0),
        ("gauss-seidel", "mass wall", 1.0),
        ("jacobi", "wall mass", 3.0),
        ("jacobi", "mass wall", 3.0),
    ],
)
def test_the_residual_is_the_energy_that_appears(algorithm: str, order: str, share: float) -> None:
    system, result = run(algorithm, order)
    energy, book = wall.energy(result), ledger(result, BOND, system, algorithm)
    grown = energy - energy[0]
    # The ledger multiplies x_k by v_k, the energy multiplies x_k by the mean of v_k and v_(k+1). The difference is at
    # most h k |x v| / 2 <= h w E / 2, at both ends of a run of any length. The start is at rest.
    assert np.abs(book.residual - grown).max() < 1.05 * H * W * energy.max() / 2
    # The amplitude grows by rho - 1 = share k h^2 / 4 m per step, the energy twice as fast. The tolerance is as above.
    rate = share * K * H / 2  # 1/s
    assert book.residual[-1] == pytest.approx(energy[0] * np.expm1(rate * STOP), abs=1.5 * H * W * energy.max() / 2)
    assert book.residual[-1] > 0
    # The mass is integrated exactly, so the energy received is its kinetic energy.
    np.testing.assert_allclose(book.received, result["mass.v"] ** 2 / 2, atol=1e-12)


def test_inputs_and_lateness_beside_the_outputs_change_no_entry() -> None:
    system, result = run("gauss-seidel")
    inputs = [f"{c.target}.{c.input}" for c in system.connections]
    more = simulate(system, record=["*", *inputs], pace=1e6)
    assert more.names == (*result.names, *inputs, "lateness")
    book, other = (ledger(r, BOND, system, "gauss-seidel") for r in (result, more))
    assert book.residual.tobytes() == other.residual.tobytes()


def test_both_sides_agree_if_they_saw_the_same() -> None:
    system = wall.system(H, STOP)
    t = np.arange(2001) * H
    exact = wall.exact(t)
    names = tuple(exact)
    result = Result(t, names, np.column_stack([exact[name] for name in names]))
    book = ledger(result, BOND, system, IMPLICIT)
    np.testing.assert_array_equal(book.residual, 0)
    # The energy given is the energy that the wall has released. The trapezoidal rule errs by (w h)^2 / 12 E w T.
    released = K / 2 * (X**2 - exact["mass.x"] ** 2)
    np.testing.assert_allclose(book.given, released, atol=(2 * W * H) ** 2 / 12 * 0.5 * W * STOP)


def test_an_implicit_coupling_takes_energy_away() -> None:
    system, t = wall.system(H, STOP), np.arange(2001) * H
    q = K * H**2
    M = np.linalg.solve([[1 + q / 2, 0], [q / H, 1]], [[1, H], [0, 1]])  # F = -k x at the end of the step
    z = [np.array([X, 0.0])]
    for _ in t[1:]:
        z.append(M @ z[-1])
    x, v = np.array(z).T
    result = Result(t, ("wall.F", "mass.x", "mass.v"), np.column_stack([-K * x, x, v]))
    book = ledger(result, BOND, system, "newton")
    energy = (v**2 + K * x**2) / 2
    assert book.residual[-1] < 0
    assert np.abs(book.residual - energy + energy[0]).max() < 1.05 * H * W * energy[0] / 2


def test_the_sign_and_the_declared_jumps() -> None:
    system, result = run("gauss-seidel")
    book = ledger(result, BOND, system)
    turned = ledger(result, PowerBond("wall.F", "mass.v", sign=-1), system)
    np.testing.assert_array_equal(turned.residual, -book.residual)
    declared = ledger(result, PowerBond("wall.F", "mass.v", jumps=("wall.F",)), system)
    np.testing.assert_array_equal(declared.residual, book.residual)
    smooth = ledger(result, PowerBond("wall.F", "mass.v", jumps=()), system)
    assert abs(smooth.residual[-1]) < 0.1 * book.residual[-1]  # a jump that counts as a ramp hides the residual


@pytest.mark.parametrize(
    ("effort", "flow", "message"),
    [
        ("wall.F", "mass.x", "N times m is not a power"),
        ("wall.gap", "mass.v", r"wall.gap is not connected to mass"),
        ("wall.F", "mass.speed", "mass has no variable speed"),
    ],
)
def test_a_pair_that_carries_no_power_is_refused(effort: str, flow: str, message: str) -> None:
    system, result = run("gauss-seidel")
    with pytest.raises(SystemDescriptionError, match=message):
        ledger(result, PowerBond(effort, flow), system)


def test_a_unit_that_is_not_declared_is_none_of_power(tmp_path: Path) -> None:
    """A bare name says nothing of its size."""
    system, result = run("gauss-seidel")
    fmu = system.component("mass").description.path
    undeclared = edited(fmu, tmp_path, swap('<Unit name="m/s">', '<Unit name="m/h">'))
    with pytest.raises(SystemDescriptionError, match="N times m/s is not a power"):
        ledger(result, BOND, system.replace("mass", undeclared))


def test_what_was_not_recorded_is_named() -> None:
    system = wall.system(H, STOP)
    result = Result(np.arange(3) * H, ("wall.F",), np.zeros((3, 1)))
    with pytest.raises(OrchestrationError, match=r"no column mass\.v"):
        ledger(result, BOND, system)
    with pytest.raises(SystemDescriptionError, match="neither 1 nor -1"):
        PowerBond("wall.F", "mass.v", sign=2)


def test_every_problem_with_a_bond_has_a_ledger() -> None:
    for problem in PROBLEMS.values():
        for effort, flow in problem.bonds:
            system = problem.system(1e-3, 0.01)
            result = simulate(system)
            assert np.isfinite(ledger(result, PowerBond(effort, flow), system).residual).all()
