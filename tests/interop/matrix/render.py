"""Renders docs/interop.md: tables and lists from the outcomes, prose from ``interop.md.j2``."""

import math
from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment, StrictUndefined

from tests.interop.matrix.compare import (
    AGREEMENT,
    BITWISE,
    CLOSE,
    DIFFERS,
    FAILS,
    PASSES,
    ROUNDED,
    STEPS_AGREE,
    Verdict,
)
from tests.interop.matrix.jobs import SYSTEMS, UNITS
from tests.interop.matrix.outcomes import Outcomes
from tests.interop.matrix.protocol import FMU, SYSTEM, Tool
from tests.interop.matrix.tools import KEYS, module
from tests.interop.public import render as public
from tests.interop.public.outcomes import read

TEMPLATE = Path(__file__).parent / "interop.md.j2"
_WORDS = {PASSES: "passes", BITWISE: "bitwise", ROUNDED: "all digits", DIFFERS: "**differs**", FAILS: "**fails**"}


def render(outcomes: Outcomes) -> str:
    """The document, with the public FMUs that were kept; equal outcomes give equal bytes."""
    tools = [module(key).TOOL for key in KEYS]
    public_fmus = read()
    environment = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    return template.render(
        fmus=_table("FMU", [t for t in tools if FMU in t.kinds], UNITS, outcomes),
        systems=_table("package", [t for t in tools if SYSTEM in t.kinds], SYSTEMS, outcomes),
        findings=[line for tool in tools for line in _findings(tool, outcomes)],
        partial=_partial(tools, outcomes),
        tools=tools,
        tasks={tool.key: _task(tool) for tool in tools},
        versions=outcomes.versions,
        agreement=AGREEMENT,
        steps_of_fmus=_steps_of_fmus(outcomes),
        public=public.table(public_fmus),
        public_summary=public.summary(public_fmus),
    )


def cell(verdict: Verdict | None) -> str:
    """A verdict in a table."""
    if verdict is None:
        return "not run"
    how = f"to {verdict.distance:.0e}"
    if verdict.kind == CLOSE:
        return how if verdict.distance else "equal"
    if verdict.kind == STEPS_AGREE:
        return f"{how if verdict.distance else _WORDS[BITWISE]} from step 1"
    return _WORDS[verdict.kind]


def _table(head: str, tools: Sequence[Tool], jobs: Sequence[str], outcomes: Outcomes) -> str:
    lines = [f"| {head} | " + " | ".join(tool.title for tool in tools) + " |", "|---" * (len(tools) + 1) + "|"]
    for job in jobs:
        found = (outcomes.verdicts.get(tool.key, {}).get(job) for tool in tools)
        lines.append(f"| `{job}` | " + " | ".join(map(cell, found)) + " |")
    return "\n".join(lines)


def _findings(tool: Tool, outcomes: Outcomes) -> list[str]:
    """What failed or differed, jobs of equal reasons together."""
    reasons: dict[tuple[str, float, str], list[str]] = {}
    for job, verdict in outcomes.verdicts.get(tool.key, {}).items():
        if verdict.detail:
            distance = verdict.distance if verdict.kind == DIFFERS else 0.0
            reasons.setdefault((verdict.kind, distance, verdict.detail), []).append(job)
    lines = []
    for (kind, distance, detail), jobs in reasons.items():
        by = f" by {distance:.0e}" if kind == DIFFERS and math.isfinite(distance) else ""
        lines.append(f"{tool.title}, {_listed(jobs)}: {kind}{by}: {detail}")
    return lines


def _partial(tools: Sequence[Tool], outcomes: Outcomes) -> list[str]:
    """Figures that a tool was given only the beginning of, in words."""
    lines = []
    for tool in tools:
        found = outcomes.verdicts.get(tool.key, {})
        short = [job for job in SYSTEMS if job in found and 0 < found[job].steps == tool.longest]
        if short:
            lines.append(f"{tool.title} ran the first {tool.longest} steps of {', '.join(short)}")
    return lines


def _task(tool: Tool) -> str:
    """What a tool does here."""
    kinds = " and ".join({FMU: "FMUs", SYSTEM: "figures"}[kind] for kind in tool.kinds)
    own = "; in an environment of its own" if tool.requirements else ""
    return ("checks " if FMU in tool.kinds and not tool.inputs else "runs ") + kinds + own


def _steps_of_fmus(outcomes: Outcomes) -> str:
    """How many steps the FMUs take."""
    steps = sorted(
        {verdict.steps for row in outcomes.verdicts.values() for job, verdict in row.items() if job in UNITS}
    )
    return f"{min(filter(None, steps), default=0)} to {max(steps, default=0)} steps"


def _listed(jobs: Sequence[str]) -> str:
    """Names of jobs, or what they are together."""
    groups = {"all FMUs": UNITS, "all figures": SYSTEMS}
    return next((name for name, group in groups.items() if tuple(jobs) == group), ", ".join(jobs))
