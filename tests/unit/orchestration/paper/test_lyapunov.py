"""V_c and V_s along runs: by the formulas of the paper, with the arm's inertia from its equations."""

import casadi as ca
import numpy as np
import pytest

from fmus.mechanics.planar_arm import PlanarArm
from orchestration.paper import lyapunov
from orchestration.paper.cases import PLANAR_CASE
from orchestration.paper.lyapunov import SlidingGains
from orchestration.paper.measure import Contact, at_ticks
from orchestration.paper.numbers import ARM, TRUE_MASSES
from orchestration.results.result import Result

N = 40
RANDOM = np.random.default_rng(3)
TOUCH = Contact(first=0.2, last=0.3, enter=np.zeros(2), leave=np.zeros(2), share=1.0, phases=1, peak=1.0)
CONTROLLER = ("e[1]", "e[2]", "e_star[1]", "e_star[2]", "s[1]", "s[2]", "p_hat[2]")
PLANT = ("q[1]", "q[2]", "F_ext[1]", "F_ext[2]", "x[1]", "x[2]")


@pytest.fixture(scope="module")
def run() -> Result:
    """Random columns at N ticks of 10 ms; row k + 1 of the controller belongs to tick k."""
    names = (*(f"controller.{name}" for name in CONTROLLER), *(f"plant.{name}" for name in PLANT))
    rows = RANDOM.standard_normal((N + 1, len(names)))
    rows[:, names.index("plant.q[2]")] = RANDOM.uniform(0.3, 2.8, N + 1)
    time = 0.01 * np.arange(N + 1)
    return Result(time, names, rows, {}, {"controller": 1}, {}, {"controller": 0.01})


def test_v_c_is_that_of_the_paper(run: Result) -> None:
    psi, gain = 30.0, 2.0
    found = lyapunov.craig(run, psi, gain)
    for k in (0, 7, N - 1):
        e, e_star = (np.array([run[f"controller.{name}[{i}]"][k + 1] for i in (1, 2)]) for name in ("e", "e_star"))
        phi = run["controller.p_hat[2]"][k + 1] - 1.0
        de = e_star - psi * e
        # (17): X' P X + phi' Gamma^-1 phi with P = [[K/M + psi B/M, psi], [psi, 1]] for each axis.
        P = np.array([[4000 / 2 + psi * 340 / 2, psi], [psi, 1.0]])
        expected = sum(np.array([e[i], de[i]]) @ P @ np.array([e[i], de[i]]) for i in (0, 1)) + phi**2 / gain
        assert found[k] == pytest.approx(expected, rel=1e-12)


def test_growth_is_that_in_contact(run: Result) -> None:
    V = np.full(N, 2.0)
    V[[5, 25, 35]] = 100.0, 3.0, 50.0  # before, during and after the contact from 0.2 s to 0.3 s
    assert lyapunov.craig_growth(run, V, TOUCH) == 1.5


def test_only_counted_rises_count() -> None:
    V = np.array([2.0, 3.0, 1.0, 2.0, 6.0])
    assert lyapunov.rise(V, np.array([True, True, False, True])) == (1.0 + 4.0) / 2.0


def test_kinetic_energy_is_that_of_the_arm(run: Result) -> None:
    """Of each tick by the inertia matrix; cancellation in solving costs some digits."""
    arm = PlanarArm(2)
    q = np.column_stack([run[f"plant.q[{i}]"][:-1] for i in (1, 2)])
    s = np.column_stack([run[f"controller.s[{i}]"][1:] for i in (1, 2)])
    found = PLANAR_CASE.kinetic(at_ticks(run, "plant.q"), s)
    for k in range(N):
        J = np.array(ca.DM(arm.jacobian(q[k], ARM.link_lengths)))
        dq = np.linalg.solve(J, s[k])
        H = np.array(ca.DM(arm.inertia(q[k], TRUE_MASSES, ARM.link_lengths)))
        assert found[k] == pytest.approx(dq @ H @ dq, rel=1e-10)


def test_bounds_of_s(run: Result) -> None:
    found = lyapunov.sliding_bounds(run, SlidingGains(psi=10.0, gain=2.0, K_d=50.0, noise_bound=100.0))
    size = np.linalg.norm(np.column_stack([run[f"controller.s[{i}]"][1:] for i in (1, 2)]), axis=1)
    e = np.linalg.norm(np.column_stack([run[f"controller.e[{i}]"][1:] for i in (1, 2)]), axis=1)
    assert found.largest == size.max(), "the tip touches from the first row on"
    assert found.ultimate == found.largest / 2.0
    assert found.rms == pytest.approx(np.sqrt((size**2).mean()), rel=1e-12)
    assert found.e_ratio == pytest.approx(e.max() / (e[0] + size.max() / 10.0), rel=1e-12)
