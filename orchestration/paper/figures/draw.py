"""Draws the figures of all runs that there are into a folder."""

from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from orchestration.paper.figures.control import control_figure
from orchestration.paper.figures.manipulator import manipulator_figure
from orchestration.paper.figures.run import Run
from orchestration.paper.figures.saturated import saturated_figure
from orchestration.paper.figures.saturation import saturation_figure
from orchestration.paper.figures.style import STYLE
from orchestration.paper.figures.tirt import tirt_figure
from orchestration.paper.figures.torques import torque_figure
from orchestration.paper.figures.windows import Windows, windows_of
from orchestration.paper.numbers import TRUE_M2
from orchestration.paper.saturation import Gains
from orchestration.paper.scenarios import SCENARIOS
from orchestration.results.picture_file import save
from orchestration.results.result import Result

GROUPS = (("fig2", "fig3", "fig4"), ("fig5", "fig6", "fig7"))  # runs whose figures have the same axes


def draw(results: Mapping[str, Result], folder: Path, image: str = "png") -> list[Path]:
    """Draw Fig. 1, the figure of every run in `results`, and those that compare runs; returns the files.

    Parameters
    ----------
    results
        Runs with all outputs, by the name of the figure, ``"fig2"`` to ``"fig7"``.
    image
        File format, ``"png"`` or ``"svg"``.

    Raises
    ------
    NoContactError
        If the tip never touched the wall in a run.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(STYLE):
        drawn = _figures({name: Run(result) for name, result in results.items()})
        for name, figure in drawn.items():
            save(figure, folder / f"{name}.{image}")
    return [folder / f"{name}.{image}" for name in drawn]


def _figures(runs: Mapping[str, Run]) -> dict[str, Figure]:
    """The figures by their names."""
    drawn = {}
    for group in GROUPS:
        there = {name: runs[name] for name in group if name in runs}
        if not there:
            continue
        windows = windows_of(list(there.values()), TRUE_M2)
        if not drawn:
            drawn["fig1"] = manipulator_figure(next(iter(there.values())), windows)
        for name in there:
            drawn[name] = _figure(name, there, windows)
        if "fig6" in there and there["fig6"].saturates:
            drawn["saturation"] = saturation_figure(there["fig6"], _gains("fig6"), windows)
    if {"fig5", "fig7"} <= set(runs):
        drawn["torques"] = torque_figure(runs["fig5"], runs["fig7"], runs.get("fig6"))
    return drawn


def _gains(name: str) -> Gains:
    """The gains of a scenario of algorithm 1, as (28) needs them."""
    psi, gain, bound = (
        SCENARIOS[name].values[f"controller.{variable}"].number for variable in ("Psi[1]", "Gamma[2]", "noise_bound")
    )
    return Gains(psi, gain, bound)


def _figure(name: str, group: Mapping[str, Run], windows: Windows) -> Figure:
    """A run's figure, with the axes of its group."""
    run, title = group[name], f"Fig. {name[3:]}: {SCENARIOS[name].caption}"
    if name == "fig3":
        return tirt_figure(run, windows, title)
    if name == "fig6" and "fig5" in group:
        return saturated_figure(run, group["fig5"], windows, title)
    return control_figure(run, windows, title)
