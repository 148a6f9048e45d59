"""Single points of a study: a run again by `simulate`, traces, values that an optimizer asks for."""

from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.columns import SYSTEM
from orchestration.campaigns.design.factor import Factor
from orchestration.campaigns.design.samples import is_table
from orchestration.campaigns.engines.single import single_run
from orchestration.campaigns.evaluator import Evaluator
from orchestration.campaigns.execution.local import worker_count
from orchestration.campaigns.names import all_names, asked, row_of
from orchestration.campaigns.study_plan import StudyPlan
from orchestration.campaigns.table import evaluated_frame, evaluated_row
from orchestration.errors import StudyError
from orchestration.fmi.given import a_path
from orchestration.results.result import Result

if TYPE_CHECKING:
    import pandas as pd


class StudyPoints(StudyPlan):
    """What a study makes of single points. `orchestration.Study` makes all runs.

    Parameters and errors are those of `orchestration.Study`.
    """

    def result(self, row: Any = None, /, **values: Any) -> Result:
        """Make one run alone by `simulate`, with all outputs.

        Parameters
        ----------
        row
            The number of a run, which is its index in `points`; or a row of the table: of a DataFrame, or a Dataset at
            one point; or a mapping. Measures in it do not count.
        values
            Values of factors by the names of their columns, or of further start values.

        Raises
        ------
        StudyError
            If the value of a factor is missing.
        SimulationError
            If the run fails.

        Examples
        --------
        >>> from orchestration import Study, scenario
        >>> study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))", stop_time=0.2)
        >>> study = study.samples({"plant.K_f": "1e4:1e6 log"}, n=4)
        >>> table = study.run()
        >>> result = study.result(table.loc[2])
        >>> bool(abs(result.at_ticks("controller.e[1]")).max() == table.loc[2, "max(abs(controller.e[1]))"])
        True
        """
        if isinstance(row, int | np.integer) and not isinstance(row, bool):
            row = self._factors_of(int(row))
        variant, given = self._asked(row_of(row, values))
        task, pointed = self._setting.task(variant, tuple(given))
        targets = self._setting.targets(tuple(given))
        numbers = [target.numbers([value])[0] for target, value in zip(targets, given.values(), strict=True)]
        point = pointed(np.zeros(1, dtype=np.int64), np.array([numbers]))
        return single_run(task, point.values[0], point.steps[0], task.everything)

    def traces(self, runs: Iterable[int], folder: str | Path) -> list[Path]:
        """Make some runs again by `simulate`, and write all outputs of each as a Parquet file.

        Parameters
        ----------
        runs
            Numbers of the runs, which are their indices in `points` and in the table of samples.
        folder
            Folder for the files ``run-000017.parquet``.

        Returns
        -------
        list of Path
            The files, in the order of the runs.

        Raises
        ------
        StudyError
            If there is no run of a number.
        SimulationError
            If a run fails.

        Examples
        --------
        The three runs with the largest error, to look at:

        >>> from orchestration import Result, Study, scenario
        >>> study = Study(scenario("fig2"), measure="worst = max(abs(controller.e[1]))", stop_time=0.2)
        >>> study = study.samples({"plant.m[2]": "normal(1, 0.1)"}, n=16)
        >>> files = study.traces(study.run().nlargest(3, "worst").index, "traces")
        >>> len(files), Result.read(files[0])["plant.x"].shape
        (3, (2001, 2))
        """
        rows = [(int(number), self._factors_of(int(number))) for number in runs]
        place = a_path("The folder of traces", folder)
        place.mkdir(parents=True, exist_ok=True)
        found = []
        for number, row in rows:
            found.append(place / f"run-{number:06d}.parquet")
            self.result(row).write(found[-1])
        return found

    def evaluate(self, values: Any = None, workers: int | None = None, **further: Any) -> Any:
        """Make runs at values that are given now, as an optimizer needs it.

        Parameters
        ----------
        values
            Values by name for one run, or a DataFrame with a row for each run. Names are those of factors and of
            start values.
        workers
            Number of threads for a DataFrame. Default: the number of cores that the process may use.
        further
            More values by name, the same for all runs.

        Returns
        -------
        dict or DataFrame
            Measures, ``status`` and ``message``: of one run as a dict, else as columns beside those that are given. A
            run that failed has NaN.

        Examples
        --------
        >>> from orchestration import Study, scenario
        >>> study = Study(scenario("fig2"), measure="worst = max(abs(controller.e[1]))", stop_time=0.2)
        >>> found = study.evaluate({"controller.K": 2000.0})
        >>> found["status"], found["worst"] < 0.01  # m
        ('complete', True)
        """
        if is_table(values):
            return self._evaluated(values, further, worker_count(workers))
        variant, given = self._asked(row_of(values, further))
        rows = self._evaluator(variant, tuple(given)).rows([[value] for value in given.values()], 1)
        return evaluated_row(tuple(self.units), rows)

    def _factors_of(self, number: int) -> dict[str, Any]:
        """Values of the factors of a run by its number.

        Raises
        ------
        StudyError
            If there is no run of that number.
        """
        if not 0 <= number < len(self):
            msg = f"There is no run {number}; the numbers go from 0 to {len(self) - 1}."
            raise StudyError(msg)
        values = self._columns.values(self._design, np.array([number]))
        return {name: column[0] for name, column in values.items()}

    def _evaluated(self, table: "pd.DataFrame", further: Mapping[str, Any], workers: int) -> "pd.DataFrame":
        """Measures of a DataFrame's rows, which are runs of one variant."""
        columns = {str(name): table[name].to_numpy() for name in table.columns if name not in further}
        columns |= {name: [value] * len(table) for name, value in further.items()}
        variants = set(columns.pop(SYSTEM, [None]))
        if len(variants) > 1:
            msg = f"The rows are of several systems, {', '.join(map(str, variants))}; evaluate them one by one."
            raise StudyError(msg)
        variant, given = self._asked(columns | {SYSTEM: variants.pop()})
        rows = self._evaluator(variant, tuple(given)).rows(list(given.values()), workers)
        return evaluated_frame(tuple(self.units), table, rows)

    def _asked(self, given: Mapping[str, Any]) -> tuple[str, dict[Factor, Any]]:
        """The variant and the factors that values by name mean, after a check that no factor is missing.

        Raises
        ------
        StudyError
            If a factor with several levels, or the variant, is missing.
        """
        columns, factors = self._columns.factors, self._design.factors
        known = all_names(columns, self._setting.targets(factors))
        found = asked(given, known, tuple(self.units))
        for name, factor in zip(columns, factors, strict=True):
            if factor not in found:
                needed = ", ".join(f"{column}=..." for column in columns)
                msg = f"The value of {name} is missing; give {needed}, or a row of the table."
                raise StudyError(msg)
        return self._setting.variant(given.get(SYSTEM)), found

    def _evaluator(self, variant: str, factors: tuple[Factor, ...]) -> Evaluator:
        """What makes runs at values of certain factors; it stays ready for the next call."""
        key = (variant, factors)
        if key not in self._evaluators:
            self._evaluators[key] = Evaluator(self._setting, variant, factors)
        return self._evaluators[key]

    @cached_property
    def _evaluators(self) -> dict[tuple[str, tuple[Factor, ...]], Evaluator]:
        """What makes runs at values of certain factors, by the variant and the factors."""
        return {}
