"""Evidence that wrong inputs are explained: what and where, both values, what to do, in a sentence or two.

The table of wrong inputs is in `tests.faults.wrong_inputs`. Each message is scored from 0 to 3: one point each for
what and where, for the value given and the value possible, and for what to do.
"""

import re
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from orchestration import Options, UnconnectedInputWarning, simulate
from orchestration.paper.scenarios import SCENARIOS
from tests.faults.cli import Command
from tests.faults.wrong_inputs import COMMANDS, FILES, FUNCTIONS, Bench, Wrong
from tests.faults.wrong_inputs.case import MOST_POINTS, flaws

FEWEST = 120
GOAL = 2.8
"""Mean of the points of a message, of 3."""
_SAID = re.compile(r"^(?:Error|Notice): (.+)$|^(Try .+)$", re.MULTILINE)


@pytest.fixture(scope="module")
def shared(fmu_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """The bench of all cases; its folder is that of the package."""
    folder = tmp_path_factory.mktemp("bench")
    scenario = SCENARIOS["fig2"]
    loop = scenario.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in scenario.models.values()})
    result = simulate(loop, 1e-3, options=Options(every=2))
    return Bench(folder, fmu_folder, loop, loop.write(folder / "loop.ssp"), result)


@pytest.fixture
def bench(shared: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    """The bench with an empty folder, which is the working folder."""
    monkeypatch.chdir(tmp_path)
    return Bench(tmp_path, shared.fmus, shared.loop, shared.package, shared.result)


def assert_says(case: Wrong, message: str) -> None:
    """The message has the words of the case, and the form of a sentence or two."""
    assert not flaws(message), message
    assert not case.missing(message), message


@pytest.mark.parametrize("case", FUNCTIONS, ids=lambda case: case.name)
def test_a_wrong_call_is_explained(case: Wrong, bench: Bench) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)  # it is this package's own; all others are errors
        with pytest.raises(case.error) as caught:
            case.act(bench)
    assert_says(case, str(caught.value))
    assert not plt.get_fignums()


@pytest.mark.parametrize("case", [*COMMANDS, *FILES], ids=lambda case: case.name)
def test_a_wrong_command_is_explained(case: Wrong, bench: Bench, adaptimp: Command) -> None:
    if not isinstance(case.provoke, str):
        case.act(bench)
    outcome = adaptimp(*case.command.format(package=bench.package, fmus=bench.fmus).split())
    said = [next(filter(None, found)) for found in _SAID.findall(outcome.err)]
    assert outcome.code == case.code
    assert_says(case, " ".join(said))
    assert "Warning" not in outcome.err


def test_the_table_is_long_and_no_case_is_there_twice() -> None:
    cases = (*FUNCTIONS, *COMMANDS, *FILES)
    names = [case.name for case in cases]
    assert len(names) >= FEWEST
    assert len(set(names)) == len(names)


def test_messages_reach_the_goal() -> None:
    """Each message has all words that its case asks for, so a point lacks only where the case asks for no word."""
    points = [case.asked for case in (*FUNCTIONS, *COMMANDS, *FILES)]
    assert sum(points) / len(points) >= GOAL
    assert min(points) > 0
    assert max(points) == MOST_POINTS


@pytest.mark.parametrize(
    ("message", "flaw"),
    [
        ("", "it is empty"),
        ("x" * 301, "it has 301 characters"),
        ("One. Two. Three.", "it has more than two sentences"),
        ("One\ntwo.", "it has several lines"),
        ("Traceback (most recent call last)", "it has a traceback"),
    ],
)
def test_flaws_of_a_message_are_noticed(message: str, flaw: str) -> None:
    assert flaw in flaws(message)
    assert not flaws('plant: fmi2SetReal returned fmi2Error; its last message: "K_f = -1. What now?".')


def test_missing_words_are_noticed() -> None:
    case = FUNCTIONS[0]
    assert case.missing("nothing of it") == [*case.where.split("|"), *case.values.split("|"), *case.repair.split("|")]
