"""The part of the page that visitors try: the form, the claims at its numbers, and what the scripts compute with."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from orchestration.containers.wasm.module import host
from orchestration.paper.page.live_data import live_data, plain_script, programs
from orchestration.paper.page.live_settings import OPEN, STATED
from orchestration.report.markup import render
from orchestration.report.page import Page, Section

START = "live.js"
PLOTS = "plots"
"""Section of a page that shows the runs."""
WORKER = ("state.js", "formulas.js", "claims.js", "loop.js", "worker.js")
"""Scripts that the worker is made of, in their order."""
ABOUT = {
    STATED: "The numbers that the paper gives. A slider reaches from a quarter of the number to four times of it; a"
    " field takes any number.",
    OPEN: "The paper leaves these open. Each slider shows the plausible range, and says why.",
}


@dataclass(frozen=True)
class LiveParts:
    """What a page needs to be tried out.

    Attributes
    ----------
    first, last
        Sections before all others, and behind the plots.
    modules, starts, data, blocks
        As in `orchestration.report.page.Page`.
    """

    first: Sequence[Section]
    last: Sequence[Section]
    modules: Sequence[Path]
    starts: Sequence[str]
    data: Mapping[str, Any]
    blocks: Mapping[str, bytes]

    def added_to(self, page: Page) -> Page:
        """The page with the form before all sections, and claims and copies behind the plots."""
        names = [section.id for section in page.sections]
        behind = names.index(PLOTS) + 1 if PLOTS in names else len(names)
        return replace(
            page,
            sections=(*self.first, *page.sections[:behind], *self.last, *page.sections[behind:]),
            modules=(*page.modules, *self.modules),
            starts=(*page.starts, *self.starts),
            data={**page.data, **self.data},
            blocks={**page.blocks, **self.blocks},
        )


def live_parts(hashes: Mapping[str, str] | None = None) -> LiveParts:
    """Make the section, with all that its scripts read.

    Parameters
    ----------
    hashes
        SHA-256 of the rows of each scenario, from runs of the master. Default: the scenarios are run here.
    """
    made = programs()
    data = live_data(made, hashes)
    groups = [(title, about, [s for s in data["settings"] if s["group"] == title]) for title, about in ABOUT.items()]
    form, claims, copies = (
        render("orchestration.paper.page", f"{name}.html.j2", **data, groups=groups)
        for name in ("live", "live_claims", "live_copies")
    )
    return LiveParts(
        first=[Section("try", "Try it", form)],
        last=[
            Section("live-judged", "Claims C1 to C10 at these numbers", claims),
            Section("live-copies", "Take it with you", copies),
        ],
        modules=[_folder() / "script" / name for name in ("state.js", START)],
        starts=[START],
        data={"live-data": data, "live-worker": worker_text()},
        blocks={f"loop-{identifier}": program.module for identifier, program in made.items()},
    )


def worker_text() -> str:
    """The text of the worker: the host of the modules and the scripts of the page, as one script without imports."""
    scripts = [(_folder() / "script" / name).read_text(encoding="utf-8") for name in WORKER]
    return "\n".join(map(plain_script, [host().decode(), *scripts]))


def _folder() -> Path:
    return Path(str(files("orchestration.paper.page")))
