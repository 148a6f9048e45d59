"""Errors of the orchestration package.

Every message names the subject, the place and both values, and says what to do. Messages hold names and texts of
strangers, so what could move a terminal's cursor, hide a word or make a line of its own is shown as an escape.
"""

import re
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import numpy as np


_NOT_CALLERS = ("orchestration", "adaptimp_fmu", "fmus", "contextlib")
LONGEST_MESSAGE = 10_000  # characters of an error's message
# Controls, invisible characters, and those that turn the direction of writing or begin a line.
_UNSAFE = re.compile(
    r"[\x00-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb"
    r"\ud800-\udfff\U000e0000-\U000e007f]"
)


def printable(text: object, most: int | None = None) -> str:
    r"""Return a text of a stranger for a message: one line, without characters that a terminal obeys.

    Parameters
    ----------
    text
        Object whose text is shown.
    most
        Number of characters from which on the text is cut; None cuts nothing.

    Examples
    --------
    >>> from orchestration.errors import printable
    >>> print(printable("fine\x1b[2J\nError: forged"))
    fine\x1b[2J\nError: forged
    """
    whole = str(text) if most is None else str(text)[: most + 1]
    safe = _UNSAFE.sub(_as_escape, whole)
    return safe if most is None or len(safe) <= most else f"{safe[: most - 3]}..."


def printable_lines(text: str) -> str:
    """Return a text of several lines without characters that a terminal obeys, except tabs and the ends of lines."""
    return _UNSAFE.sub(lambda found: found[0] if found[0] in "\n\t" else _as_escape(found), text)


def _as_escape(found: "re.Match[str]") -> str:
    return found[0].encode("unicode_escape").decode()


def warn_caller(message: str, category: type[Warning]) -> None:
    """Warn with the line of the caller's program, which is the first outside of this project.

    Python shows a warning once for each such line, and users filter warnings by the module of that line.

    Examples
    --------
    >>> import warnings
    >>> from orchestration.errors import warn_caller
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     warn_caller("The wall is stiff.", UserWarning)
    >>> print(caught[0].message)
    The wall is stiff.
    """
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] in _NOT_CALLERS:
        level, frame = level + 1, frame.f_back
    warnings.warn(message, category, stacklevel=level)


class RecordedRows(Protocol):
    """The complete rows of a run that failed or was interrupted, as an error carries them.

    An `orchestration.Result` has this interface. The interface lets this module import no other module.
    """

    @property
    def time(self) -> "np.ndarray":
        """Communication points, s, shape (n_rows,)."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns as ``component.variable``."""
        ...

    @property
    def rows(self) -> "np.ndarray":
        """Values, float64, shape (n_rows, n_columns), in the units of the columns."""
        ...

    @property
    def status(self) -> str:
        """``failed`` or ``interrupted``, or ``complete`` of a run that came to its end."""
        ...

    @property
    def message(self) -> str:
        """Why the status is not ``complete``, as a sentence."""
        ...

    def __getitem__(self, name: str, /) -> "np.ndarray":
        """Values of a column, float64, shape (n_rows,)."""
        ...

    def write(self, path: str | Path) -> None:
        """Write all rows to a file whose suffix names the format."""


class OrchestrationError(Exception):
    """Base class of all errors of the orchestration package.

    Examples
    --------
    >>> from orchestration import OrchestrationError, scenario, simulate
    >>> system = scenario("fig2")
    >>> for step in (1e-4, 3e-4):
    ...     try:
    ...         print(step, len(simulate(system, stop_time=0.3, step=step).time), "rows")
    ...     except OrchestrationError as error:
    ...         print(step, type(error).__name__)
    0.0001 3001 rows
    0.0003 SystemDescriptionError
    """

    def __init__(self, *arguments: object) -> None:
        safe = (printable(a, LONGEST_MESSAGE) if isinstance(a, str) else a for a in arguments)
        super().__init__(*safe)


class UnknownNameError(OrchestrationError, KeyError):
    """A name that nothing bears; the message gives near names.

    Examples
    --------
    It is a KeyError, as that of a dictionary:

    >>> from orchestration import UnknownNameError, scenario, simulate
    >>> result = simulate(scenario("fig2"), stop_time=0.01)
    >>> try:
    ...     result["plant.X"]
    ... except KeyError as error:
    ...     print(error)
    The result has no column plant.X; names are case-sensitive: did you mean plant.x?
    """

    def __str__(self) -> str:
        """The message as it is; a KeyError would quote it."""
        return str(self.args[0]) if self.args else ""


class ArchiveError(OrchestrationError):
    """Error of an FMU or SSP archive that is missing, invalid or unsafe to unpack.

    Examples
    --------
    >>> from orchestration import ArchiveError, Component
    >>> found = []
    >>> for file in ("Missing.fmu", "AlsoMissing.fmu"):
    ...     try:
    ...         found.append(Component.read(file))
    ...     except ArchiveError as error:
    ...         print("left out:", error)
    left out: ...Missing.fmu: there is no such FMU...
    left out: ...AlsoMissing.fmu: there is no such FMU...
    """


class SystemDescriptionError(OrchestrationError):
    """Error in the description of a coupled system, its options or its algorithm.

    Examples
    --------
    Nothing has been run when it is raised, so a wrong attempt leaves the system as it was:

    >>> from orchestration import SystemDescriptionError, scenario
    >>> system = scenario("fig2")
    >>> try:
    ...     system = system.connect("plant.x -> plant.tau")  # metres are no torque
    ... except SystemDescriptionError as error:
    ...     print(error)
    Connection plant.x[1] -> plant.tau[1]: ...
    """


class ContainerError(OrchestrationError):
    """A system that cannot be one program, such as one with an algebraic loop or with an FMU without sources.

    Examples
    --------
    >>> from orchestration import ContainerError, scenario
    >>> try:
    ...     scenario("fig2").to_c("program", algorithm="newton")  # iterates, which a program does not
    ... except ContainerError as error:
    ...     print(error)
    System fig2: a program cannot step with newton; choose gauss-seidel or jacobi.
    """


class FormulaError(OrchestrationError):
    """A text that is no formula of a measure; the message shows the place in the text.

    Examples
    --------
    >>> from orchestration import FormulaError
    >>> from orchestration.results.measures.parser import parse_formula
    >>> for text in ("max(norm(plant.F_ext))", "max(plant.F_ext[1] ** 3)"):
    ...     try:
    ...         print(parse_formula(text).columns)
    ...     except FormulaError as error:
    ...         print(error)
    ('plant.F_ext',)
    Measure max(plant.F_ext[1] ** 3), character 5, plant.F_ext[1] ** 3: the only power is 2; ...
    """


class SignalError(OrchestrationError, ValueError):
    """A name, a shape, a value or a time does not fit the FMU that is driven.

    Examples
    --------
    >>> from orchestration import Fmu, SignalError, scenario
    >>> with Fmu(scenario("fig2")["plant"].path) as plant:
    ...     try:
    ...         plant.set(tau=[1.0, 2.0, 3.0])  # N.m; the arm has two joints
    ...     except SignalError as error:
    ...         print(error)
    Plant: tau ... (2,)... (3,)...
    """


class StudyError(OrchestrationError):
    """Error in what a study asks for: its factors, values, measures or variants.

    Examples
    --------
    Nothing has been run when it is raised:

    >>> from orchestration import Study, StudyError, scenario
    >>> study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))")
    >>> try:
    ...     study.grid({"plant.K_f": "1e4 to 1e6"})
    ... except StudyError as error:
    ...     print(error)
    Factor plant.K_f: '1e4 to 1e6'; write levels as 50,100,200, or a range as 0:1:5 or 1e4:1e6:9log ...
    """


class StoreError(StudyError):
    """Error of a store of runs: a folder of something else, a damaged record, or a disk that is full.

    Examples
    --------
    >>> from pathlib import Path
    >>> from orchestration.campaigns.store.store import Store
    >>> from orchestration.errors import StoreError
    >>> Path("letters").mkdir()
    >>> Path("letters", "dear reader.txt").touch()
    >>> try:
    ...     Store.open("letters")
    ... except StoreError as error:
    ...     print(error)
    letters: the folder is no store and has other files, such as dear reader.txt; name a new folder.
    """


class ClusterError(StudyError):
    """Error of the cluster that makes the runs of a study: machines out of reach, or with other versions.

    Runs that were finished before are in the store of the study, if it has one.

    Examples
    --------
    >>> from orchestration import Study, scenario
    >>> from orchestration.errors import ClusterError
    >>> study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))").grid({"plant.mu": [0.0, 0.2]})
    >>> try:
    ...     study.run(cluster="10.0.0.5")
    ... except ClusterError as error:
    ...     print(error)
    cluster is '10.0.0.5': missing port number ...; give an address such as tcp://10.0.0.5:8786.
    """


class SimulationError(OrchestrationError):
    """Error of a run that failed.

    Attributes
    ----------
    result
        All complete rows; None if the run failed before the first row.

    Examples
    --------
    The rows until the failure are there to be looked at:

    >>> from orchestration import SimulationError, scenario, simulate
    >>> stiff = scenario("fig2").set({"controller.K": 1e8})  # N/m, far too much for a step of 0.1 ms
    >>> try:
    ...     simulate(stiff, algorithm="jacobi")
    ... except SimulationError as error:
    ...     last = error.result
    ...     print(error)
    plant: ... at t = 0.00... s ...
    >>> last.status, bool(last.time[-1] < 0.01), bool(abs(last["plant.dq"]).max() > 100)  # s, rad/s
    ('failed', True, True)
    """

    def __init__(self, message: str, result: RecordedRows | None = None) -> None:
        super().__init__(message)
        self.result = result


class InitializationError(SimulationError):
    """Error of a component before the first step, for example on an invalid start value.

    Examples
    --------
    >>> from orchestration import InitializationError, scenario, simulate
    >>> tilted = scenario("fig2").set({f"{name}.wall_normal": [-1.0, 0.5] for name in ("plant", "trajectory")})
    >>> try:
    ...     simulate(tilted)  # a normal has length 1
    ... except InitializationError as error:
    ...     print(error.result, "wall_normal" in str(error))
    None True
    """


class RunInterrupted(KeyboardInterrupt):
    """Interruption of a run by the user, with the rows until then.

    Attributes
    ----------
    result
        All complete rows.

    Examples
    --------
    Ctrl-C raises it; here a function that shows progress does the same.

    >>> from orchestration import Result, RunInterrupted, scenario, simulate
    >>> def enough(done, total):
    ...     raise KeyboardInterrupt
    >>> try:
    ...     simulate(scenario("fig2"), progress=enough)
    ... except RunInterrupted as interrupt:
    ...     interrupt.result.write("until_here.parquet")
    >>> Result.read("until_here.parquet").status
    'interrupted'
    """

    def __init__(self, result: RecordedRows) -> None:
        super().__init__("The run was interrupted.")
        self.result = result


class StudyInterrupted(KeyboardInterrupt):
    """Interruption of a study by the user, with the runs until then.

    Attributes
    ----------
    table
        Table of all runs, as `Study.run` returns it; runs that were not made have the status ``missing`` and NaN.

    Examples
    --------
    Ctrl-C raises it; here an object that shows progress does the same.

    >>> from orchestration import Study, StudyInterrupted, scenario
    >>> class Enough:
    ...     def begin(self, total, names, place):
    ...         pass
    ...     def add(self, outcomes, kept):
    ...         raise KeyboardInterrupt
    ...     def end(self):
    ...         pass
    >>> study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))", stop_time=0.1)
    >>> try:
    ...     study.grid({"controller.K": "1000:4000:100000"}).run(progress=Enough())
    ... except StudyInterrupted as interrupt:
    ...     print(interrupt)
    ...     print(sorted(set(interrupt.table["status"].values.tolist())))
    The study was interrupted after ... of 100000 runs; ...
    ['complete', 'missing']
    """

    def __init__(self, message: str, table: Any) -> None:
        super().__init__(message)
        self.table = table
