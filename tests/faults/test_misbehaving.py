"""Every fault of an FMU, in every function and every algorithm, ends as docs/misbehaviour.md says."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import IO

import pytest

from orchestration.fmi.signatures import FUNCTIONS
from tests.faults.shim.codes import FIRST_BESIDE_STATUS, Fault
from tests.faults.shim.documented import ENDED, FAILED, KILLED, RUNS, calls, expected, outcomes
from tests.faults.shim.fmus import AFTER, healthy, misbehaving
from tests.faults.shim.offspring import Case, Report
from tests.sharing import made_once

Run = Callable[[Case], Report]
REPOSITORY = Path(__file__).parents[2]
FAULTS = {fault.word: fault for fault in Fault}
STATUSES = [word for word, fault in FAULTS.items() if fault < FIRST_BESIDE_STATUS]
OTHERS = [word for word in FAULTS if word not in STATUSES]
ONCE = [
    *[name for name in FUNCTIONS if any(word in name for word in ("Instan", "Setup", "Init", "Terminate", "Free"))],
    "fmi2GetDirectionalDerivative",
]
"""Functions that are called once or a few times; all others misbehave after some calls."""
SIGNALS = {"segmentation": "SIGSEGV", "arithmetic": "SIGFPE", "abort": "SIGABRT"}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Run]:
    """Runs a case in a process of its own."""

    def make(folder: Path) -> None:
        misbehaving(folder)
        healthy(folder)

    folder = made_once(tmp_path_factory, "misbehaving", make)
    program = [sys.executable, "-m", "tests.faults.shim.offspring", folder / "Faulty.fmu", folder / "Healthy.fmu"]
    with subprocess.Popen(program, cwd=REPOSITORY, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin
        assert process.stdout
        yield partial(_answer, process.stdin, process.stdout)
        process.stdin.close()


def _answer(questions: IO[str], answers: IO[str], case: Case) -> Report:
    questions.write(json.dumps(asdict(case)) + "\n")
    questions.flush()
    return Report(**json.loads(answers.readline()))


def case(word: str, function: str, algorithm: str, patience: float = 300.0) -> Case:
    return Case(FAULTS[word].name, function, algorithm, 0 if function in ONCE else AFTER, patience)


def require(report: Report, word: str, function: str, algorithm: str) -> None:
    """The report is what the page says."""
    about = f"{word} in {function} under {algorithm}: {report}"
    outcome = expected(word, function, algorithm)
    assert report.outcome == outcome, about
    assert report.same, about
    if outcome == KILLED:
        assert report.detail == SIGNALS[word], about
    if outcome == ENDED:
        assert report.detail == "0", about
    if outcome == FAILED:
        rows = calls()[function].rows
        assert {"none": report.rows == 0, "some": report.rows > 0, "all": report.rows > 30}[rows], about
        assert "faulty" in report.detail or "born" in report.detail, about
        assert function in report.detail or word == "nan", about


@pytest.mark.parametrize("word", STATUSES)
def test_each_status_of_each_function(run: Run, word: str) -> None:
    """A function that is never called is tried once."""
    for function in FUNCTIONS:
        for algorithm in RUNS if function in calls() else ("adaptive",):
            if (word, function) != ("warning", "fmi2Instantiate"):  # it returns no status
                require(run(case(word, function, algorithm)), word, function, algorithm)


@pytest.mark.parametrize("word", [*SIGNALS, "exit", "leak", "threads"])
def test_each_deed_in_each_algorithm_and_function(run: Run, word: str) -> None:
    pairs = [("fmi2DoStep", algorithm) for algorithm in RUNS]
    pairs += [(function, call.algorithms[-1]) for function, call in calls().items()]
    for function, algorithm in pairs:
        if (word, function) != ("threads", "fmi2Instantiate"):  # there is no instance that could log
            require(run(case(word, function, algorithm)), word, function, algorithm)


@pytest.mark.parametrize("algorithm", RUNS)
def test_a_hang_is_for_ever(run: Run, algorithm: str) -> None:
    require(run(case("hang", "fmi2DoStep", algorithm, patience=2.0)), "hang", "fmi2DoStep", algorithm)


@pytest.mark.parametrize("algorithm", RUNS)
def test_not_a_number(run: Run, algorithm: str) -> None:
    require(run(case("nan", "fmi2GetReal", algorithm)), "nan", "fmi2GetReal", algorithm)


def test_the_page_names_every_fault() -> None:
    """But for `IDLE`, a function that does nothing and says that all is well: no run can see that."""
    assert set(outcomes()) == set(FAULTS) - {Fault.IDLE.word}
