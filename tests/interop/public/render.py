"""Renders the table of public FMUs for docs/interop.md."""

from collections.abc import Sequence
from itertools import groupby

from tests.interop.public.compare import ALONE, BITWISE, DIFFERS, NEITHER, REFUSED, Run
from tests.interop.public.outcomes import Entry

_WORDS = {REFUSED: "**runs in fmpy only**", NEITHER: "runs in neither", ALONE: "runs here only", DIFFERS: "**differs**"}


def table(entries: Sequence[Entry]) -> str:
    """The FMUs by the tool that generated them; equal lines are one line."""
    lines = ["| tool | FMU | package | FMI | `adaptimp check` | run |", "|---" * 6 + "|"]
    ordered = sorted(entries, key=lambda e: (e.tool.lower(), e.package, e.interface, e.check, cell(e.run), e.fmu))
    alike = groupby(ordered, key=lambda e: (e.tool, e.package, e.interface, e.check, cell(e.run)))
    for (tool, package, interface, check, run), group in alike:
        names = ", ".join(f"`{entry.fmu}`" for entry in group)
        lines.append(f"| {_safe(tool)} | {names} | {package} | {interface} | {_safe(check)} | {run} |")
    return "\n".join(lines)


def summary(entries: Sequence[Entry]) -> str:
    """How many there are of each kind."""
    kinds = [entry.run.kind for entry in entries]
    words = [f"{kinds.count(kind)} {_summed[kind]}" for kind in _summed if kind in kinds]
    return f"{len(entries)} FMUs: {', '.join(words)}"


_summed = {
    BITWISE: "run and are bitwise equal to fmpy",
    DIFFERS: "run and differ",
    ALONE: "run here only",
    REFUSED: "run in fmpy only",
    NEITHER: "run in neither",
}


def cell(run: Run) -> str:
    """What came of a run, in a table."""
    if run.kind == BITWISE:
        return "; ".join(filter(None, (f"bitwise, {run.rows} rows", run.detail)))
    return f"{_WORDS[run.kind]}: {_safe(run.detail)}"


def _safe(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")
