"""Chooses the values that the paper leaves open, and writes docs/calibration.md, which tells how.

    python -m orchestration.paper.calibrate             the constants of each calibration, recomputed
    python -m orchestration.paper.calibrate --search    the search, within ten minutes on two processors
    python -m orchestration.paper.calibrate --prove     the calibrations put to the proof, and further runs
    python -m orchestration.paper.calibrate --page      the page alone, from docs/calibration.json

``--search`` and ``--prove`` renew their part of docs/calibration.json, and the page. Both together make the file.
"""

import argparse
import math
import os
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.errors import SimulationError
from orchestration.paper import settings
from orchestration.paper.built_fmus import fmus
from orchestration.paper.calibrations import CALIBRATIONS, CHOSEN_CALIBRATION, FIRST, Calibration
from orchestration.paper.laboratory import Job, Laboratory, Runner
from orchestration.paper.measure import Summary, at_ticks, largest_norm
from orchestration.paper.scenarios import PLANAR_SCENARIOS, SCENARIOS
from orchestration.paper.studies.calibration.keeping import Proof, prove
from orchestration.paper.studies.calibration.page import page
from orchestration.paper.studies.calibration.record import Nudges, Period, Record
from orchestration.paper.studies.calibration.search import Found, search
from orchestration.paper.studies.calibration.trial import Bench
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.paper.studies.open_values import EARLIER

RECORD, PAGE = "calibration.json", "calibration.md"
PERIODS = (1e-4, 5e-5, 2e-5, 1e-5)  # s
PERIOD_SEEDS = range(1, 7)
KNOWN = (EARLIER, FIRST.values, CHOSEN_CALIBRATION.values)
"""Settings that the search starts from: one by others, and the calibrations, which earlier searches have found."""
NUDGES = tuple(1e-14 * k for k in range(-20, 21))  # rad, added to the arm's first angle at the start
Tell = Callable[[str], None]


def laboratory() -> Laboratory:
    """A laboratory that has the FMUs of all scenarios."""
    return Laboratory(fmus(sorted({i for scenario in PLANAR_SCENARIOS.values() for i in scenario.models.values()})))


def noise_bound(lab: Runner, calibration: Calibration = CHOSEN_CALIBRATION) -> float:
    """The bound of the sensor's error, N: a share of the peak |F_ext| of fig5 without noise."""
    return Bench(lab, calibration.values).noise_bound()


def torque_limits(
    lab: Runner, calibration: Calibration = CHOSEN_CALIBRATION, changes: Mapping[str, float] | None = None
) -> tuple[float, float]:
    """The torque limits, N.m: 75 % of the largest |tau_cmd| of fig5, with some start values changed."""
    name = "fig5-first" if calibration is FIRST else "fig5"
    torque = at_ticks(
        lab.run(Job(name, changes or {}), ("controller.tau_cmd[1]", "controller.tau_cmd[2]")), "controller.tau_cmd"
    )
    largest, norm = np.abs(torque).max(axis=0), largest_norm(torque)
    one, two = settings.torque_limits(largest, norm, calibration.values["torque_reading"]).tolist()
    return one, two


def torque_sensitivity(lab: Runner, pool: Executor) -> Nudges:
    """How far the torque limits move when the start is nudged by `NUDGES`."""
    angle = SCENARIOS["fig5"].values["plant.q_start[1]"].number
    found = list(pool.map(lambda nudge: torque_limits(lab, changes={"plant.q_start[1]": angle + nudge}), NUDGES))
    one, two = np.abs(np.array(found) / CHOSEN_CALIBRATION.torque_limits - 1).max(axis=0).tolist()
    return Nudges(len(NUDGES), max(NUDGES), (one, two))


def deviations(lab: Laboratory) -> tuple[Period, ...]:
    """Ranges of m2_hat's deviation in contact over some seeds at other sampling periods."""
    rows = []
    for period in PERIODS:
        jobs = [Job("fig5", {"sensor.seed": seed}, period) for seed in PERIOD_SEEDS]
        found = [s.m2_in_contact for s in lab.summaries(jobs) if isinstance(s, Summary)]
        failed = len(jobs) - len(found)
        rows.append(Period(period, failed, min(found, default=math.nan), max(found, default=math.nan)))
    return tuple(rows)


def searched(lab: Runner, pool: Executor, tell: Tell) -> Found:
    """The search, from the settings that are known."""
    return search(lab, KNOWN, pool, tell)


def proved(lab: Runner, pool: Executor, tell: Tell) -> Mapping[str, Proof]:
    """The calibrations, put to the proof."""
    found = {}
    for name, calibration in CALIBRATIONS.items():
        found[name] = prove(lab, calibration.values, pool)
        tell(f"{name}: all sentences hold at {found[name].kept:.0%} of the seeds and small changes, or more")
    return found


def renewed(record: Record | None, tell: Tell, *, look: bool, prove_all: bool) -> Record:
    """A record whose parts are made anew, if they are asked for; without a record, both are made."""
    if record is not None and not look and not prove_all:
        return record
    master = laboratory()
    native = NativeLaboratory(master.fmus)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        if look or record is None:
            found = searched(native, pool, tell)
        else:
            found = record.found
        if record is not None and not prove_all:
            return replace(record, found=found)
        return Record(found, proved(native, pool, tell), deviations(master), torque_sensitivity(native, pool))


def main() -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--search", action="store_true", help="search for the values of Figs. 5 to 7")
    parser.add_argument("--prove", action="store_true", help="put the calibrations to the proof")
    parser.add_argument("--page", action="store_true", help="write the page alone")
    parser.add_argument("--folder", type=Path, default=Path("docs"), help="where record and page are (docs)")
    request = parser.parse_args()
    console = Console()
    if not (request.search or request.prove or request.page):
        _print_constants(console)
        return
    path = request.folder / RECORD
    record = Record.read(path) if path.exists() else None
    if record is None and not (request.search and request.prove):
        msg = f"{path} is not there; --search --prove makes it."
        raise SystemExit(msg)
    record = renewed(record, console.print, look=request.search, prove_all=request.prove)
    record.write(path)
    write_whole(request.folder / PAGE, page(record).encode())


def _print_constants(console: Console) -> None:
    lab = laboratory()
    for calibration in CALIBRATIONS.values():
        try:
            one, two = torque_limits(lab, calibration)
            bound = noise_bound(lab, calibration)
        except SimulationError as error:
            raise SystemExit(str(error)) from error
        console.print(
            f"{calibration.name}: noise_bound={bound:.2f}, torque_limits=({one:.2f}, {two:.2f})", highlight=False
        )


if __name__ == "__main__":
    main()
