"""What a study runs and measures, before anything is run."""

import copy
from collections.abc import Collection, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from orchestration.campaigns.design.design import Block, Design
from orchestration.campaigns.design.factor import Factor, factors_of
from orchestration.campaigns.design.ranges import SEED, levels, seed_numbers
from orchestration.campaigns.design.samples import (
    SOBOL,
    drawn,
    is_problem,
    is_table,
    saltelli,
    sampled_factors,
    tabulated,
    unit_samples,
)
from orchestration.campaigns.measuring.measure import Measure
from orchestration.campaigns.measuring.named_measures import measures_of
from orchestration.campaigns.names import column_names
from orchestration.campaigns.setting import Setting
from orchestration.campaigns.table import Columns, points_frame
from orchestration.errors import StudyError
from orchestration.fmi.given import a_number, positive, require_type, shown
from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import find_algorithm
from orchestration.system.system import System

if TYPE_CHECKING:
    import pandas as pd


class StudyPlan:
    """What a study runs and measures: systems, factors, measures. `orchestration.Study` makes the runs.

    Parameters and errors are those of `orchestration.Study`.
    """

    def __init__(
        self,
        system: System | str | Path | Mapping[str, System],
        measure: Any,
        *,
        stop_time: float | None = None,
        step: float | None = None,
        algorithm: str = "gauss-seidel",
        isolate: bool | str | Collection[str] | Isolation | None = None,
    ) -> None:
        systems = _variants(system)
        stop_time = None if stop_time is None else a_number("The stop time of a study", stop_time, StudyError)
        step = None if step is None else positive("The step of a study", step, StudyError)
        require_type("The algorithm of a study", algorithm, str, "give its name, as 'gauss-seidel'", StudyError)
        self._setting = Setting(
            systems,
            measures_of(measure, tuple(systems.values())),
            stop_time,
            step,
            find_algorithm(algorithm).name,
            Isolation(()) if isolate is False else Isolation.of(isolate),
        )
        self._compares = isinstance(system, Mapping)
        self._design = Design(tuple(systems))
        self._folder: Path | None = None
        for one in systems.values():
            one.run_stop_time(stop_time)

    def __repr__(self) -> str:
        """Systems, number of runs, factors and measures."""
        names = self._columns.all_factors
        runs = f"{len(self)} runs" if len(self) > 1 else "1 run"
        varied = f" over {', '.join(names)}" if names else ""
        return f"<Study of {', '.join(self._setting.systems)}: {runs}{varied}, {', '.join(self.units)}>"

    def __len__(self) -> int:
        """Number of runs."""
        return len(self._design)

    @property
    def systems(self) -> Mapping[str, System]:
        """Variants of the system by name."""
        return dict(self._setting.systems)

    @property
    def factors(self) -> tuple[Factor, ...]:
        """Factors in their order, without their values."""
        return self._design.factors

    @property
    def measures(self) -> tuple[Measure, ...]:
        """Measures in their order."""
        return self._setting.measures

    @property
    def units(self) -> dict[str, str]:
        """Units of the measured numbers by name, in their order."""
        return {name: unit for m in self.measures for name, unit in zip(m.names, m.units, strict=True)}

    @property
    def stop_time(self) -> float:
        """Stop time of the runs, s; of variants that of the first one."""
        return next(iter(self._setting.systems.values())).run_stop_time(self._setting.stop_time)

    @property
    def step(self) -> float | None:
        """Communication step of runs that do not vary it, s; of variants that of the first one."""
        first = next(iter(self._setting.systems.values()))
        return first.step if self._setting.step is None else self._setting.step

    @property
    def algorithm(self) -> str:
        """Name of the algorithm."""
        return self._setting.algorithm

    @property
    def points(self) -> "pd.DataFrame":
        """The factors of all runs, one row for each run; nothing is run."""
        return points_frame(self._columns, self._design)

    def grid(self, *factors: Mapping[str, Any] | Factor | Sequence[Factor]) -> Self:
        """Combine all runs with all levels of factors.

        Parameters
        ----------
        factors
            Levels by the name of a start value: a sequence of numbers, or a text such as ``1e4:1e6:9log``,
            ``0:1:5`` or ``50,100,200``; or a `Factor`. A name is ``component.variable``, an array whose elements all
            get the level, the variable alone if one component has it, ``sample_time`` or ``step``.

        Raises
        ------
        StudyError
            If levels cannot be told, or a factor is there twice.
        SystemDescriptionError
            If a start value is unknown or cannot be set, or a level does not have its type.

        Examples
        --------
        >>> from orchestration import Study, scenario
        >>> study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))")
        >>> study = study.grid({"plant.K_f": "1e4:1e6:9log", "sample_time": [1e-4, 2e-4]})
        >>> len(study), study.points["K_f"].unique()[:2].tolist()
        (18, [10000.0, 17782.7941004])
        """
        given = factors_of(factors)
        if not given:
            msg = 'A grid needs a factor; give levels by name, as {"plant.K_f": "1e4:1e6:9log"}.'
            raise StudyError(msg)
        found = self
        for factor, target in zip(given, self._setting.targets(given), strict=True):
            column = target.numbers(levels(factor.name, factor.values))
            found = found._with(Block((factor.bare(),), column[:, None]))
        return found

    def seeds(self, seeds: Any, of: str | Sequence[str] | None = None) -> Self:
        """Combine all runs with seeds of random numbers, the same for each of them.

        Parameters
        ----------
        seeds
            Whole numbers, as ``range(1, 31)``, or a text as ``1-30``.
        of
            Start values that are seeds. Default: the only start value ``seed`` of the system.

        Raises
        ------
        StudyError
            If a seed is not a whole number, or the system has no seed or several ones and `of` is not given.

        Examples
        --------
        >>> from orchestration import Study, scenario
        >>> study = Study(scenario("fig7"), measure="max(norm(controller.e))").grid({"plant.K_f": [1e4, 1e5]})
        >>> study.seeds("1-30").points.tail(1).values.tolist()
        [[100000.0, 30.0]]
        """
        numbers = seed_numbers(seeds)
        return self.grid(Factor(SEED, of or SEED, numbers))

    def samples(self, points: Any, n: int | None = None, method: str = SOBOL, seed: int = 0) -> Self:
        """Combine all runs with samples.

        Parameters
        ----------
        points
            Distributions by the name of a start value: a text such as ``1e4:1e6``, ``1e4:1e6 log`` or
            ``normal(1, 0.1)``, a distribution of scipy.stats, or levels, which are equally likely. Or a DataFrame with
            a column for each factor. Or a problem of SALib, whose points are Saltelli's for indices of Sobol.
        n
            Number of samples; of a problem of SALib with d factors, n (2 d + 2) runs are made.
        method
            ``sobol``, ``latin-hypercube`` or ``random``.
        seed
            Seed of the samples: the same seed gives the same samples.

        Raises
        ------
        StudyError
            If distributions or the number of samples cannot be told, or a factor is there twice.
        SystemDescriptionError
            If a start value is unknown or cannot be set, or a value does not have its type.

        Examples
        --------
        >>> from orchestration import Study, scenario
        >>> study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))")
        >>> study = study.samples({"plant.K_f": "1e4:1e6 log", "plant.m[2]": "normal(1, 0.1)"}, n=4)
        >>> study.points.round(2).values.tolist()
        [[..., ...], [..., ...], [..., ...], [..., ...]]
        """
        factors = sampled_factors(points)
        targets = self._setting.targets(factors)
        if is_table(points):
            return self._with(tabulated(points, targets))
        if n is None:
            msg = "The number of samples is missing; give n, such as n=256."
            raise StudyError(msg)
        if is_problem(points):
            return self._with(saltelli(points, targets, n, seed))
        return self._with(drawn(factors, targets, unit_samples(n, len(factors), method, seed)))

    @classmethod
    def _of(cls, setting: Setting, design: Design, folder: Path, *, compares: bool) -> Self:
        """A study of a setting and a design, with the folder of its store."""
        found = cls.__new__(cls)
        found._setting, found._design, found._folder, found._compares = setting, design, folder, compares
        setting.targets(design.factors)
        return found

    def _with(self, block: Block) -> Self:
        """The study with each run combined with each row of a block."""
        extended = copy.copy(self)
        extended._design = self._design.with_block(block)
        self._setting.targets(extended._design.factors)
        extended._columns  # noqa: B018 - raises if two columns would have one name
        return extended

    @property
    def _columns(self) -> Columns:
        """Columns of the table."""
        factors, systems = self._design.factors, self._setting.systems
        names = column_names(factors, tuple(self.units))
        targets = dict(zip(names, self._setting.targets(factors), strict=True))
        return Columns(
            factors=names,
            variants=self._compares,
            units={name: target.unit for name, target in targets.items()} | self.units,
            whole=frozenset(name for name, target in targets.items() if target.whole),
            descriptions={name: ", ".join(target.names) for name, target in targets.items()},
            measures=tuple(self.units),
            attributes={
                "system": ", ".join(system.name for system in systems.values()),
                "algorithm": self.algorithm,
                "stop_time": self.stop_time,
            },
        )


def _variants(given: Any) -> dict[str, System]:
    """Systems by the names of their variants; the only system has its own name."""
    if isinstance(given, System):
        return {given.name: given}
    if isinstance(given, str | PathLike):
        system = System.read(Path(given))
        return {system.name: system}
    require_type("The system of a study", given, Mapping, "give a System, its path, or systems by name", StudyError)
    for name, system in given.items():
        require_type("The name of a variant", name, str, "give a text", StudyError)
        require_type(f"Variant {name}", system, System, "give a System, as System.read('loop.ssp')", StudyError)
    if not given:
        msg = f'The variants of a study are {shown(given)}; give systems by name, as {{"craig": system}}.'
        raise StudyError(msg)
    return dict(given)
