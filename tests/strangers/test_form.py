"""FMUs that break rules of form run, with one warning; `check` reports an error, and a strict run refuses them."""

import warnings
from pathlib import Path

import pytest

from orchestration import ArchiveError, FormalityWarning, Options, System, SystemDescriptionError, simulate
from orchestration.check import Severity, check
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import U, Y

DEPENDS = '<Unknown index="2" dependencies="1"/>'
ALONE = '<Unknown index="1" dependencies=""/>'
COUNT = '<ScalarVariable name="n" valueReference="0" causality="output"><Integer/></ScalarVariable>'
PARAMETER = '<ScalarVariable name="p" valueReference="2" causality="parameter" variability="constant">'
PARAMETER += '<Real start="1"/></ScalarVariable>'

ODD = {
    "a unit that is not defined": (
        {"variables": [U.replace("<Real", '<Real unit="V"'), Y], "outputs": DEPENDS},
        "u: the unit V is not declared",
    ),
    "an Integer without variability": (
        {"variables": [COUNT], "outputs": ALONE},
        "n has, by default, variability continuous, which only a Real can have",
    ),
    "an input without a start value": (
        {"variables": [U.replace(' start="3"', ""), Y], "outputs": DEPENDS},
        "u is an input, but no start value",
    ),
    "a calculated output with a start value": (
        {"variables": [U, Y.replace("<Real", '<Real start="1"')], "outputs": DEPENDS},
        "y has initial calculated, but a start value",
    ),
    "a constant parameter": (
        {"variables": [Y, PARAMETER], "outputs": ALONE},
        "p: causality parameter and variability constant exclude each other",
    ),
    "an identifier with a hyphen": (
        {"variables": [Y], "outputs": ALONE, "identifier": "an-FMU"},
        "The modelIdentifier 'an-FMU' is not a C identifier",
    ),
    "a folder twice": (
        {"variables": [Y], "outputs": ALONE, "entries": [("documentation/", b""), ("documentation/", b"")]},
        "The archive has the entries 'documentation/' and 'documentation/'",
    ),
    "pages whose names differ in case": (
        {
            "variables": [Y],
            "outputs": ALONE,
            "entries": [("documentation/index.html", b"a"), ("documentation/Index.html", b"b")],
        },
        "The archive has the entries 'documentation/index.html' and 'documentation/Index.html'",
    ),
    "no functions for states": (
        {"variables": [Y], "outputs": ALONE, "library": "stateless"},
        "Its library does not export fmi2GetFMUstate, fmi2SetFMUstate",
    ),
}


@pytest.fixture(params=ODD)
def odd(request: pytest.FixtureRequest, stranger: Stranger) -> tuple[Path, str]:
    """An FMU that breaks one rule, and what is said of it."""
    arguments, said = ODD[request.param]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # zipfile warns of a name that occurs twice
        return stranger("feedthrough", **arguments), said


def test_it_runs_with_one_warning(odd: tuple[Path, str]) -> None:
    path, said = odd
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = simulate(System.of({"m": path}), 0.5, 0.1)
    found = [str(w.message) for w in caught if issubclass(w.category, FormalityWarning)]
    assert len(found) == 1
    assert {w.filename for w in caught} == {__file__}
    assert found[0].startswith(f"stranger.fmu breaks a rule of FMI that no step needs: {said}")
    assert len(found[0]) <= 300
    assert len(result.time) == 6


@pytest.mark.filterwarnings("ignore::orchestration.FormalityWarning", "ignore::orchestration.UnconnectedInputWarning")
def test_its_values_are_right(stranger: Stranger) -> None:
    path = stranger("feedthrough", **ODD["a unit that is not defined"][0])
    result = simulate(System.of({"m": path}).set({"m.u": 2.5}), 0.5, 0.1, options=Options(record=["m.y"]))
    assert result["m.y"].tolist() == [25.0] * 6


def test_a_strict_run_refuses_it(odd: tuple[Path, str]) -> None:
    path, said = odd
    with pytest.raises(SystemDescriptionError) as refused:
        simulate(System.of({"m": path}), 0.5, 0.1, options=Options(strict=True))
    assert said in str(refused.value)


def test_check_reports_an_error(odd: tuple[Path, str]) -> None:
    path, said = odd
    found = [f.message for f in check(path).findings if f.severity == Severity.ERROR]
    assert any(said.removeprefix("Its library ").split(",")[0] in message for message in found), found


def test_a_good_one_gives_no_warning(stranger: Stranger) -> None:
    path = stranger("feedthrough", [U, Y], outputs=DEPENDS)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        simulate(System.of({"m": path}), 0.5, 0.1)
    assert not [w for w in caught if issubclass(w.category, FormalityWarning)]


@pytest.mark.parametrize("identifier", ["a/b", "a\\b", "..", ".", " ", "a\x7fb", "C:evil", "a*b"])
def test_an_identifier_that_leads_elsewhere_is_refused(stranger: Stranger, identifier: str) -> None:
    path = stranger("feedthrough", [Y], outputs=ALONE, identifier=identifier.replace("\x7f", "&#127;"))
    with pytest.raises(ArchiveError, match=r"the model identifier .* is not the name of a library|entry .* "):
        System.of({"m": path})


def test_a_needed_function_is_missed(stranger: Stranger) -> None:
    path = stranger("clock", [Y], outputs=ALONE, library="stateless", flags='canGetAndSetFMUstate="true"')
    with pytest.raises(ArchiveError, match=r"m: stranger\.fmu cannot be loaded: .* fmi2GetFMUstate, fmi2SetFMUstate"):
        simulate(System.of({"m": path}), 0.5, 0.1)
