"""What strangers call things and log is shown as one line of harmless characters, wherever it is shown."""

import logging
import pickle
import re
import zipfile
from pathlib import Path

import pytest

from orchestration import Component, Result, SimulationError, System, UnknownNameError, simulate
from orchestration.check import Severity
from orchestration.check.findings import Finding, Report
from orchestration.cli.output import output
from orchestration.cli.tables import definitions, table
from orchestration.errors import LONGEST_MESSAGE, OrchestrationError, printable, printable_lines
from orchestration.fmi.logging import LONGEST_TEXT, Messages
from orchestration.master.simulate import UnconnectedInputWarning
from tests.faults.cli import Command
from tests.unit.orchestration.checked import compiled, misbehaving

RED, OVERRIDE, FORGED = "\x1b[31m", "\u202e", "\nError: forged"
HOSTILE = f"a{RED}b{OVERRIDE}c{FORGED}\r\x9b2J"
UNSAFE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
FAIR = "größe µ 速度 e\u0301 \u00a0 “x”"


def test_texts_become_one_line() -> None:
    assert printable(HOSTILE) == r"a\x1b[31mb\u202ec\nError: forged\r\x9b2J"
    assert printable(FAIR) == FAIR, "letters and signs of all languages stay"
    assert printable("\ud800\U000e0041\u2028\ufeff") == r"\ud800\U000e0041\u2028\ufeff"
    assert printable("abcdef", 5) == "ab..."
    assert printable_lines(f"one\ttwo\n{RED}three\r\n") == "one\ttwo\n\\x1b[31mthree\\r\n"


@pytest.mark.parametrize("kind", [OrchestrationError, UnknownNameError, SimulationError])
def test_errors(kind: type[OrchestrationError]) -> None:
    error = kind(HOSTILE)
    assert str(error) == printable(HOSTILE)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)  # noqa: S301
    assert len(str(kind("x" * 10**6))) == LONGEST_MESSAGE


def test_texts_that_an_fmu_logs() -> None:
    messages = Messages()
    messages.append(HOSTILE)
    messages.append("x" * 10**6)
    assert messages[0] == printable(HOSTILE)
    assert len(messages[1]) == LONGEST_TEXT


def test_findings_and_facts(tmp_path: Path) -> None:
    found = Finding("9", Severity.NOTE, HOSTILE)
    report = Report(tmp_path / f"x{RED}.fmu", None, (found,), (HOSTILE,))
    assert found.message == report.facts[0] == printable(HOSTILE)
    assert not UNSAFE.search(report.summary())


def test_tables_keep_one_row_for_one_name() -> None:
    assert len(table(("name", "unit"), [(HOSTILE, "m")], 200).splitlines()) == 3
    assert len(definitions([(HOSTILE, HOSTILE)], 300).splitlines()) == 1


def test_what_a_command_says(capsys: pytest.CaptureFixture[str]) -> None:
    for say in (output.say, output.remark, output.error, output.data):
        say(f"{RED}red{OVERRIDE}")
    captured = capsys.readouterr()
    assert (captured.out + captured.err).splitlines() == [r"\x1b[31mred\u202e"] * 4


@pytest.fixture(scope="module")
def strange(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU whose model, variable and description have hostile texts, as far as XML can hold them."""
    folder = tmp_path_factory.mktemp("words")
    name = "a\u202eb\u009b31mc&#10;Error: forged"

    def edit(xml: str) -> str:
        return xml.replace('name="y"', f'name="{name}" description="{name}"').replace('"Misbehaving"', f'"{name}"', 1)

    path = misbehaving(compiled(folder, "words"), folder / "words.fmu", "none", edit)
    with zipfile.ZipFile(path) as archive:
        assert "\u202e" in archive.read("modelDescription.xml").decode()
    return path


def test_an_fmu_with_hostile_names(strange: Path, adaptimp: Command, caplog: pytest.LogCaptureFixture) -> None:
    """It runs under its name; what is shown of it has no such character, in text, tables and pages."""
    with caplog.at_level(logging.DEBUG):
        component = Component.read(strange, name="c")
        system = System("s\u202e", (component,), ())
        with pytest.warns(UnconnectedInputWarning, match="c.u"):
            result = simulate(system, stop_time=1.0, step=0.5)
    (column,) = result.names
    assert "\u202e" in column, "the name itself is as it was"
    shown = [repr(component), repr(system), component._repr_html_(), system._repr_html_(), result._repr_html_()]
    with pytest.raises(UnknownNameError) as unknown:
        result["c.x"]
    with pytest.raises(OrchestrationError) as refused:
        system.set({"c.a": 1.0})
    shown += [str(unknown.value), str(refused.value)]
    for command in (["info", strange], ["check", strange], ["run", strange, "--stop", "1", "--step", "0.5"]):
        outcome = adaptimp(*command)
        shown += [outcome.out, outcome.err]
    for text in shown:
        assert not UNSAFE.search(text), ascii(text)
        assert not re.search(r"^Error: forged", text, re.MULTILINE), text
    assert isinstance(result, Result)
