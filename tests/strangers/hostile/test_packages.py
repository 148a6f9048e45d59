"""Tests that packages whose systems, wires, sources or parameters explode are refused, or read in no time."""

import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from orchestration import ArchiveError, System, SystemDescriptionError
from tests.faults.cli import Command
from tests.strangers.fmus import P, U, Y, description
from tests.strangers.hostile.archives import LIBRARY
from tests.strangers.hostile.packages import component, connectors, described, package, wire
from tests.strangers.hostile.test_archives import assert_said
from tests.strangers.hostile.zips import Row, zipped

XML = description("feedthrough", [U, Y, P], outputs='<Unknown index="2" dependencies="1"/>')
FMU = zipped([Row("modelDescription.xml", XML.encode()), Row(LIBRARY)])
ENDS = connectors(u="input", y="output")
COMPONENTS = component("a", ENDS) + component("b", ENDS)
SOURCE = 'source="resources/b.fmu"'


def system(name: str, elements: str = "", wires: str = "") -> str:
    """A system with an input u and an output y."""
    inner = f"<ssd:Elements>{elements}</ssd:Elements>" if elements else ""
    return f'<ssd:System name="{name}">{ENDS}{inner}<ssd:Connections>{wires}</ssd:Connections></ssd:System>'


def outer(elements: str, wires: str) -> str:
    """The outermost system of some elements and two FMUs."""
    joined = f"<ssd:Connections>{wires}</ssd:Connections>" if wires else ""
    return described(f"<ssd:Elements>{COMPONENTS}{elements}</ssd:Elements>{joined}")


def row_of_systems(n: int, times: int) -> str:
    """Systems that hand on what they get; each is wired to the next one several times."""
    names = [f"s{i}" for i in range(n)]
    links = "".join(wire(f"{a}.y", f"{b}.u") * times for a, b in pairwise(names))
    ends = wire("a.y", "s0.u") + wire(f"s{n - 1}.y", "b.u")
    return outer("".join(system(name, wires=wire("u", "y")) for name in names), ends + links)


def nested(n: int, times: int) -> str:
    """Systems in systems; each hands its input to the next one several times."""
    text = system("s", wires=wire("u", "y"))
    for _ in range(n):
        text = system("s", text, wire("u", "s.u") * times + wire("s.y", "y"))
    return outer(text, wire("a.y", "s.u") + wire("s.y", "b.u"))


def circle(n: int) -> str:
    """Systems in a circle without a component, entered from one."""
    names = [f"s{i}" for i in range(n)]
    links = "".join(wire(f"{a}.y", f"{b}.u") for a, b in zip(names, [*names[1:], names[0]], strict=True))
    return outer("".join(system(name, wires=wire("u", "y")) for name in names), wire("a.y", "s0.u") + links)


def bound(n: int) -> str:
    """Bindings of one parameter set with 1000 parameters, again and again."""
    bindings = '<ssd:ParameterBinding source="many.ssv"/>' * n
    return outer(component("c", f"<ssd:ParameterBindings>{bindings}</ssd:ParameterBindings>"), "")


PARAMETERS = "".join(
    f'<ssv:Parameter name="{"a." * 300}{i}"><ssv:Real value="1"/></ssv:Parameter>' for i in range(1000)
)
MANY = '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0"'
MANY += f' name="p"><ssv:Parameters>{PARAMETERS}</ssv:Parameters></ssv:ParameterSet>'
TWICE = r"the connector .* gets its value twice, from .* and from "
PLAIN = outer("", wire("a.y", "b.u"))

REFUSED: dict[str, tuple[Callable[[], str], type[Exception], str]] = {
    "30 systems with doubled wires": (lambda: row_of_systems(30, 2), SystemDescriptionError, TWICE),
    "a fan-out of 2^28": (lambda: nested(28, 2), SystemDescriptionError, TWICE),
    "a fan-out of 3^40": (lambda: nested(40, 3), SystemDescriptionError, TWICE),
    "a connector with two sources": (
        lambda: outer(system("s", wires=wire("u", "y")), wire("a.y", "s.u") + wire("b.y", "s.u") + wire("s.y", "a.u")),
        SystemDescriptionError,
        TWICE,
    ),
    "a circle of 400 systems": (lambda: circle(400), SystemDescriptionError, "in a circle without a component"),
    "a circle of one": (lambda: circle(1), SystemDescriptionError, r"s0\.u -> s0\.y -> s0\.u"),
    "100 systems in one another": (lambda: nested(100, 1), ArchiveError, "nested more than 128 deep"),
    "a source in a folder above": (
        lambda: PLAIN.replace(SOURCE, 'source="../../../../etc/passwd"'),
        ArchiveError,
        "leads outside the package",
    ),
    "a source of 300 characters": (
        lambda: PLAIN.replace(SOURCE, f'source="{"x" * 300}"'),
        ArchiveError,
        "is not in the package",
    ),
    "a source of 2000 characters": (
        lambda: PLAIN.replace(SOURCE, f'source="{"x" * 2000}"'),
        ArchiveError,
        "attribute source of 2000 characters",
    ),
    "a source with a NUL": (lambda: PLAIN.replace(SOURCE, 'source="%00"'), ArchiveError, "leads outside"),
    "a source on the network": (
        lambda: PLAIN.replace(SOURCE, 'source="http://localhost:1/b.fmu"'),
        ArchiveError,
        "lies elsewhere",
    ),
    "a folder as a source": (
        lambda: PLAIN.replace(SOURCE, 'source="resources"'),
        ArchiveError,
        "is not in the package",
    ),
    "310 bindings of a set of 1000": (lambda: bound(310), SystemDescriptionError, "more than 300000 parameters"),
    "an FMU that is a description": (
        lambda: PLAIN.replace(SOURCE, 'source="SystemStructure.ssd"'),
        ArchiveError,
        "is not a readable zip archive",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_it_is_refused(name: str, tmp_path: Path, adaptimp: Command, left_over: Callable[[], list[str]]) -> None:
    make, error, rule = REFUSED[name]
    path = tmp_path / "given" / "hostile.ssp"
    path.write_bytes(
        package({"a": FMU, "b": FMU, "c": FMU}, structure=make(), entries=[Row("many.ssv", MANY.encode())])
    )
    with pytest.raises(error) as refused:
        System.read(path)
    if "zip" not in rule:
        assert_said(refused.value, path, rule)
    outcome = adaptimp("info", path)
    assert outcome.code == 2
    assert re.search(rule, outcome.sentence)
    assert not left_over()


@pytest.mark.parametrize("make", [lambda: row_of_systems(2000, 1), lambda: nested(50, 1)], ids=["2000", "50 nested"])
def test_long_rows_of_systems_are_read(make: Callable[[], str], tmp_path: Path, left_over) -> None:
    path = tmp_path / "given" / "long.ssp"
    path.write_bytes(package({"a": FMU, "b": FMU}, structure=make()))
    assert [str(c) for c in System.read(path).connections] == ["a.y -> b.u"]
    assert [name for name in left_over() if "temporary" in name] == []


def test_links_that_lead_nowhere_are_one_sentence(tmp_path: Path, adaptimp: Command) -> None:
    loop = tmp_path / "loop.ssp"
    loop.symlink_to(loop)
    for path in (loop, tmp_path / f"{'x' * 300}.ssp", tmp_path / ("y/" * 3000) / "z.fmu"):
        with pytest.raises(ArchiveError) as refused:
            System.read(path) if path.suffix == ".ssp" else System.of({"m": path})
        assert len(str(refused.value).replace(str(tmp_path), "")) <= 300
        assert adaptimp("info", path).code in (1, 2)
