"""Texts, items of Enumerations, and parameters that happen to have a name of ours."""

from pathlib import Path

import pytest

from orchestration import ProcessChangedWarning, System, SystemDescriptionError, simulate
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import P, U, Y

pytestmark = pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning")

ALONE = '<Unknown index="1" dependencies=""/>'
TEXT = '<ScalarVariable name="s" valueReference="0" causality="parameter" variability="fixed"><String start="abc"/>'
TEXT += "</ScalarVariable>"
MODE = '<SimpleType name="Mode"><Enumeration><Item name="off" value="1"/><Item name="on" value="2"/></Enumeration>'
MODE = f"<TypeDefinitions>{MODE}</SimpleType></TypeDefinitions>"
CHOSEN = '<ScalarVariable name="mode" valueReference="3" causality="parameter" variability="fixed">'
CHOSEN += '<Enumeration declaredType="Mode" start="2"/></ScalarVariable>'
TENFOLD = '<ScalarVariable name="tenfold" valueReference="2" causality="output" variability="discrete"><Integer/>'
TENFOLD += "</ScalarVariable>"
PERIOD = '<ScalarVariable name="sample_time" valueReference="2" causality="parameter" variability="fixed">'


@pytest.fixture
def text(stranger: Stranger) -> System:
    """A component that shows the length of a text."""
    return System.of({"m": stranger("text", [Y, TEXT], outputs=ALONE)})


@pytest.fixture
def choice(stranger: Stranger) -> System:
    """A component that shows the number of an item, tenfold."""
    return System.of({"m": stranger("choice", [TENFOLD, CHOSEN], outputs=ALONE, before=MODE)})


def test_a_text_is_set(text: System) -> None:
    assert simulate(text, 0.2, 0.1)["m.y"][-1] == 3.0
    assert simulate(text.set({"m.s": "a longer text"}), 0.2, 0.1)["m.y"][-1] == 13.0


def test_a_package_keeps_a_text(text: System, tmp_path: Path) -> None:
    package = text.set({"m.s": "größer"}).write(tmp_path / "s.ssp")
    assert System.read(package)["m"].start == {"s": "größer"}
    assert simulate(package, 0.2, 0.1)["m.y"][-1] == len("größer".encode())


def test_a_text_takes_no_number(text: System) -> None:
    with pytest.raises(SystemDescriptionError, match=r"m\.s = 3: a text is needed, since the variable is a String"):
        text.set({"m.s": 3})


def test_items_are_set_by_name_and_by_number(choice: System) -> None:
    assert simulate(choice, 0.2, 0.1)["m.tenfold"][-1] == 20
    for value in ("off", 1, "1"):
        assert simulate(choice.set({"m.mode": value}), 0.2, 0.1)["m.tenfold"][-1] == 10


def test_a_package_gives_the_name_of_an_item(choice: System, tmp_path: Path) -> None:
    package = choice.set({"m.mode": "off"}).write(tmp_path / "s.ssp")
    import zipfile

    with zipfile.ZipFile(package) as archive:
        (values,) = [archive.read(name).decode() for name in archive.namelist() if name.endswith(".ssv")]
    assert 'Enumeration value="off"' in values
    assert simulate(package, 0.2, 0.1)["m.tenfold"][-1] == 10


def test_another_item_is_refused_with_those_that_there_are(choice: System) -> None:
    with pytest.raises(
        SystemDescriptionError, match=r"m\.mode = 'of': an item .* is needed, such as off \(1\), on \(2\)"
    ):
        choice.set({"m.mode": "of"})


@pytest.mark.parametrize(
    "declared",
    [
        '<Real start="0.7"/>',  # in no unit
        '<Integer start="3"/>',
        '<Real start="0.7" unit="s"/>',  # beside a continuous output
    ],
)
def test_a_parameter_of_that_name_is_no_sampling_period(stranger: Stranger, declared: str) -> None:
    seconds = '<UnitDefinitions><Unit name="s"><BaseUnit s="1"/></Unit></UnitDefinitions>'
    variables = [Y, PERIOD + declared + "</ScalarVariable>"]
    system = System.of({"m": stranger("clock", variables, outputs=ALONE, before=seconds)})
    assert system.sample_times == {}
    assert len(simulate(system, 1.0, 0.1).time) == 11


def test_an_fmu_that_writes_into_what_it_reads_is_named_and_does_no_harm_when_isolated(stranger: Stranger) -> None:
    """Values go from an output to an input without a copy, so such an FMU changes the output of another."""
    clock = stranger("alone", [Y, P], outputs=ALONE, name="clock")
    writes = stranger("overwrites", [U, Y], outputs=ALONE, name="writes")
    system = System.of({"clock": clock, "w": writes}).connect("clock.y -> w.u")
    with pytest.warns(ProcessChangedWarning, match="^w: fmi2SetReal writes into the values that it is given to read"):
        simulate(system, 1.0, 0.25)
    assert simulate(system, 1.0, 0.25, isolate=["w"])["clock.y"].tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
