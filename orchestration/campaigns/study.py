"""Studies: many runs of a system with varied start values, as one table."""

from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.campaign import Rows, make_runs
from orchestration.campaigns.evaluator import Evaluator
from orchestration.campaigns.factor import SYSTEM, Factor
from orchestration.campaigns.kept import KeptRuns
from orchestration.campaigns.local import worker_count
from orchestration.campaigns.named_measures import functions_of
from orchestration.campaigns.names import all_names, asked, in_words, row_of
from orchestration.campaigns.record import recorded_setting, study_record
from orchestration.campaigns.running import executors, interrupted, shown_by, stored_study
from orchestration.campaigns.samples import is_table
from orchestration.campaigns.setting import require_runnable
from orchestration.campaigns.single import single_run
from orchestration.campaigns.store.store import Store
from orchestration.campaigns.study_plan import StudyPlan
from orchestration.campaigns.table import evaluated_frame, evaluated_row, table_of
from orchestration.errors import StudyError, StudyInterrupted
from orchestration.fmi.given import a_path
from orchestration.results.result import Result

if TYPE_CHECKING:
    import pandas as pd


class Study(StudyPlan):
    """Many runs of a system with varied start values, of which some numbers are kept: a table of measures.

    A study is a value: `grid`, `samples` and `seeds` return extended copies. Nothing is run until `run`.

    Parameters
    ----------
    system
        System, or path of an SSP package; or variants of a system by name, which all make the same runs.
    measure
        What is kept of each run. One or a list of: the name of a ready measure, a formula such as
        ``"max(plant.penetration)"``, ``"name = formula"``, a function of a `Result`, ``(name, unit, function)``, a
        `Measure`. Or a mapping from a name to a formula or a function.
    stop_time
        Stop time of all runs, s. Default: that of the system.
    step
        Communication step, s. Default: that of the system.
    algorithm
        Name of the algorithm.
    isolate
        Components whose FMUs live in processes of their own, as for `simulate`. Default: those of other tools.

    Raises
    ------
    StudyError
        If a measure is unknown or given twice.
    FormulaError
        If a formula cannot be read.
    SystemDescriptionError
        If a system lacks a column of a measure, or has no stop time.

    Examples
    --------
    The wall's stiffness and the noise of the sensor, every combination:

    >>> from orchestration import Study, scenario
    >>> study = Study(scenario("fig7"), measure=["max_e = max(norm(controller.e))"], stop_time=0.2)
    >>> study = study.grid({"plant.K_f": "1e4:1e6:3log", "controller.K": [2000.0, 4000.0]}).seeds("1-2")
    >>> table = study.run()
    >>> dict(table.sizes), table["K_f"].attrs["units"]
    ({'K_f': 3, 'K': 2, 'seed': 2}, 'N/m')

    A row is repeated bit for bit:

    >>> result = study.result(K_f=1e5, K=2000.0, seed=2)
    >>> float(abs(result["controller.e"]).max()) <= float(table["max_e"].sel(K_f=1e5, K=2000, seed=2))
    True
    """

    def run(
        self,
        workers: int | None = None,
        store: str | Path | None = None,
        cluster: Any = None,
        progress: Any = False,
        *,
        retry_failed: bool = False,
    ) -> Any:
        """Make all runs.

        Parameters
        ----------
        workers
            Number of threads. Default: the number of cores that the process may use.
        store
            Folder that keeps what is finished; runs that it has are not made again. Default: that of `resume`, or none.
        cluster
            Address of a Dask scheduler, a ``LocalCluster`` or a ``Client``, whose workers make the runs.
        progress
            True for a line on standard error; or an object as `orchestration.campaigns.progress.Progress`.
        retry_failed
            Whether to make those runs again that are in the store as failed, for example after a call took too long.

        Returns
        -------
        Dataset or DataFrame
            Of a grid a Dataset of xarray whose dimensions are the factors, else a DataFrame with a row for each run.
            Both have the measures, ``status`` (``complete`` or ``failed``) and ``message``. A run that failed has NaN
            and a sentence. ``attrs`` have the units.

        Raises
        ------
        StudyInterrupted
            After Ctrl-C, when the chunks that were being made are finished; it has the table until then.
        SystemDescriptionError
            If the system cannot be run as asked.

        Examples
        --------
        A run whose start values are refused is a row, too:

        >>> from orchestration import Study, scenario
        >>> study = Study(scenario("fig2"), measure="deepest = max(plant.penetration)", stop_time=1.0)
        >>> table = study.grid({"plant.K_f": [1e4, 1e5, -1.0]}).run()
        >>> table["deepest"].round(4).values.tolist(), table["deepest"].attrs["units"]
        ([..., ..., nan], 'm')
        >>> print(table["message"].values[-1])
        plant: ... K_f = -1 must be at least 0 N/m...
        """
        jobs = [self._setting.job(variant, self._design) for variant in self._setting.systems]
        for job in jobs:
            require_runnable(job)
        rows, columns, show = Rows.empty(len(self), len(self.units)), self._columns, shown_by(progress)
        folder = self._folder if store is None else a_path("The store of a study", store)
        with ExitStack() as stack:
            keeper = None if folder is None else stack.enter_context(self._kept(folder, retry_failed))
            stack.callback(show.end)
            show.begin(len(self), columns.measures, self._in_words)
            try:
                make_runs(jobs, rows, executors(worker_count(workers), cluster), show.add, keeper)
            except KeyboardInterrupt:
                msg = interrupted(int(rows.made.sum()), len(self), folder)
                raise StudyInterrupted(msg, table_of(columns, self._design, rows)) from None
        return table_of(columns, self._design, rows)

    @classmethod
    def resume(cls, folder: str | Path, measure: Any = (), study: str | None = None) -> "Study":
        """Take up a study from its store; `run` makes the runs that are missing.

        Parameters
        ----------
        folder
            The store that the study was run with.
        measure
            The functions among the measures, as they were given to the study; a store has no code.
        study
            Identity of the study. Default: the one that was run last.

        Raises
        ------
        StoreError
            If the folder is no store, or has no such study.
        StudyError
            If a function is missing, or its code is another one.

        Examples
        --------
        >>> from orchestration import Study, scenario
        >>> study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))", stop_time=0.1)
        >>> table = study.grid({"controller.K": "1000:4000:4"}).run(store="runs")
        >>> Study.resume("runs").run().equals(table)
        True
        """
        store = Store.open(folder, new=False)
        found = stored_study(store, study)
        functions = {m.names[0]: m for m in functions_of(measure)}
        setting, design = recorded_setting(found.record, found.system, functions)
        return cls._of(setting, design, store.folder, compares=found.record["compares"])

    def _kept(self, folder: Path, retry_failed: bool) -> KeptRuns:
        """What keeps the runs of the study in a store."""
        store = Store.open(folder)
        record = study_record(self._setting, self._design, compares=self._compares)
        identity, columns = store.save_study(record, self._setting.systems), self._columns

        def factors(numbers: np.ndarray) -> dict[str, np.ndarray]:
            return columns.values(self._design, numbers)

        return KeptRuns(store, identity, columns, factors, retry_failed=retry_failed)

    def _in_words(self, number: int) -> str:
        """Factors of a run in words."""
        return in_words(self._factors_of(number))

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
