"""Warns before a run of FMUs that break rules of form, which no step needs."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from textwrap import shorten

from orchestration.errors import SystemDescriptionError, printable, warn_caller
from orchestration.fmi.instance import Instance
from orchestration.system.system import System

_LONGEST = 140  # characters of the first sentence


class FormalityWarning(UserWarning):
    """Warning that an FMU breaks rules of FMI that no step needs, so it is run all the same.

    Examples
    --------
    To run FMUs of other tools without a word about their form:

    >>> import warnings
    >>> from orchestration import FormalityWarning, scenario, simulate
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", FormalityWarning)
    ...     result = simulate(scenario("fig2"), stop_time=0.01)
    """


def report_descriptions(system: System, *, strict: bool) -> None:
    """Warn once of each FMU of a system whose archive or description breaks rules of form.

    Raises
    ------
    SystemDescriptionError
        Instead of a warning, if `strict`.
    """
    files = {c.description.path: c.description.formalities for c in system.components}
    _report(files.items(), strict=strict)


def report_libraries(instances: Iterable[Instance], *, strict: bool) -> None:
    """Warn once of each FMU whose library breaks rules of form.

    Raises
    ------
    SystemDescriptionError
        Instead of a warning, if `strict`.
    """
    each = {i.description.path: i for i in instances}
    _report(((path, i.formalities) for path, i in each.items()), strict=strict)


def _report(found: Iterable[tuple[Path, Sequence[str]]], *, strict: bool) -> None:
    for path, sentences in found:
        if not sentences:
            continue
        first = shorten(sentences[0], _LONGEST, placeholder=" ...")
        count = f"{len(sentences)} such faults; " if len(sentences) > 1 else ""
        more = f" ({count}`adaptimp check` tells more)" if count or first != sentences[0] else ""
        msg = printable(f"{path.name} breaks a rule of FMI that no step needs: {first}{more}")
        if strict:
            raise SystemDescriptionError(msg)
        warn_caller(msg, FormalityWarning)
