"""FMUs that live alone in a process, or take steps of one length only."""

import numpy as np
import pytest

from orchestration import Crossings, InitializationError, Options, System, SystemDescriptionError, simulate
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import P, Y

ALONE = '<Unknown index="1" dependencies=""/>'
SAVES = 'canGetAndSetFMUstate="true"'


def test_each_component_has_a_library_of_its_own(stranger: Stranger) -> None:
    """The FMU integrates its parameter, and keeps both in the memory of its library."""
    path = stranger("alone", [Y, P], outputs=ALONE, flags='canBeInstantiatedOnlyOncePerProcess="true"')
    system = System.of({"a": path, "b": path}).set({"a.p": 2.0, "b.p": 6.0})
    result = simulate(system, 1.0, 0.25)
    assert result["a.y"].tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert result["b.y"].tolist() == [0.0, 1.5, 3.0, 4.5, 6.0]


def test_steps_of_one_length_are_taken(stranger: Stranger) -> None:
    path = stranger("one step", [Y], outputs=ALONE, flags=SAVES)
    result = simulate(System.of({"m": path}), 1.0, 0.1)
    np.testing.assert_allclose(result["m.y"][1:], result.time[1:])
    given = simulate(System.of({"m": path}), times=np.linspace(0, 1, 11))
    np.testing.assert_allclose(given["m.y"], result["m.y"], rtol=1e-15)


@pytest.mark.parametrize(
    ("more", "what"),
    [
        ({"stop_time": 1.0, "step": 0.1, "algorithm": "adaptive"}, "algorithm adaptive, which controls its step"),
        ({"times": np.array([0, 0.1, 0.3])}, "a run with communication points that differ in their distances"),
        (
            {"stop_time": 1.0, "step": 0.1, "options": Options(crossings=Crossings(("m.y",)))},
            r"locating crossings of m\.y",
        ),
    ],
)
def test_steps_of_several_lengths_are_refused_by_name(stranger: Stranger, more: dict, what: str) -> None:
    path = stranger("one step", [Y], outputs=ALONE, flags=SAVES)
    declares = "does not declare canHandleVariableCommunicationStepSize, which"
    with pytest.raises(SystemDescriptionError, match=rf"m: stranger\.fmu {declares} {what}"):
        simulate(System.of({"m": path}), **more)


@pytest.mark.parametrize("declared", [True, False])
def test_a_tool_that_is_missing_is_named_where_it_is_needed(stranger: Stranger, *, declared: bool) -> None:
    flags = 'needsExecutionTool="true"' if declared else ""
    path = stranger("toolless", [Y], outputs=ALONE, name="their", flags=flags)
    with pytest.raises(InitializationError, match=r"fmi2Instantiate failed; .*the tool is not installed") as refused:
        simulate(System.of({"m": path}), 1.0, 0.1)
    said = "their.fmu declares needsExecutionTool: the tool that exported it must be installed."
    assert str(refused.value).endswith(said) is declared
