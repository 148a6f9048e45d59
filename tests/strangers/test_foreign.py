"""Each kind of foreign FMU behaves alike in Python, from a package and on the command line."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu.toolchain import host_platform
from orchestration import ArchiveError, InitializationError, Result, System, SystemDescriptionError, simulate
from tests.faults.cli import Command, Outcome, runner
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import COUNT, SAYS, P, U, Y, description

ALONE, DEPENDS, SILENT = (
    '<Unknown index="1" dependencies=""/>',
    '<Unknown index="2" dependencies="1"/>',
    '<Unknown index="2"/>',
)
IN = COUNT.format(0, "input", ' start="0"').replace('"n"', '"u"')
OUT = COUNT.format(1, "output", "").replace('"n"', '"y"')
ONCE = 'canBeInstantiatedOnlyOncePerProcess="true"'
STEP, STOP = 0.1, 0.5
Build = Callable[[Stranger], System]

pytestmark = pytest.mark.filterwarnings(
    "ignore::orchestration.UnconnectedInputWarning", "ignore::orchestration.FormalityWarning"
)


def one(kind: str, variables: list[str], outputs: str, **more: object) -> Build:
    """A system of one component m."""
    return lambda stranger: System.of({"m": stranger(kind, variables, outputs=outputs, **more)}, "s")


def two(kind: str, variables: list[str], outputs: str, *lines: str, **more: object) -> Build:
    """A system of two components a and b of one FMU, with connections."""
    return lambda stranger: System.of(
        dict.fromkeys(("a", "b"), stranger(kind, variables, outputs=outputs, **more)), "s"
    ).connect(*lines or ("a.y -> b.u", "b.y -> a.u"))


def of_two(stranger: Stranger) -> System:
    """Two components that share the memory of their library unless each has its own."""
    path = stranger("alone", [Y, P], outputs=ALONE, flags=ONCE)
    return System.of({"a": path, "b": path}, "s").set({"a.p": 2.0, "b.p": 6.0})


GOOD: dict[str, tuple[Build, dict[str, float | str]]] = {
    "a unit that is not defined": (
        one("feedthrough", [U.replace("<Real", '<Real unit="V"'), Y], DEPENDS),
        {"m.y": 30.0},
    ),
    "an Integer without variability": (
        one("choice", [OUT.replace('variability="discrete"', "")], ALONE),
        {"m.y": 1.0},
    ),
    "an input without a start value": (one("feedthrough", [U.replace(' start="3"', ""), Y], DEPENDS), {"m.y": 0.0}),
    "an identifier with a hyphen": (one("clock", [Y], ALONE, identifier="an-FMU"), {"m.y": STOP}),
    "no functions for states": (one("clock", [Y], ALONE, library="stateless"), {"m.y": STOP}),
    "an input that matters at the start": (one("forgets", [U, Y], DEPENDS), {"m.y": 3.0}),
    "a text": (one("speaks", [SAYS], ALONE), {"m.says": "t = 0.5 s"}),
    "once per process": (of_two, {"a.y": 1.0, "b.y": 3.0}),
    "one length of steps": (one("one step", [Y], ALONE), {"m.y": STOP}),
    "a tool that it says it needs": (one("clock", [Y], ALONE, flags='needsExecutionTool="true"'), {"m.y": STOP}),
    "a linear loop": (two("linear", [U, Y], DEPENDS), {"a.y": 2.0, "b.y": 2.0}),
    "a loop that is not declared": (two("linear", [U, Y], SILENT), {"a.y": 2.0, "b.y": 2.0}),
    "a loop with a root": (two("root", [U, Y], DEPENDS), {"a.y": 2.0, "b.y": 2.0}),
    "a loop of Integers with two solutions": (two("inverts", [IN, OUT], DEPENDS), {}),
}


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command line."""
    return runner(monkeypatch, capsys)


def run(adaptimp: Command, path: Path, *more: object) -> Outcome:
    """`adaptimp run` of a file."""
    return adaptimp("run", path, "--step", STEP, "--stop", STOP, "--no-verdict", *more)


@pytest.mark.parametrize("kind", GOOD)
def test_all_three_ways_give_the_same(kind: str, stranger: Stranger, adaptimp: Command, tmp_path: Path) -> None:
    build, expected = GOOD[kind]
    system = build(stranger)
    result = simulate(system, STOP, STEP)
    last = {name: result[name][-1] for name in result}
    for name, value in expected.items():
        assert last[name] == (value if isinstance(value, str) else pytest.approx(value, abs=1e-9))
    package, out = system.write(tmp_path / "s.ssp"), tmp_path / "x.parquet"
    from_package = simulate(package, STOP, STEP)
    assert run(adaptimp, package, "-o", out).code == 0
    for other in (from_package, Result.read(out)):
        np.testing.assert_array_equal(other.rows, result.rows)
        assert {n: t.tolist() for n, t in other.texts.items()} == {n: t.tolist() for n, t in result.texts.items()}
    if list(system) == ["m"]:
        assert run(adaptimp, system["m"].path, "-o", out).code == 0
        np.testing.assert_array_equal(Result.read(out).rows, result.rows)


def test_a_loop_without_a_solution_names_its_connection(stranger: Stranger, adaptimp: Command, tmp_path: Path) -> None:
    system = System.of({"m": stranger("inverts", [IN, OUT], outputs=DEPENDS)}, "s").connect("m.y -> m.u")
    said = "System s: discrete values do not settle during initialization in a loop of m.y -> m.u."
    with pytest.raises(InitializationError) as failed:
        simulate(system, STOP, STEP)
    assert str(failed.value) == said
    assert run(adaptimp, system.write(tmp_path / "s.ssp")).err == f"Error: {said}\n"


@pytest.mark.parametrize("encoding", ["ISO-8859-1", "UTF-16"])
def test_a_description_in_another_encoding(
    encoding: str, libraries: dict[str, Path], adaptimp: Command, tmp_path: Path
) -> None:
    xml = description("clock", [Y.replace('"y"', '"größe"')], outputs=ALONE).replace("UTF-8", encoding)
    path = tmp_path / "odd.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", xml.encode(encoding))
        archive.write(libraries["whole"], f"binaries/{host_platform().name}/Stranger{host_platform().extension}")
    system = System.of({"m": path}, "s")
    result = simulate(system, STOP, STEP)
    assert result["m.größe"][-1] == pytest.approx(STOP)
    out = tmp_path / "x.csv"
    for file in (path, system.write(tmp_path / "s.ssp")):
        assert run(adaptimp, file, "-o", out).code == 0
        np.testing.assert_array_equal(Result.read(out).rows, result.rows)


def of_another_kind(text: str) -> str:
    """The description of an FMU for model exchange."""
    return text.replace("CoSimulation", "ModelExchange")


def of_another_version(text: str) -> str:
    """The description of an FMU of FMI 3.0."""
    return text.replace('fmiVersion="2.0"', 'fmiVersion="3.0"')


def unchanged(text: str) -> str:
    """The description as it is; the FMU has no library."""
    return text


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (of_another_kind, r"is an FMI 2\.0 FMU for model exchange; one of FMI 2\.0 for co-simulation is needed"),
        (of_another_version, r"3\.0"),
        (unchanged, r"has no binary for \w+, this machine; it has none"),
    ],
)
def test_what_cannot_be_run_is_refused_in_one_sentence(
    change: Callable[[str], str], said: str, adaptimp: Command, tmp_path: Path
) -> None:
    path = tmp_path / "odd.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", change(description("clock", [Y], outputs=ALONE)))
        archive.writestr("sources/a.c", "int x;")
    with pytest.raises(ArchiveError, match=said) as refused:
        simulate(System.of({"m": path}), STOP, STEP)
    assert "\n" not in str(refused.value)
    outcome = run(adaptimp, path)
    assert outcome.code == 2
    assert outcome.err.startswith("Error: ")
    assert outcome.err.count("\n") == 1


def test_a_fixed_step_is_not_controlled(stranger: Stranger, adaptimp: Command, tmp_path: Path) -> None:
    system = System.of({"m": stranger("one step", [Y], outputs=ALONE, flags='canGetAndSetFMUstate="true"')}, "s")
    with pytest.raises(SystemDescriptionError, match="canHandleVariableCommunicationStepSize"):
        simulate(system, STOP, STEP, "adaptive")
    outcome = run(adaptimp, system.write(tmp_path / "s.ssp"), "--algorithm", "adaptive")
    assert "m: stranger.fmu does not declare canHandleVariableCommunicationStepSize" in outcome.err


def test_sixty_steps_a_second_do_not_drift(stranger: Stranger) -> None:
    """The FMU takes only steps whose length differs by less than 1e-12 s, and shows the end of its step."""
    result = simulate(System.of({"m": stranger("one step", [Y], outputs=ALONE)}), 100.0, 1 / 60)
    assert len(result.time) == 6001
    np.testing.assert_allclose(result["m.y"][1:], np.arange(1, 6001) / 60, rtol=4e-16)


def test_a_tool_that_an_fmu_needs_is_a_notice(stranger: Stranger, adaptimp: Command) -> None:
    path = stranger("clock", [Y], outputs=ALONE, flags='needsExecutionTool="true"')
    outcome = adaptimp("run", path, "--step", 0.1, "--stop", STOP, "--no-verdict")
    assert outcome.code == 0
    assert "Notice: stranger.fmu of stranger declares needsExecutionTool, so it runs only where" in outcome.err
