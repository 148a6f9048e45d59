"""Every fault of an FMU, in every function and every algorithm, ends as docs/misbehaviour.md says."""

import json
import re
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
from tests.faults.shim.documented import COMPLETE, CONTAINED, ENDED, FAILED, KILLED, RUNS, calls, expected, outcomes
from tests.faults.shim.fmus import AFTER, healthy, misbehaving
from tests.faults.shim.offspring import Case, Report
from tests.sharing import made_once

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="each case is a fork of a process")

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
HOW = {word: f"died of {name}" for word, name in SIGNALS.items()}
HOW |= {"exit": "ended its process with exit code 0", "hang": "did not return within 2 s"}


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


def case(word: str, function: str, algorithm: str, **more: float) -> Case:
    return Case(FAULTS[word].name, function, algorithm, 0 if function in ONCE else AFTER, **more)


def check(run: Run, asked: Case) -> None:
    require(run(asked), asked)


def require(report: Report, asked: Case) -> None:
    """The report is what the page says."""
    word, function, isolated = Fault[asked.fault].word, asked.function, asked.limit is not None
    about = f"{asked}: {report}"
    outcome = expected(word, function, asked.algorithm, isolated=isolated)
    assert report.outcome in ((COMPLETE, FAILED) if outcome == CONTAINED else (outcome,)), about
    assert report.same, about
    if outcome == KILLED:
        assert report.detail == SIGNALS[word], about
    if outcome == ENDED:
        assert re.search(r"^4: .*(faulty|born)", report.detail), about
    if outcome == FAILED:
        rows = calls()[function].rows
        assert {"none": report.rows == 0, "some": report.rows > 0, "all": report.rows > 30}[rows], about
        assert "faulty" in report.detail or "born" in report.detail, about
        assert function in report.detail or word == "nan", about
        assert not isolated or HOW.get(word, "") in report.detail, about


@pytest.mark.parametrize("word", STATUSES)
def test_each_status_of_each_function(run: Run, word: str) -> None:
    """A function that is never called is tried once."""
    for function in FUNCTIONS:
        for algorithm in RUNS if function in calls() else ("adaptive",):
            if (word, function) != ("warning", "fmi2Instantiate"):  # it returns no status
                check(run, case(word, function, algorithm))


@pytest.mark.parametrize("word", [*SIGNALS, "exit", "leak", "threads"])
def test_each_deed_in_each_algorithm_and_function(run: Run, word: str) -> None:
    pairs = [("fmi2DoStep", algorithm) for algorithm in RUNS]
    pairs += [(function, call.algorithms[-1]) for function, call in calls().items()]
    for function, algorithm in pairs:
        if (word, function) != ("threads", "fmi2Instantiate"):  # there is no instance that could log
            check(run, case(word, function, algorithm))


@pytest.mark.parametrize("algorithm", RUNS)
def test_a_hang_is_for_ever(run: Run, algorithm: str) -> None:
    check(run, case("hang", "fmi2DoStep", algorithm, patience=2.0))


@pytest.mark.parametrize("algorithm", RUNS)
def test_not_a_number(run: Run, algorithm: str) -> None:
    check(run, case("nan", "fmi2GetReal", algorithm))


@pytest.mark.parametrize("word", [word for word in FAULTS if word != Fault.IDLE.word])
def test_isolated(run: Run, word: str) -> None:
    function = "fmi2GetReal" if word in ("nan", "beyond") else "fmi2DoStep"
    for algorithm in RUNS:
        check(run, case(word, function, algorithm, limit=2.0 if word == "hang" else 60.0))


@pytest.mark.parametrize("function", calls())
def test_a_crash_of_each_function_isolated(run: Run, function: str) -> None:
    check(run, case("segmentation", function, calls()[function].algorithms[-1], limit=60.0))


def test_the_page_names_every_fault() -> None:
    """But for `IDLE`, a function that does nothing and says that all is well: no run can see that."""
    assert set(outcomes()) == set(FAULTS) - {Fault.IDLE.word}
