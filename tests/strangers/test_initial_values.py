"""When start values are set, and of which variables (FMI 2.0.4, section 4.2.4)."""

from pathlib import Path

import numpy as np
import pytest

from orchestration import Connection, Fmu, System, SystemDescriptionError, prepare, simulate
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import U, Y

pytestmark = pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning")

DEPENDS = '<Unknown index="2" dependencies="1"/>'
X = '<ScalarVariable name="x" valueReference="3" causality="output" initial="exact"><Real start="1"/></ScalarVariable>'
V = X.replace("exact", "approx").replace("output", "local").replace('"x" valueReference="3"', '"v" valueReference="4"')
RELATIVE = '<Real unit="{}" relativeQuantity="true" start="0"/>'
UNITS = (
    '<UnitDefinitions><Unit name="K"><BaseUnit K="1"/></Unit>'
    '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit></UnitDefinitions>'
)


@pytest.fixture
def forgetful(stranger: Stranger) -> Path:
    """An FMU that forgets inputs that are set before the initialization mode; y = u."""
    return stranger("forgets", [U, Y], outputs=DEPENDS)


def test_inputs_start_in_initialization_mode(forgetful: Path) -> None:
    assert simulate(System.of({"m": forgetful}), 0.2, 0.1)["m.y"].tolist() == [3.0] * 3
    given = System.of({"m": forgetful}).set({"m.u": 7.0})
    assert simulate(given, 0.2, 0.1)["m.y"].tolist() == [7.0] * 3


def test_inputs_of_one_fmu_start_in_initialization_mode(forgetful: Path) -> None:
    with Fmu(forgetful) as fmu:
        assert fmu.outputs()["y"] == 3.0
    with Fmu(forgetful, u=7.0) as fmu:
        assert fmu.outputs()["y"] == 7.0


def test_a_chain_starts_with_what_arrives(forgetful: Path) -> None:
    system = System.of({"a": forgetful, "b": forgetful}).set({"a.u": 5.0}).connect("a.y -> b.u")
    assert simulate(system, 0.2, 0.1)["b.y"].tolist() == [5.0] * 3


def test_start_values_of_states_and_outputs_are_set(stranger: Stranger) -> None:
    path = stranger("state", [X, V], outputs='<Unknown index="1" dependencies=""/>')
    system = System.of({"m": path})
    np.testing.assert_allclose(simulate(system, 1.0, 0.25)["m.x"], [1, 1.125, 1.25, 1.375, 1.5])
    set_ = system.set({"m.x": 4.0, "m.v": -1.0})
    np.testing.assert_allclose(simulate(set_, 1.0, 0.25)["m.x"], [4, 3.75, 3.5, 3.25, 3.0])


def test_a_package_keeps_the_start_values_of_states(stranger: Stranger, tmp_path: Path) -> None:
    path = stranger("state", [X, V], outputs='<Unknown index="1" dependencies=""/>')
    package = System.of({"m": path}).set({"m.x": 4.0, "m.v": -1.0}).write(tmp_path / "s.ssp")
    assert simulate(package, 1.0, 0.25)["m.x"][-1] == 3.0


def test_a_state_cannot_be_set_during_a_run(stranger: Stranger) -> None:
    path = stranger("state", [X, V], outputs='<Unknown index="1" dependencies=""/>')
    with prepare(System.of({"m": path}), 1.0, 0.25) as run:
        run.run(until=0.5)
        with pytest.raises(SystemDescriptionError, match=r"m\.x has causality output; .* can be set during a run"):
            run.set({"m.x": 4.0})


def test_what_the_fmu_computes_cannot_be_set(forgetful: Path) -> None:
    with pytest.raises(SystemDescriptionError, match=r"m\.y has causality output"):
        System.of({"m": forgetful}).set({"m.y": 1.0})


def test_a_difference_of_temperatures_has_no_offset(stranger: Stranger) -> None:
    """10 degC of difference arrive as 10 K; a temperature of 10 degC as 283.15 K."""
    for start, expected in ((RELATIVE, 10.0), ('<Real unit="{}" start="0"/>', 283.15)):
        output = '<ScalarVariable name="T" valueReference="2" causality="output" initial="exact">'
        output += start.format("degC") + "</ScalarVariable>"
        source = stranger("", [output], outputs='<Unknown index="1" dependencies=""/>', before=UNITS, name="source")
        sink = stranger(
            "feedthrough",
            [
                '<ScalarVariable name="u" valueReference="0" causality="input">'
                + start.format("K")
                + "</ScalarVariable>",
                Y,
            ],
            outputs=DEPENDS,
            before=UNITS,
            name="sink",
        )
        system = System.of({"a": source, "b": sink}).set({"a.T": 10.0}).connect(Connection("a", "T", "b", "u"))
        np.testing.assert_allclose(simulate(system, 0.2, 0.1)["b.y"], 10 * expected, rtol=1e-15)
