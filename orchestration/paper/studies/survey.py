"""The survey of the space of open values: what is measured at each Sobol point, and the code that decides it."""

from collections.abc import Mapping
from pathlib import Path

from orchestration.paper import lyapunov, measure, saturation, settings, theory, troubles
from orchestration.paper.studies import measured, runs_at, summary_measure
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.paper.studies.open_values import setting_at
from orchestration.paper.studies.open_values import settings as points_of
from orchestration.paper.studies.raw_rows import Row, Survey, identity_of_files

COSTLY = 256
"""Number of settings at which the costly runs are made, too."""
_DECIDING = (lyapunov, measure, saturation, settings, theory, troubles, measured, runs_at, summary_measure)


def survey(laboratory: NativeLaboratory) -> Survey:
    """What is measured at each setting; seeds up to `COSTLY` have the costly runs, too."""

    def measured_at(setting: Mapping[str, float], seed: int) -> Row:
        return runs_at.row_at(laboratory, setting, seed, costly=seed <= COSTLY)

    sources = [Path(str(module.__file__)) for module in _DECIDING]
    fmus = [laboratory.fmus[name] for name in sorted(laboratory.fmus)]
    return Survey(identity_of_files([*sources, *fmus], [str(COSTLY)]), measured.UNITS, measured_at)


def first_settings(n: int) -> list[Mapping[str, float]]:
    """The first n settings of the space of open values."""
    points = points_of(n)
    return [setting_at(points, number) for number in range(n)]
