"""Start values of each scenario with each controller, and the variables that each setting of the live page changes."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from orchestration.paper.page.live_settings import FIGURES, live_settings
from orchestration.paper.scenarios import CRAIG, SLOTINE_LI, SPONG_ORTEGA

HOMES: Mapping[str, tuple[str, str]] = {
    "HoganImpedance": ("fig2", "Conventional (Hogan)"),
    CRAIG: ("fig5", "Algorithm 1 (Craig)"),
    SLOTINE_LI: ("fig7", "Algorithm 2 (Slotine and Li)"),
    SPONG_ORTEGA: ("spong-ortega", "Algorithm 1 with a fixed inverse (Spong and Ortega)"),
}
"""Of each controller the scenario whose numbers it has where it takes another one's place, and its name."""
_SHARED = re.compile(r"controller\.(M|B|K|l|p_start)\[\d\]|controller\.gravity")
"""Numbers of the task: another controller takes them from the scenario whose controller it replaces."""
SAMPLING = "sample_time"
"""Name of the sampling period, as a setting and as a variable of components."""


@dataclass(frozen=True)
class Program:
    """A controller in the paper's loop.

    Attributes
    ----------
    module
        The loop as a module of WebAssembly.
    record
        What the page must know of it.
    """

    module: bytes
    record: Mapping[str, Any]


def starts(programs: Mapping[str, Program]) -> dict[str, dict[str, Any]]:
    """Start values by scenario and controller, in records of ``given``, ``own`` and ``paths``.

    ``given`` has the values of ``adaptimp run FIGURE --controller X``. ``own`` has those in which the page differs: a
    controller that takes another one's place has the gains of its own scenario. ``paths`` names the variables of each
    setting.
    """
    return {
        figure: {controller: _starts(figure, controller, program) for controller, program in programs.items()}
        for figure in FIGURES
    }


def _starts(figure: str, controller: str, program: Program) -> dict[str, Any]:
    scenario, home = FIGURES[figure], HOMES[controller][0]
    variables = program.record["description"]["variables"]
    given = {v["name"]: float(v["start"]) for v in variables if v["start"] is not None}
    given |= {path: value.number for path, value in scenario.values.items() if path in given}
    sampled = [path for path in given if path.endswith(f".{SAMPLING}")]
    given |= dict.fromkeys(sampled, scenario.step)
    switched = scenario.models["controller"] != controller
    gains = {path: value.number for path, value in FIGURES[home].values.items() if path.startswith("controller.")}
    own = {path: value for path, value in gains.items() if switched and not _SHARED.match(path)}
    known = {v["name"] for v in variables}

    def changed(path: str, figures: tuple[str, ...]) -> bool:
        return path in known and (home if switched and path.startswith("controller.") else figure) in figures

    paths = {one.key: [path for path, names in one.changes.items() if changed(path, names)] for one in live_settings()}
    return {"given": given, "own": own, "paths": {**paths, SAMPLING: sampled}}
