"""Names with every character, and variables of every type and causality: set and recorded, in Python and by command."""

from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

from orchestration import Result, System, simulate
from orchestration.cli.settings import listed, start_value
from tests.faults.cli import Command, runner
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import HEARS, SAYS, Y

pytestmark = pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning")

NAMES = [
    *("A[1,2]", "x[1]", "der(x)", "a.b[1].c", "'quoted \"name\"'", "with space", "comma,name", "two, commas,here"),
    *("ünïcode", "semi;colon", "a/b", "%s%n", "<b>&amp;", "time", "=1+1", "a=b", "*", "question?", "[1]"),
]
ALONE = '<Unknown index="{}" dependencies=""/>'


def parameter(name: str) -> str:
    """A parameter, and the output that shows it: both have one place in the FMU."""
    return (
        f'<ScalarVariable name={quoteattr(name)} valueReference="2" causality="parameter" variability="fixed">'
        '<Real start="1"/></ScalarVariable>'
    )


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command line."""
    return runner(monkeypatch, capsys)


@pytest.fixture
def named(stranger: Stranger) -> System:
    """A component whose parameters have all the names."""
    variables = [Y, *map(parameter, NAMES)]
    return System.of({"m": stranger("clock", variables, outputs=ALONE.format(1))})


@pytest.mark.parametrize("name", NAMES)
def test_python_sets_and_records_every_name(named: System, name: str) -> None:
    result = simulate(named.set({f"m.{name}": 2.5}), 0.2, 0.1, record=[f"m.{name}"])
    assert list(result) == [f"m.{name}"]
    assert result[f"m.{name}"].tolist() == [2.5] * 3


@pytest.mark.parametrize("name", NAMES)
def test_commands_set_and_record_every_name(named: System, name: str, adaptimp: Command, tmp_path: Path) -> None:
    package, out = named.write(tmp_path / "s.ssp"), tmp_path / "x.csv"
    asked = ("run", package, "--step", "0.1", "--stop", "0.2", "--no-verdict", "-o", out)
    outcome = adaptimp(*asked, "--set", f"m.{name}=2.5", "--record", f"m.{name},m.y")
    assert (outcome.code, outcome.err) == (0, "")
    result = Result.read(out)
    assert list(result) == [f"m.{name}", "m.y"]
    assert result[f"m.{name}"].tolist() == [2.5] * 3


def test_lists_of_names(named: System) -> None:
    given = ["m.y, m.comma,name,m.A[1,2]", "m.two, commas,here,m.other"]
    assert listed(given, named) == ["m.y", "m.comma,name", "m.A[1,2]", "m.two, commas,here", "m.other"]
    assert listed(None, named) is None
    assert start_value("m.a=b=3", named) == ("m.a=b", "3")
    assert start_value("m.with space=3", named) == ("m.with space", "3")
    assert start_value("m.y=a=b", named) == ("m.y", "a=b")


def typed(stranger: Stranger) -> System:
    """A component with locals, inputs and parameters of all types; they share places, so they show what was set."""

    def variable(name: str, place: int, causality: str, kind: str, more: str = "") -> str:
        variability = 'variability="discrete"' if causality != "parameter" else 'variability="tunable"'
        declared = f"<{kind} {more}/>"
        head = f'<ScalarVariable name="{name}" valueReference="{place}" causality="{causality}" {variability}>'
        return f"{head}{declared}</ScalarVariable>"

    mode = '<SimpleType name="Mode"><Enumeration><Item name="off" value="1"/><Item name="on" value="2"/></Enumeration>'
    variables = [
        Y,
        variable("i", 5, "input", "Integer", 'start="7"'),
        variable("b", 5, "input", "Boolean", 'start="true"'),
        variable("e", 6, "parameter", "Enumeration", 'declaredType="Mode" start="1"'),
        variable("s", 5, "parameter", "String", 'start="text"'),
        variable("local_i", 5, "local", "Integer"),
        variable("local_b", 5, "local", "Boolean"),
        variable("local_e", 6, "local", "Enumeration", 'declaredType="Mode"'),
        variable("local_s", 5, "local", "String"),
        HEARS,
        SAYS,
    ]
    outputs = ALONE.format(1) + ALONE.format(len(variables))
    before = f"<TypeDefinitions>{mode}</SimpleType></TypeDefinitions>"
    system = System.of({"m": stranger("text", variables, outputs=outputs, before=before)})
    return system.set({"m.i": 3, "m.b": False, "m.e": "on", "m.s": "set", "m.hears": "x"})


ALL = ["m.i", "m.b", "m.e", "m.s", "m.local_i", "m.local_b", "m.local_e", "m.local_s", "m.hears", "m.says", "m.y"]
EXPECTED = dict(zip(ALL, (3.0, 0.0, 2.0, "set", 3.0, 0.0, 2.0, "set", "x", "x!", 1.0), strict=True))


def test_python_records_every_type(stranger: Stranger) -> None:
    result = simulate(typed(stranger), 0.2, 0.1, record=ALL)
    assert {name: result[name].tolist() for name in ALL} == {name: [value] * 3 for name, value in EXPECTED.items()}
    np.testing.assert_array_equal(result.rows.dtype, np.float64)


def test_packages_and_commands_record_every_type(stranger: Stranger, adaptimp: Command, tmp_path: Path) -> None:
    package, out = typed(stranger).write(tmp_path / "s.ssp"), tmp_path / "x.parquet"
    asked = ("run", package, "--step", "0.1", "--stop", "0.2", "--no-verdict", "-o", out)
    assert adaptimp(*asked, "--record", ",".join(ALL)).code == 0
    result = Result.read(out)
    assert {name: result[name].tolist()[-1] for name in result} == EXPECTED
