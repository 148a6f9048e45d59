"""What a study needs to run: workers, a view of its progress, and the study of a store."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestration.campaigns.engines.choice import engine_for
from orchestration.campaigns.engines.engine import Executor
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.execution.local import LocalExecutor
from orchestration.campaigns.execution.progress import Progress, ProgressBar, Tally
from orchestration.campaigns.store.store import Store
from orchestration.errors import StoreError, StudyError
from orchestration.fmi.given import shown
from orchestration.fmi.names import suggestion

if TYPE_CHECKING:
    from orchestration.campaigns.store.studies import StoredStudy


def executors(workers: int, cluster: Any) -> Callable[[Task], Executor]:
    """What gives the workers for a task: threads of this process, or the workers of a Dask cluster.

    Parameters
    ----------
    workers
        Number of threads.
    cluster
        Address of a scheduler, a cluster or a client; None for threads.
    """
    if cluster is None:
        return lambda task: LocalExecutor(engine_for(task), workers)
    from orchestration.campaigns.cluster.executor import ClusterExecutor

    return lambda task: ClusterExecutor(task, cluster)


def load_tables() -> None:
    """Import what makes tables, before the first run is made.

    An interrupt in the middle of the first import of pandas would leave it unusable, and the table of an interrupted
    study would be lost with it.
    """
    for name in ("pandas", "xarray"):
        import_module(name)


def shown_by(progress: Any) -> Progress:
    """What shows the progress of a study: nothing, a line on standard error, or a given object.

    Raises
    ------
    StudyError
        If the object lacks a method.
    """
    if progress is None or isinstance(progress, bool):
        return ProgressBar() if progress else Tally()
    if not all(callable(getattr(progress, name, None)) for name in ("begin", "add", "end")):
        msg = f"progress is {shown(progress)}; give True, or an object with the methods begin, add and end."
        raise StudyError(msg)
    return progress


def interrupted(made: int, runs: int, folder: Path | None) -> str:
    """The sentence that says how far an interrupted study came, and how it goes on."""
    if folder is None:
        how = "its table has what was made; give `run` a store, and an interrupted study can be continued"
    else:
        how = f"Study.resume({str(folder)!r}).run() or adaptimp sweep --resume {folder} makes the others"
    return f"The study was interrupted after {made} of {runs} runs; {how}."


def stored_study(store: Store, identity: str | None) -> "StoredStudy":
    """A study of a store: the one of an identity, or the one that was run last.

    Raises
    ------
    StoreError
        If there is none.
    """
    studies = store.studies()
    if not studies:
        msg = f"{store.folder}: the store has no study; run one with it."
        raise StoreError(msg)
    if identity is None:
        return studies[-1]
    found = [study for study in studies if study.identity == identity]
    if not found:
        msg = f"{store.folder}: there is no study {identity}; {suggestion(identity, [s.identity for s in studies])}"
        raise StoreError(msg)
    return found[0]
