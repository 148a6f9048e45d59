"""Good files with a few damaged bytes, and the readers that must answer each of them with a named error or a value."""

import random
import re
import struct
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

from orchestration import OrchestrationError, System
from orchestration.check.static.archive_rules import UnreadableError, open_package
from orchestration.fmi.description import read_description
from orchestration.sandbox.archive import screen, unpack
from orchestration.sandbox.native_library import require_loadable
from orchestration.sandbox.xml import XmlError, parse_xml
from tests.strangers.fmus import P, U, Y, description
from tests.strangers.hostile.archives import BASE, LIBRARY
from tests.strangers.hostile.packages import component, connectors, described, package, wire
from tests.strangers.hostile.zips import DEFLATED, Row, zipped

LONGEST = 4000  # characters of a message, which may show three names of 1000
NAMED = (OrchestrationError, XmlError, UnreadableError)
UNIT = '<UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>'
XML = description("feedthrough", [U, Y, P], outputs='<Unknown index="2" dependencies="1"/>', before=UNIT)
FMU = zipped([Row("modelDescription.xml", XML.encode(), DEFLATED), Row(LIBRARY, b"no library" * 9)])
SSV = (
    '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" name="p">'
)
SSV += (
    '<ssv:Parameters><ssv:Parameter name="p"><ssv:Real value="2"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet>'
)
ENDS = connectors(u="input", y="output")
BOUND = '<ssd:ParameterBindings><ssd:ParameterBinding source="p.ssv"/></ssd:ParameterBindings>'
INNER = f'<ssd:System name="s">{ENDS}<ssd:Connections>{wire("u", "y")}</ssd:Connections></ssd:System>'
WIRES = wire("a.y", "s.u") + wire("s.y", "b.u")
ELEMENTS = component("a", ENDS + BOUND) + component("b", ENDS) + INNER
SSD = described(f"<ssd:Elements>{ELEMENTS}</ssd:Elements><ssd:Connections>{WIRES}</ssd:Connections>")
PARTS = {"a": FMU, "b": FMU}
SSP = package(PARTS, structure=SSD, entries=[Row("p.ssv", SSV.encode())])
NESTED = zipped([*BASE, Row("resources/inner.fmu", FMU, DEFLATED), Row("resources/a/", b"")], wide={})
VALUES = (
    b"",
    b"-1",
    b"1e999",
    b"NaN",
    b"99999999999999999999",
    b"true",
    b"../x",
    b"a.b",
    b"x" * 1001,
    b"&#0;",
    b"&lt;",
)
_RECORD, _VALUE, _TAG = re.compile(rb"PK[\x01-\x06]{2}"), re.compile(rb'="([^"]*)"'), re.compile(rb"<[^>]*>")
INTERESTING = (
    b"\0",
    b"\xff",
    b"<",
    b"&",
    b'"',
    b"=",
    b"../",
    b"PK\x01\x02",
    b"PK\x05\x06",
    b"\xff\xff\xff\xff",
    b"-1",
    b"1e999",
)


def mutated(content: bytes, seed: int) -> bytes:
    """The content with one to three changes, all of bytes, all of the same length, or all of values and tags of XML."""
    chosen, data = random.Random(seed), bytearray(content)
    change = chosen.choice((_any_bytes, _same_length, _same_length, _values))
    for _ in range(chosen.randint(1, 3)):
        if data:
            change(data, chosen)
    return bytes(data)


def _any_bytes(data: bytearray, chosen: random.Random) -> None:
    """Insert, cut, double or move a stretch of bytes."""
    place, length = chosen.randrange(len(data)), chosen.choice((1, 2, 4, 8, 40))
    piece = data[place : place + length]
    match chosen.randrange(4):
        case 0:
            data[place:place] = chosen.choice(INTERESTING)
        case 1:
            del data[place : place + length]
        case 2:
            data[place:place] = piece * chosen.choice((1, 2, 50))
        case _:
            data[place:place] = bytes(data[chosen.randrange(len(data)) :][:length])


def _same_length(data: bytearray, chosen: random.Random) -> None:
    """Change a bit, a number or a few bytes, most often in one of the records of an archive."""
    records = [found.start() + chosen.randrange(46) for found in _RECORD.finditer(data)]
    place = chosen.choice(records) if records and chosen.random() < 0.7 else chosen.randrange(len(data))
    place = min(place, len(data) - 1)
    match chosen.randrange(3):
        case 0:
            data[place] ^= 1 << chosen.randrange(8)
        case 1:
            number = struct.pack("<I", chosen.choice((0, 1, 2**16 - 1, 2**31, 2**32 - 1, len(data))))
            data[place : place + 4] = number[: len(data) - place]
        case _:
            data[place] = chosen.choice((0, 1, 0xFF, ord("<"), ord("/"), ord(".")))


def _values(data: bytearray, chosen: random.Random) -> None:
    """Replace a value of an attribute, or double, remove or move a tag; other files get a change of the same length."""
    values, tags = list(_VALUE.finditer(data)), list(_TAG.finditer(data))
    if not values or not tags:
        _same_length(data, chosen)
        return
    value, tag, other = chosen.choice(values), chosen.choice(tags), chosen.choice(tags)
    match chosen.randrange(4):
        case 0:
            data[value.start(1) : value.end(1)] = chosen.choice(VALUES)
        case 1:
            data[value.start(1) : value.end(1)] = chosen.choice(values)[1]
        case 2:
            data[tag.start() : tag.end()] = tag[0] * chosen.choice((0, 2, 3))
        case _:
            data[tag.start() : tag.start()] = other[0]


def read_fmu(content: bytes, folder: Path) -> None:
    """Screen and unpack an FMU, and read its description as a run does and as a check does."""
    path = folder / "fuzzed.fmu"
    path.write_bytes(content)
    screen(path)
    (folder / "unpacked").mkdir(exist_ok=True)
    unpack(path, folder / "unpacked")
    read_description(path)
    open_package(path)


def read_package(content: bytes, folder: Path) -> None:
    """Read a package."""
    path = folder / "fuzzed.ssp"
    path.write_bytes(content)
    System.read(path)


def read_structure(content: bytes, folder: Path) -> None:
    """Read a package with this description of the structure."""
    _repacked(content, SSV.encode(), folder)


def read_parameters(content: bytes, folder: Path) -> None:
    """Read a package with this parameter set."""
    _repacked(SSD.encode(), content, folder)


def _repacked(structure: bytes, parameters: bytes, folder: Path) -> None:
    fmus = [Row(f"resources/{name}.fmu", fmu) for name, fmu in PARTS.items()]
    rows = [Row("SystemStructure.ssd", structure), Row("p.ssv", parameters), *fmus]
    read_package(zipped(rows), folder)


def read_model_description(content: bytes, folder: Path) -> None:
    """Read an FMU with this modelDescription.xml."""
    read_fmu(zipped([Row("modelDescription.xml", content), Row(LIBRARY)]), folder)


def read_xml(content: bytes, _: Path) -> None:
    """Parse XML."""
    parse_xml(content)


def read_library(content: bytes, folder: Path) -> None:
    """Examine a shared library."""
    (folder / "library").write_bytes(content)
    require_loadable(folder / "library", folder)


def _header_of_python() -> bytes:
    """The first bytes of a real library."""
    import _ctypes

    with Path(_ctypes.__file__).open("rb") as file:
        return file.read(4096)


Reader = Callable[[bytes, Path], None]
TARGETS: Mapping[str, tuple[Reader, tuple[bytes, ...]]] = {
    "archive": (read_fmu, (FMU, NESTED)),
    "description": (read_model_description, (XML.encode(), XML.replace("UTF-8", "UTF-16").encode("utf-16"))),
    "package": (read_package, (SSP,)),
    "structure": (read_structure, (SSD.encode(),)),
    "parameters": (read_parameters, (SSV.encode(),)),
    "xml": (read_xml, (XML.encode(), SSD.encode(), XML.encode("utf-16"))),
    "library": (read_library, (_header_of_python(),)),
}


def examine(read: Reader, content: bytes) -> str:
    """Give a content to a reader; returns the name of the error that it raises, empty if there is none.

    Every other exception passes. An `AssertionError` means that the message is too long, or that a file was written
    outside of the reader's folder.
    """
    with tempfile.TemporaryDirectory() as name:
        outer = Path(name)
        (outer / "inner" / "folder").mkdir(parents=True)
        error = ""
        try:
            read(content, outer / "inner" / "folder")
        except NAMED as failed:
            error, message = type(failed).__name__, str(failed)
            assert len(message) <= LONGEST, message
        assert [p.name for p in outer.iterdir()] == ["inner"]
        assert [p.name for p in (outer / "inner").iterdir()] == ["folder"]
        return error


def seen_by_others(content: bytes) -> list[str] | None:
    """Names of the entries that Python's own reader finds; None if it finds no archive."""
    with tempfile.TemporaryFile() as file:
        file.write(content)
        try:
            with zipfile.ZipFile(file) as archive:
                return archive.namelist()
        except (zipfile.BadZipFile, NotImplementedError, ValueError, OSError, EOFError):
            return None
