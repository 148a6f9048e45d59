"""Lists what the cache holds, and removes it: ``adaptimp cache`` and ``adaptimp cache clear``."""

import json as formats
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from adaptimp_fmu.files.cache_contents import KINDS, Amount, Kind, amount, clear, places
from adaptimp_fmu.files.cache_folder import cache_folder
from orchestration.cli.output import output, width
from orchestration.cli.tables import table
from orchestration.errors import OrchestrationError, SystemDescriptionError
from orchestration.fmi.names import suggestion

CLEAR = "clear"
_UNITS = ("B", "kB", "MB", "GB")
_STEP = 1000.0  # from unit to unit


def require_action(action: str | None) -> None:
    """Refuse what the command cannot do.

    Raises
    ------
    SystemDescriptionError
    """
    if action not in (None, CLEAR):
        msg = f"There is no action {action}; give 'adaptimp cache' to list, or 'adaptimp cache {CLEAR}' to remove."
        raise SystemDescriptionError(msg)


def list_caches(*, json: bool) -> None:
    """Print each folder of caches with its kinds of content: how many files, how large, what they are for."""
    found = {place: {name: amount(place, kind) for name, kind in KINDS.items()} for place in places()}
    if json:
        output.data(formats.dumps({str(place): _plain(amounts) for place, amounts in found.items()}, indent=2))
        return
    if not found:
        output.data(f"{cache_folder()}: nothing is kept.")
    for number, (place, amounts) in enumerate(found.items()):
        if number:
            output.data("")
        if not any(held.files for held in amounts.values()):
            output.data(f"{place}: nothing is kept.")
            continue
        output.data(str(place))
        rows = [(name, *_texts(held), KINDS[name].holds) for name, held in amounts.items() if held.files]
        total = ("all", *_texts(_sum(amounts.values())), "")
        output.data(
            table(("kind", "files", "size", "what"), [*rows, total], width(), numbers=("files", "size"), together=3)
        )


def clear_caches(which: Sequence[str], *, json: bool) -> None:
    """Remove kinds of content from all folders of caches, and say what was freed.

    Parameters
    ----------
    which
        Names of kinds; none means all but those that took long to make.

    Raises
    ------
    SystemDescriptionError
        If there is no such kind.
    OrchestrationError
        If nothing can be removed from a cache.
    """
    for name in which:
        if name not in KINDS:
            msg = f"The cache holds no {name}; {suggestion(name, KINDS)}"
            raise SystemDescriptionError(msg)
    chosen = [kind for kind in KINDS.values() if kind.name in which or not (which or kind.lasting)]
    freed = {place: {kind.name: _cleared(place, kind) for kind in chosen} for place in places()}
    if json:
        output.data(formats.dumps({str(place): _plain(amounts) for place, amounts in freed.items()}, indent=2))
        return
    for place, amounts in freed.items():
        for name, gone in amounts.items():
            if gone.files:
                output.say(f"{place / name}: {_said(gone)} removed")
            if gone.used:
                output.remark(f"Notice: {place / name}: {gone.used} in use by another process, and kept.")
    output.say(f"freed: {_said(_sum(gone for amounts in freed.values() for gone in amounts.values()))}")
    if not which:
        for kind in (kind for kind in KINDS.values() if kind.lasting):
            if any(amount(place, kind).files for place in places()):
                output.remark(f"Notice: {kind.name} took long to make, and is kept; adaptimp cache clear {kind.name}.")


def _cleared(place: Path, kind: Kind) -> Amount:
    try:
        return clear(place, kind)
    except OSError as error:
        msg = f"{place / kind.name}: nothing can be removed: {error.strerror}."
        raise OrchestrationError(msg) from error


def _sum(amounts: Iterable[Amount]) -> Amount:
    amounts = list(amounts)
    return Amount(sum(a.files for a in amounts), sum(a.size for a in amounts))


def _texts(held: Amount) -> tuple[str, str]:
    """Number of files, and their size with a unit."""
    size, unit = float(held.size), 0
    while size >= _STEP - 0.5 and unit < len(_UNITS) - 1:
        size, unit = size / _STEP, unit + 1
    return str(held.files), f"{size:.3g} {_UNITS[unit]}"


def _said(held: Amount) -> str:
    """Number of files and their size, in words."""
    number, size = _texts(held)
    return f"{number} file{'' if held.files == 1 else 's'}, {size}"


def _plain(amounts: Mapping[str, Amount]) -> dict[str, dict[str, int]]:
    return {name: asdict(held) for name, held in amounts.items()}
