"""Asks in which share of the plausible values each claim of Figs. 2 to 7 holds, and writes docs/robustness.md.

    python -m orchestration.paper.studies.robustness                    the page, and the strength of the claims
    python -m orchestration.paper.studies.robustness --settings 10000   rows that are missing, verdicts, and the page
    python -m orchestration.paper.studies.robustness --search           the search for the best setting, and the page
    python -m orchestration.paper.studies.robustness --seeds 1000       verdicts over many seeds, and the page
    python -m orchestration.paper.studies.robustness --verify 100       whether rows of the table are made again

What was measured at each setting is in a store of runs in the user's cache, or in the folder that ``--store`` names.
The verdicts are docs/robustness.csv. What the search has found is docs/robustness.json, and the verdicts over many
seeds are docs/robustness_seeds.json. The strength of the claims, which comes with the package, is made from the table
and the seeds.
"""

import argparse
import os
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from pathlib import Path

import numpy as np
from rich.console import Console

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.campaigns.store.store import Store
from orchestration.paper import strength
from orchestration.paper.built_fmus import fmus
from orchestration.paper.calibrations import CALIBRATIONS, CHOSEN_CALIBRATION
from orchestration.paper.scenarios import ALL_SCENARIOS
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.paper.studies.raw_rows import kept_rows, kept_store, make_rows
from orchestration.paper.studies.robustness_page import page
from orchestration.paper.studies.robustness_table import answer, answers_of, read_table, write_table
from orchestration.paper.studies.seeds import over_seeds, read_seeds, write_seeds
from orchestration.paper.studies.strength_of import strength_of
from orchestration.paper.studies.survey import COSTLY, first_settings, survey
from orchestration.paper.studies.together import read_search, search, write_search

TABLE, FOUND, SEEDS, PAGE = "robustness.csv", "robustness.json", "robustness_seeds.json", "robustness.md"


def laboratory() -> NativeLaboratory:
    """A laboratory that has the FMUs of all scenarios."""
    models = {identifier for scenario in ALL_SCENARIOS.values() for identifier in scenario.models.values()}
    return NativeLaboratory(fmus(sorted(models)))


def make(folder: Path, n: int, store: Store, workers: int, console: Console) -> None:
    """Measure the settings that the store lacks up to n, and write the table of verdicts."""
    rows = make_rows(survey(laboratory()), first_settings(n), store, workers, console.print)
    write_table(folder / TABLE, answers_of(rows))


def judge(folder: Path, identity: str, store: Store) -> int:
    """Write the table of verdicts from rows that the store has of other code; the number of settings.

    Parameters
    ----------
    identity
        The study in the store.
    """
    rows = kept_rows(store, identity)
    write_table(folder / TABLE, answers_of(rows))
    return len(rows)


def find(folder: Path, workers: int, console: Console) -> None:
    """Search for the best setting, from the table of verdicts on."""
    with ThreadPoolExecutor(workers) as pool:
        write_search(folder / FOUND, search(read_table(folder / TABLE), laboratory(), pool, console.print))


def make_seeds(folder: Path, n: int, calibration: str, workers: int) -> None:
    """Judge the claims over n seeds at a calibration."""
    path = folder / SEEDS
    found = read_seeds(path) if path.exists() else {}
    with ThreadPoolExecutor(workers) as pool:
        found[calibration] = over_seeds(laboratory(), CALIBRATIONS[calibration], n, pool)
    write_seeds(path, {name: found[name] for name in CALIBRATIONS if name in found})


def verify(folder: Path, n: int, workers: int) -> tuple[int, int]:
    """Make n rows of the table again, spread over it; how many have other verdicts, and how many verdicts differ."""
    kept = read_table(folder / TABLE)
    numbers = np.unique(np.linspace(0, len(kept) - 1, n).astype(int))
    settings, measure = first_settings(len(kept)), survey(laboratory()).measure
    with ThreadPoolExecutor(workers) as pool:
        rows = list(pool.map(lambda number: measure(settings[number], int(number) + 1), numbers))
    again = [answer(row, costly=number < COSTLY) for number, row in zip(numbers, rows, strict=True)]
    differ = np.array(again) != kept[numbers]
    return int(differ.any(axis=1).sum()), int(differ.sum())


def write_pages(folder: Path) -> None:
    """Write the page, and the strength of the claims."""
    write_whole(folder / PAGE, text(folder).encode())
    path = Path(str(files("orchestration.paper"))) / "data" / strength.NAME
    strength_of(read_table(folder / TABLE), read_seeds(folder / SEEDS)).write(path)


def text(folder: Path) -> str:
    """The page, from the files of a folder."""
    return page(read_table(folder / TABLE), read_search(folder / FOUND), read_seeds(folder / SEEDS))


def main() -> None:
    """Do what the command line asks for."""
    request = _arguments()
    folder, workers, console = request.folder, request.workers, Console()
    store = Store.open(request.store) if request.store else kept_store()
    if request.settings:
        make(folder, request.settings, store, workers, console)
    if request.rows:
        console.print(f"{judge(folder, request.rows, store)} settings judged")
    if request.verify:
        rows, answers = verify(folder, request.verify, workers)
        console.print(f"{rows} of {request.verify} rows made again have other verdicts, {answers} verdicts in all")
        return
    if request.search:
        find(folder, workers, console)
    if request.seeds:
        make_seeds(folder, request.seeds, request.calibration, workers)
    write_pages(folder)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--settings", type=int, metavar="N", help="measure the settings up to this number")
    parser.add_argument("--rows", metavar="STUDY", help="judge the rows that the store has of this study")
    parser.add_argument("--search", action="store_true", help="search for the best setting")
    parser.add_argument("--seeds", type=int, metavar="N", help="judge the claims over the seeds 1 to N")
    parser.add_argument("--calibration", choices=CALIBRATIONS, default=CHOSEN_CALIBRATION.name, help="for --seeds")
    parser.add_argument("--verify", type=int, metavar="N", help="make N rows of the table again, and compare verdicts")
    parser.add_argument("--store", type=Path, metavar="FOLDER", help="store of what was measured (in the user's cache)")
    parser.add_argument("--folder", type=Path, default=Path("docs"), help="where table and page are (docs)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="threads (all processors)")
    return parser.parse_args()


if __name__ == "__main__":
    main()
