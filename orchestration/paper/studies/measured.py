"""What is measured of each run of a setting, as numbers with names; no criterion is applied here."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from orchestration.paper import lyapunov
from orchestration.paper import saturation as saturated
from orchestration.paper.calibrations import Setting
from orchestration.paper.lyapunov import SLIDING_COLUMNS, SlidingGains
from orchestration.paper.measure import (
    ESTIMATE,
    Contact,
    Summary,
    at_ticks,
    distance_from_start,
    largest_norm,
    norms,
)
from orchestration.paper.numbers import TRUE_M2
from orchestration.paper.studies.summary_measure import TORQUES
from orchestration.paper.studies.summary_measure import UNITS as SUMMARY
from orchestration.paper.troubles import ENDS, TROUBLES, Errors
from orchestration.paper.wall import wall_points
from orchestration.results.result import Result

Numbers = dict[str, float]
Units = Mapping[str, str]

SATURATION = ("saturated_1", "saturated_2")
DIVISORS = (10, 100)
NO_CORIOLIS = "fig7-no-coriolis"
"""Fig. 7 without the term C_x s."""
K_D_GRID = (30.0, 100.0, 300.0, 1000.0, 3000.0)  # N.s/m
PROPORTIONAL = "proportional"
STARTS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {"wrong": {}, "true": {"controller.p_start[2]": TRUE_M2}, PROPORTIONAL: {}}
)
"""How the runs at other gains K_d begin: from the wrong or the true m2, or from the wrong one with a Gamma that grows
in proportion to K_d."""
SLIDING = (*SLIDING_COLUMNS, ESTIMATE)

_SATURATION: Units = dict.fromkeys(SATURATION, "")
_CONVENTIONAL: Units = {"e_max": "m", "force_peak": "N", "force_steady": "N", "force_rms": "N", "end": "m"}
_SLIDE: Units = {"at_a": "m", "at_b": "m", "phases": "", "touching": ""}
_REFERENCE: Units = {"x_t_before": "m", "x_t_later": "m", "x_t_end": "m"}
_LYAPUNOV: Units = {"V_growth": "", "V_rise": ""}
_SWITCHING: Units = {"case_c": "", "gamma_ratio": "", "gamma_ratio_median": ""}
_SLIDING: Units = {"rise": "", "rms_ratio": "", "largest": "m/s", "ultimate": "", "e_ratio": ""}
_TROUBLE: Units = {"e_later": "m", "e_last": "m"}
GROWTH = tuple(f"V_{name}" for name in saturated.GROWTH)
"""Numbers of `lyapunov_saturated`."""
OF_NOISY: Units = {**SUMMARY, "force_peak": "N"}
"""Numbers of each run with noise."""


def at_divisor(scenario: str, divisor: int) -> str:
    """Name of a run in which m2_hat is updated at every tick of a divisor only."""
    return f"{scenario}/{divisor}"


def at_gain(start: str, gain: float) -> str:
    """Name of a run at another gain K_d."""
    return f"K_d {gain:g} {start}"


def in_trouble(algorithm: int, trouble: str) -> str:
    """Name of a run of an algorithm in which the sensor fails, or the torques are too small."""
    return f"algorithm {algorithm} {trouble}"


_BY_RUN: Mapping[str, Units] = {
    "fig2": {**_CONVENTIONAL, **_SLIDE, **_REFERENCE},
    "fig4": {**_CONVENTIONAL, "force_difference": "N"},
    "fig5": {**OF_NOISY, **_REFERENCE, **_LYAPUNOV, **_SWITCHING},
    "fig6": {**OF_NOISY, **_SATURATION, **dict.fromkeys(GROWTH, "")},
    "fig7": {**OF_NOISY, **_SATURATION},
    "fig7-free": OF_NOISY,
    "spong-ortega": OF_NOISY,
    NO_CORIOLIS: OF_NOISY,
    "fixed-mass": {"e_start": "m", "touches": ""},
    **{at_divisor(name, divisor): {"e_contact": "m"} for name in ("fig5", "fig7") for divisor in DIVISORS},
    **{at_gain(start, gain): _SLIDING for start in STARTS for gain in K_D_GRID},
    **{in_trouble(algorithm, trouble): _TROUBLE for algorithm in ENDS for trouble in TROUBLES},
}

UNITS: Units = {
    **{"peak": "N", "noise_bound": "N", "torque_limit_1": "N.m", "torque_limit_2": "N.m"},
    **{f"{of}.{name}": unit for of, numbers in _BY_RUN.items() for name, unit in numbers.items()},
}
"""Unit of each number of a row, by ``run.number``; those of no run come first."""


def summary(found: Summary) -> Numbers:
    """The numbers of a summary."""
    torques = dict(zip(TORQUES, found.torque.tolist(), strict=True))
    return {name: torques[name] if name in torques else float(getattr(found, name)) for name in SUMMARY}


def saturation(result: Result, touch: Contact) -> Numbers:
    """The share of the ticks from first to last contact at which each joint's torque is limited."""
    ticks = result.tick_times("actuator.saturated[1]")
    during = (ticks >= touch.first) & (ticks <= touch.last)
    shares = at_ticks(result, "actuator.saturated")[during].mean(axis=0)
    return dict(zip(SATURATION, shares.tolist(), strict=True))


def conventional(result: Result, touch: Contact) -> Numbers:
    """Errors and forces of a run without adaptation; the steady force begins when the tip has bounced once."""
    force = norms(result["plant.F_ext"])
    touching = force > 0
    begins = np.flatnonzero(np.diff(touching.astype(int), prepend=0) > 0)
    steady = force[begins[min(1, len(begins) - 1)] :] if len(begins) else force
    return {
        "e_max": largest_norm(at_ticks(result, "controller.e")),
        "force_peak": touch.peak,
        "force_steady": float(steady[steady > 0].mean()),
        "force_rms": float(np.sqrt((force[touching] ** 2).mean())),
        "end": distance_from_start(result),
    }


def true_mass(result: Result, touch: Contact, wall_offset: float) -> Numbers:
    """The numbers of Figs. 2 and 3."""
    a, b = wall_points(wall_offset)
    return {
        **conventional(result, touch),
        "at_a": float(np.linalg.norm(touch.enter - a)),
        "at_b": float(np.linalg.norm(touch.leave - b)),
        "phases": float(touch.phases),
        "touching": touch.share,
        **reference(result, touch),
    }


def force_difference(result: Result, other: Result) -> Numbers:
    """The rms difference of the forces of two runs while either touches."""
    force, than = result["plant.F_ext"], other["plant.F_ext"]
    touching = (norms(force) > 0) | (norms(than) > 0)
    return {"force_difference": float(np.sqrt((norms(force - than)[touching] ** 2).mean()))}


def reference(result: Result, touch: Contact) -> Numbers:
    """The largest |x_t - x_v| before the first contact and from then on, and that when the contact ends."""
    distance = norms(at_ticks(result, "controller.x_t") - at_ticks(result, "trajectory.x_v"))
    times = result.tick_times("controller.x_t[1]")
    return {
        "x_t_before": float(distance[times < touch.first].max()),
        "x_t_later": float(distance[times >= touch.first].max()),
        "x_t_end": float(distance[times >= touch.last][0]),
    }


def free_motion(result: Result) -> Numbers:
    """The largest |e| before the first contact, or of the whole run if the tip never touches the wall."""
    touching = np.flatnonzero(norms(result["plant.F_ext"]) > 0)
    first = result.time[touching[0]] if len(touching) else np.inf
    e, ticks = norms(at_ticks(result, "controller.e")), result.tick_times("controller.e[1]")
    return {"e_start": float(e[ticks < first].max()), "touches": float(len(touching) > 0)}


def lyapunov_craig(result: Result, touch: Contact, setting: Setting) -> Numbers:
    """The growth of V_c in contact, and its rises outside of the boundary layer."""
    V = lyapunov.craig(result, setting["Psi_1"], setting["Gamma_1"])
    margin = setting["gamma_margin"]
    layer = setting["gamma_eps"] / np.sqrt(margin - 1) if margin > 1 else np.inf
    return {"V_growth": lyapunov.craig_growth(result, V, touch), "V_rise": lyapunov.craig_rise(result, V, layer)}


def switching(result: Result, noise_bound: float) -> Numbers:
    """The number of ticks in case (c) of (26), and the needed gamma over gamma* there."""
    beta, mu, alpha, bound = (result.at_ticks(f"controller.{n}") for n in ("beta", "mu", "alpha", "gamma_bound"))
    case_c = bound > 0
    if not case_c.any():
        return {"case_c": 0.0, "gamma_ratio": np.nan, "gamma_ratio_median": np.nan}
    needed = (2 * mu[case_c] * noise_bound - alpha[case_c]) / beta[case_c] ** 2
    ratio = needed / bound[case_c]
    return {
        "case_c": float(case_c.sum()),
        "gamma_ratio": float(ratio.max()),
        "gamma_ratio_median": float(np.median(ratio)),
    }


def lyapunov_saturated(result: Result, setting: Setting, noise_bound: float) -> Numbers:
    """What V_c does while actuators saturate, (28)."""
    run = saturated.along(result, saturated.Gains(setting["Psi_1"], setting["Gamma_1"], noise_bound))
    return dict(zip(GROWTH, saturated.growth(run).values(), strict=True))


def trouble(errors: Errors) -> Numbers:
    """The largest |e| from before the contact on, and that at the end; infinite if the run ended with an error."""
    return dict(zip(_TROUBLE, (errors.largest, errors.end), strict=True))


def sliding(result: Result, gains: SlidingGains) -> Numbers:
    """The bounds of s in a run of algorithm 2."""
    found = lyapunov.sliding_bounds(result, gains)
    return {
        "rise": found.rise,
        "rms_ratio": found.rms / found.rms_bound,
        "largest": found.largest,
        "ultimate": found.ultimate,
        "e_ratio": found.e_ratio,
    }
