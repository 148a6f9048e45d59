"""Asks in which share of the plausible values each claim of Figs. 5 to 7 holds, and writes docs/robustness.md.

    python -m orchestration.paper.studies.robustness --settings 4096    the rows that are missing, and the page
    python -m orchestration.paper.studies.robustness --seeds 1000       verdicts over many seeds, and the page
    python -m orchestration.paper.studies.robustness                    the page alone

The table is docs/robustness.csv. What the search for the best setting has found is docs/robustness.json, and the
verdicts over many seeds are docs/robustness_seeds.json.
"""

import argparse
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from rich.console import Console

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import SCENARIOS, VARIANTS
from orchestration.paper.studies.claims_at import SCENARIOS as SCENARIOS_AT
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.paper.studies.robustness_page import page
from orchestration.paper.studies.robustness_table import make_table, read_table
from orchestration.paper.studies.seeds import OverSeeds, over_seeds, seeds_study
from orchestration.paper.studies.together import read_search, search, write_search

TABLE, FOUND, SEEDS, PAGE = "robustness.csv", "robustness.json", "robustness_seeds.json", "robustness.md"


def laboratory() -> NativeLaboratory:
    """A laboratory that has the FMUs of all scenarios."""
    scenarios = (*SCENARIOS.values(), *VARIANTS.values())
    return NativeLaboratory(fmus(sorted({i for scenario in scenarios for i in scenario.models.values()})))


def make(folder: Path, n: int, workers: int, console: Console) -> None:
    """Make the rows of the table that are missing up to n settings, and search anew for the best setting."""
    lab = laboratory()
    answers = make_table(folder / TABLE, n, lab, workers, console.print)
    with ThreadPoolExecutor(workers) as pool:
        write_search(folder / FOUND, search(answers, lab, pool, console.print))


def make_seeds(folder: Path, n: int, workers: int, console: Console) -> None:
    """Judge the claims over n seeds at the chosen values."""
    lab, tables = laboratory(), {}
    for name in SCENARIOS_AT:
        table = seeds_study(name, lab, n).run(workers=workers)
        console.print(f"{name}: {n} seeds")
        tables[name] = table
    over_seeds(tables).write(folder / SEEDS)


def text(folder: Path) -> str:
    """The page, from the files of a folder."""
    return page(read_table(folder / TABLE), read_search(folder / FOUND), OverSeeds.read(folder / SEEDS))


def main() -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--settings", type=int, metavar="N", help="make the rows of the table up to this number")
    parser.add_argument("--seeds", type=int, metavar="N", help="judge the claims over the seeds 1 to N")
    parser.add_argument("--folder", type=Path, default=Path("docs"), help="where table and page are (docs)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="threads (all processors)")
    request = parser.parse_args()
    if request.settings:
        make(request.folder, request.settings, request.workers, Console())
    if request.seeds:
        make_seeds(request.folder, request.seeds, request.workers, Console())
    write_whole(request.folder / PAGE, text(request.folder).encode())


if __name__ == "__main__":
    main()
