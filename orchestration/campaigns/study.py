"""Studies: many runs of a system with varied start values, as one table."""

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

from orchestration.campaigns.execution.campaign import Rows, make_runs
from orchestration.campaigns.execution.local import worker_count
from orchestration.campaigns.kept import KeptRuns
from orchestration.campaigns.measuring.named_measures import functions_of
from orchestration.campaigns.names import in_words
from orchestration.campaigns.record import recorded_setting, study_record
from orchestration.campaigns.running import executors, interrupted, load_tables, shown_by, stored_study
from orchestration.campaigns.setting import require_runnable
from orchestration.campaigns.stability import predicted
from orchestration.campaigns.store.store import Store
from orchestration.campaigns.study_points import StudyPoints
from orchestration.campaigns.table import table_of
from orchestration.errors import StudyInterrupted
from orchestration.fmi.given import a_path


class Study(StudyPoints):
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

    What a study will do, before it does it:

    >>> [factor.name for factor in study.factors], [measure.label for measure in study.measures], study.units
    (['plant.K_f', 'controller.K', 'seed'], ['max_e'], {'max_e': 'm'})
    >>> list(study.systems), study.algorithm, study.stop_time, study.step, study.points.shape
    (['fig7'], 'gauss-seidel', 0.2, 1e-05, (12, 3))
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
            True for a line on standard error; or an object as `orchestration.campaigns.execution.progress.Progress`.
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
        load_tables()
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
        values = partial(columns.values, self._design)
        return KeptRuns(store, identity, columns, values, retry_failed=retry_failed)

    def _in_words(self, number: int) -> str:
        """Factors of a run in words."""
        return in_words(self._factors_of(number))

    def stability(self, at: float = 0.0) -> Any:
        """Predict for each run whether its algorithm is stable, without making the run.

        A verdict takes some tenths of a second, and seeds do not change it: leave them out.

        Parameters
        ----------
        at
            Time of the operating point, s, as for `System.stability`. The run to this point is made.

        Returns
        -------
        Dataset or DataFrame
            As of `run`, with the only measure ``growth_rate``, 1/s: how fast the fastest small deviation grows. It is
            positive where the algorithm is unstable, and at most 0 where no deviation visibly grows.

        Examples
        --------
        >>> from orchestration import Study, scenario
        >>> study = Study(scenario("fig2"), algorithm="jacobi", measure="max_e").grid({"sample_time": [1e-3, 7e-3]})
        >>> (study.stability()["growth_rate"] > 0).values.tolist()
        [False, True]
        """
        jobs = [self._setting.job(variant, self._design) for variant in self._setting.systems]
        columns, rows = predicted(jobs, self._columns, at)
        return table_of(columns, self._design, rows)
