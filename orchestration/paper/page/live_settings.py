"""What a visitor of the live page can change: labels, ranges and the start values that each setting gives.

The table holds no number of its own. Defaults come from the scenarios; ranges and reasons of what the paper leaves open
from the tables of open values; a range of what the paper states reaches from a quarter to four times the stated value.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from orchestration.paper import settings
from orchestration.paper.calibrations import CHOSEN_CALIBRATION
from orchestration.paper.laboratory import SEEDS
from orchestration.paper.numbers import TRUE_M2
from orchestration.paper.scenarios import SCENARIOS, VARIANTS, Scenario
from orchestration.paper.studies.open_values import OPEN_VALUES, OpenValue

FIGURES: Mapping[str, Scenario] = {**SCENARIOS, **VARIANTS}
"""The runs that the page offers, by name."""

STEPS = 1000  # of a slider
REACH = 4.0  # of a stated value: how many times larger, or smaller, the ends of its slider are
_OPEN: Mapping[str, OpenValue] = {value.name: value for value in OPEN_VALUES}
_SHOWN = {"s": ("µs", 1e6), "depth": ("mm", 1e3)}  # display units, and how many of them are one of the unit
STATED, OPEN = "Stated by the paper", "What the paper does not say"
M2, ESTIMATE = "plant.m[2]", "controller.p_start[2]"


@dataclass(frozen=True)
class LiveSetting:
    """A number that the visitor sets.

    Attributes
    ----------
    key
        Name in links.
    label, unit
        Name beside the field; unit of the variables.
    paths
        Variables that get the number.
    low, high
        Ends of the slider; a typed number may lie beyond.
    log
        Whether the slider is logarithmic.
    whole
        Whether only whole numbers make sense.
    group
        Title of the part of the form.
    reason
        Why the range is plausible, where the paper leaves the number open.
    figures
        Names of the runs that it changes.
    further
        More variables that get the number, each with the runs in which they do.
    ticks
        Whether the number is rounded to whole sampling periods; one of them is told as 0, a draw for every tick.
    options
        In the place of a slider: label and start values of each choice, by its number.
    """

    key: str
    label: str
    unit: str
    paths: tuple[str, ...]
    low: float
    high: float
    log: bool = False
    whole: bool = False
    group: str = STATED
    reason: str = ""
    ticks: bool = False
    figures: tuple[str, ...] = tuple(FIGURES)
    further: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    options: Mapping[float, tuple[str, Mapping[str, float]]] = field(default_factory=dict)

    @property
    def changes(self) -> dict[str, tuple[str, ...]]:
        """All variables that get a value, each with the runs in which they do."""
        chosen = (path for _, values in self.options.values() for path in values)
        return {**dict.fromkeys((*self.paths, *chosen), self.figures), **self.further}

    def record(self) -> dict[str, Any]:
        """What the page is told of the setting."""
        unit, factor = _SHOWN.get(self.key, _SHOWN.get(self.unit, (self.unit, 1.0)))
        return {
            "key": self.key,
            "label": self.label,
            "unit": unit,
            "factor": factor,
            "high": self.high,
            "log": self.log,
            "slider": self._slider(factor),
            "ticks": self.ticks,
            "group": self.group,
            "reason": self.reason,
            "options": [{"value": v, "label": text, "values": {**given}} for v, (text, given) in self.options.items()],
        }

    def _slider(self, factor: float) -> dict[str, float]:
        """Ends and step of the slider, in the shown unit or as exponents of ten; whole steps reach the upper end."""
        low, high = (math.log10(end * factor) if self.log else end * factor for end in (self.low, self.high))
        steps = round(high - low) if self.whole else STEPS
        start, step = float(f"{low:.6g}"), float(f"{(high - low) / steps:.6g}")
        return {"min": start, "max": float(f"{start + steps * step:.9g}"), "step": step}


def live_settings() -> tuple[LiveSetting, ...]:
    """Everything that can be changed, in the order of the form."""
    return (*_stated(), *_open())


def _stated() -> tuple[LiveSetting, ...]:
    knowing = _figures(lambda s: s.values[ESTIMATE].number == TRUE_M2)
    wrong = tuple(name for name in FIGURES if name not in knowing)
    first, both = FIGURES["fig5"].values, ("[1]", "[2]")

    def stated(key: str, label: str, unit: str, *paths: str) -> LiveSetting:
        value = first[paths[0]].number
        return LiveSetting(key, label, unit, paths, value / REACH, value * REACH, log=True)

    def of_both(key: str, label: str, unit: str) -> LiveSetting:
        return stated(key, label, unit, *(f"controller.{key}{i}" for i in both))

    mass = replace(stated("m2", "Mass m2 of the arm", "kg", M2), further={ESTIMATE: knowing})
    known = {"figures": wrong, "low": mass.low, "high": mass.high}
    return (
        mass,
        LiveSetting("m2_hat", "m2 that the controller believes at first", "kg", (ESTIMATE,), log=True, **known),
        stated("K_f", "Stiffness of the wall", "N/m", "plant.K_f"),
        of_both("K", "Target stiffness K", "N/m"),
        of_both("B", "Target damping B", "N.s/m"),
        of_both("M", "Target inertia M", "kg"),
        _noise("noise_bound", "Bound of the noise", "sensor.noise_bound", "controller.noise_bound"),
        *(_limit(joint) for joint in (1, 2)),
    )


def _noise(key: str, label: str, *paths: str) -> LiveSetting:
    """The paper's 15 % of the peak force, and how far the page goes from there."""
    bound = CHOSEN_CALIBRATION.noise_bound
    reason = _OPEN["noise_share"].reason
    return LiveSetting(key, label, "N", paths, 0.0, REACH * bound, group=STATED, reason=reason, figures=_noisy())


def _limit(joint: int) -> LiveSetting:
    """A limit of an actuator, in the figures that have limits."""
    path = f"actuator.tau_max[{joint}]"
    value = CHOSEN_CALIBRATION.torque_limits[joint - 1]
    reason = _OPEN["torque_reading"].reason
    return LiveSetting(
        f"tau_max_{joint}",
        f"Torque limit of joint {joint}",
        "N.m",
        (path,),
        value / REACH,
        value * REACH,
        log=True,
        reason=reason,
        figures=_figures(lambda s: path in s.values),
    )


def _open() -> tuple[LiveSetting, ...]:
    bound, ratio = CHOSEN_CALIBRATION.noise_bound, _OPEN["noise_ratio"]
    craig, two = _figures(lambda s: "controller.gamma_eps" in s.values), ("fig7",)
    spread = LiveSetting(
        *("noise_std", "Standard deviation of the noise", "N", ("sensor.noise_std",)),
        low=0.0,
        high=bound / ratio.low,
        group=OPEN,
        reason=ratio.reason,
        figures=_noisy(),
    )
    return (
        _sampling(),
        spread,
        replace(
            _of("noise_hold", "Time for which a draw of the noise is held", ("sensor.noise_period",), figures=_noisy()),
            ticks=True,
        ),
        _of("contact_gated", "Noise", figures=_noisy(), texts={1.0: "in contact only", 0.0: "always"}),
        LiveSetting(
            *("seed", "Seed of the noise", "", ("sensor.seed",), SEEDS[0], SEEDS[-1]),
            whole=True,
            group=OPEN,
            reason=FIGURES["fig5"].values["sensor.seed"].origin,
            figures=_noisy(),
        ),
        _of("wall_offset", "Distance of the wall", ("plant.wall_offset", "trajectory.wall_offset")),
        _of("depth", "Depth of the path in the wall", ("trajectory.depth",)),
        _of("Psi_1", "Psi of algorithm 1", _both("Psi"), figures=craig),
        _of("Gamma_1", "Gamma of algorithm 1", ("controller.Gamma[2]",), figures=craig),
        _of("gamma_margin", "Margin of F_c", ("controller.gamma_margin",), figures=craig),
        _of("gamma_eps", "Boundary layer of F_c", ("controller.gamma_eps",), figures=craig),
        _of("Psi_2", "Psi of algorithm 2", _both("Psi"), figures=two),
        _of("Gamma_2", "Gamma of algorithm 2", ("controller.Gamma[2]",), figures=two),
        _of("K_d", "Gain K_d", _both("K_d"), figures=two),
        _of(
            "acc_filter_time",
            "Filter of the acceleration",
            ("controller.acc_filter_time",),
            figures=_figures(lambda s: "controller.acc_filter_time" in s.values),
        ),
        _of("D_f", "Damping of the wall", ("plant.D_f",)),
        _of("mu", "Friction along the wall", ("plant.mu",)),
        _of("starts_moving", "The tip starts", texts={1.0: "moving with the path", 0.0: "at rest"}),
        _of("elbow", "The elbow bends", texts={1.0: "with q2 > 0", -1.0: "with q2 < 0"}),
    )


def _sampling() -> LiveSetting:
    """The communication step, which is also every sampling period."""
    value = _OPEN["sample_time"]
    options = {period: (f"{period * 1e6:g} µs ({1e-3 / period:g} kHz)", {}) for period in sorted(set(value.choices))}
    return LiveSetting(
        *("sample_time", "Sampling period", "s", (), value.low, value.high),
        group=OPEN,
        reason=value.reason,
        options=options,
    )


def _of(
    name: str,
    label: str,
    paths: tuple[str, ...] = (),
    *,
    figures: tuple[str, ...] = tuple(FIGURES),
    texts: Mapping[float, str] | None = None,
) -> LiveSetting:
    """A setting of the table of open values: a slider, or choices if texts are given."""
    value = _OPEN[name]
    options = {number: (text, _changed(name, number)) for number, text in (texts or {}).items()}
    return LiveSetting(
        *(name, label, value.unit, paths, value.low, value.high),
        log=value.log,
        group=OPEN,
        reason=value.reason,
        figures=figures,
        options=options,
    )


def _changed(name: str, number: float) -> Mapping[str, float]:
    """Start values that differ between two numbers of an open value, at one of the numbers."""

    def given(at: float) -> Mapping[str, float]:
        setting = {**CHOSEN_CALIBRATION.values, name: at}
        return {**settings.place(setting), **settings.sensor(setting, CHOSEN_CALIBRATION.noise_bound)}

    others = [given(choice) for choice in set(_OPEN[name].choices) - {number}]
    return {path: value for path, value in given(number).items() if any(other[path] != value for other in others)}


def _both(name: str) -> tuple[str, ...]:
    return (f"controller.{name}[1]", f"controller.{name}[2]")


def _figures(has: Callable[[Scenario], bool]) -> tuple[str, ...]:
    return tuple(name for name, scenario in FIGURES.items() if has(scenario))


def _noisy() -> tuple[str, ...]:
    return _figures(lambda s: s.values["sensor.noise_bound"].number > 0)
