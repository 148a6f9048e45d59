"""Extreme but legal settings: Figs. 5 and 7, and the fixed-inverse variant, reach their end sanely.

Bounds come from the Lyapunov functions at t = 0, where x = x_t, so that all of V is phi^2 / Gamma with phi =
1.5 kg:

    V_c: e^2 (k + psi b - psi^2) <= phi^2 / Gamma per axis (the least of X' P X over e'), |phi| <= 1.5 kg
    V_s: s' H_x s <= phi^2 / Gamma, |e| <= sup|s| / psi, |phi| <= 1.5 kg

They hold where all unknown parameters are adapted or known, up to what noise adds (25), (35).
"""

import math

import numpy as np
import pytest

from orchestration import Result
from tests.scenarios.adaptive import norms, pair, run, system

START = (1.5, 0.0)  # m
PHI = 1.5  # kg, the first error of m2
# Psi = 100, Gamma = 5 and 4, K_d = 100. 1.5^2 / 5 = 0.45; k = 2000, b = 170: 7.1 mm. For algorithm 2 the
# least eigenvalue of H_x is at least m2 = 1 kg, the mass at the tip: |s| <= 0.75 m/s, 7.5 mm; noise adds
# delta / K_d = 0.9 m/s at worst, 9 mm.
LARGEST_ERROR = {"fig5-first": 0.0071, "spong-ortega-first": 0.0071, "fig7-first": 0.0075 + 0.0091}
# C6 asks for 5 % of 1 kg after the wall; at the end of the run more than half a second has passed.
M2_TOLERANCE = 0.02
FRICTION = {**pair("plant.viscous", 1.5, 0.8), **pair("plant.coulomb", 3.0, 2.0)}
KNOWN = {f"controller.p_start[{i}]": value for i, value in zip((3, 4, 5, 6), FRICTION.values(), strict=True)}
ADAPTED = {f"controller.Gamma[{i}]": gain for i, gain in zip((3, 4, 5, 6), (5.0, 5.0, 20.0, 20.0), strict=True)}


def wall_at(degrees: float, offset: float) -> dict[str, float]:
    """The wall, and the straight segment, with the paper's normal (-1, 0) turned by an angle."""
    angle = math.pi + math.radians(degrees)
    values = {}
    for component in ("plant", "trajectory"):
        values |= pair(f"{component}.wall_normal", math.cos(angle), math.sin(angle)) | {
            f"{component}.wall_offset": offset
        }
    return values


# q2 < 0: the mirrored arm reaches (1.5, 0) from above; the tip moves at (0, pi) m/s with the same rates.
ELBOW_DOWN = {
    **pair("plant.q_start", 0.7227342478, -1.4454684956),
    **pair("plant.dq_start", 2.0943951024, 0.0),
}
SETTINGS: dict[str, dict[str, float]] = {
    "gravity": {"plant.gravity": 9.81, "controller.gravity": 9.81},
    # The ellipse reaches 1.391 m along the normal turned by 30 degrees; 1.4505 m turned by 200, where it
    # starts 1.4095.
    "wall turned by 30 degrees": wall_at(30, 1.3),
    "wall turned by 200 degrees": wall_at(200, 1.43),
    "known joint friction": {**FRICTION, **KNOWN},
    "wall friction": {"plant.mu": 0.3},
    "elbow down": ELBOW_DOWN,
    "soft wall": {"plant.K_f": 1e3},
    "hard wall": {"plant.K_f": 1e6},
    "damped wall": {"plant.D_f": 1.0},
    "hard and damped wall with friction and gravity": {
        "plant.K_f": 1e6,
        "plant.D_f": 1.0,
        "plant.mu": 0.3,
        "plant.gravity": 9.81,
        "controller.gravity": 9.81,
        **FRICTION,
        **KNOWN,
    },
}


def require_the_task(name: str, result: Result) -> np.ndarray:
    """The tip meets the wall, stays near its reference, and comes back; gives |e| at all rows."""
    assert result.time[-1] == pytest.approx(2.0)
    assert np.isfinite(result.rows).all()
    force, e = norms(result, "plant.F_ext"), norms(result, "controller.e")
    touching = np.flatnonzero(force > 0)
    assert touching.size * (result.time[1] - result.time[0]) > 0.05  # s of contact, of about 0.16
    assert force[0] == 0
    assert force[-1] == 0
    assert force.max() > 10
    assert e.max() <= LARGEST_ERROR[name]
    # The ellipse lies within 1.5 m, and the segment within it.
    assert norms(result, "plant.x").max() <= 1.5 + LARGEST_ERROR[name]
    return e


@pytest.mark.parametrize("setting", SETTINGS)
@pytest.mark.parametrize("name", LARGEST_ERROR)
def test_extreme_settings_do_the_task(name: str, setting: str) -> None:
    result = run(system(name, SETTINGS[setting]))
    e = require_the_task(name, result)
    m2 = result["controller.p_hat[2]"]
    assert m2.min() > 0  # H_hat stays positive definite
    assert m2.max() <= 1 + PHI * (1 + 1e-6)
    assert m2[-1] == pytest.approx(1.0, abs=M2_TOLERANCE)
    # The slow pole of the TIRT is -12.7 1/s: half a second after the wall 8 mm of d are 0.01 mm. e follows.
    assert e[-1] <= 1e-5
    assert np.linalg.norm(result["plant.x"][-1] - START) <= 2e-5
    if setting == "elbow down":
        assert result["plant.q[2]"].max() < 0


@pytest.mark.parametrize("name", LARGEST_ERROR)
def test_unknown_joint_friction_is_borne_and_adapting_it_helps(name: str) -> None:
    """Friction that no parameter explains disturbs p_hat and e; with gains on all of it V falls again."""
    unknown, adapted = (run(system(name, {**FRICTION, **more})) for more in ({}, ADAPTED))
    late = slice(-len(unknown.time) // 4, None)  # long after the wall
    errors = []
    for result in (unknown, adapted):
        errors.append(require_the_task(name, result)[late])
        assert np.abs(result["controller.p_hat[2]"]).max() <= 1 + PHI * (1 + 1e-6)
    assert np.sqrt((errors[1] ** 2).mean()) < 0.9 * np.sqrt((errors[0] ** 2).mean())
    np.testing.assert_array_equal(unknown["controller.p_hat[3]"], 0)
    assert adapted["controller.p_hat[3]"][-1] > 0.2  # of 1.5 N.m.s/rad, on its way


def test_ignored_gravity_is_noticed() -> None:
    """The controls' counterpart: with gravity in the plant alone the same bounds are broken."""
    result = run(system("fig7-first", {"plant.gravity": 9.81}))
    assert abs(result["controller.p_hat[2]"][-1] - 1.0) > M2_TOLERANCE
    assert norms(result, "controller.e")[-1] > 1e-5
