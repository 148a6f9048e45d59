"""Tests that every file gets a report: random bytes, damaged archives, descriptions and libraries."""

import io
import json
import random
import re
import struct
import tempfile
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from adaptimp_fmu.toolchain import host_platform
from orchestration.check import Report, Severity
from orchestration.check.findings import ROLE
from orchestration.check.static import archive_rules, elf
from orchestration.sandbox.zip.content import Content
from tests.unit.orchestration.checked import DESCRIPTION, MISBEHAVING, assert_found, check, repacked
from tests.unit.orchestration.mutated import RICH, mutant

HOST = host_platform()
LIBRARY = f"binaries/{HOST.name}/Actuator{HOST.extension}"
MUTANTS = 1000
PLAIN = MISBEHAVING.replace("FAULT", "none")
_VALUE = re.compile(r'(\w+)="([^"]*)"')
HOSTILE = [
    "",
    "-1",
    "0",
    "4294967295",
    "99999999999999999999",
    "NaN",
    "INF",
    "-INF",
    "1e999",
    "true",
    "é😀",
    "../x",
    "a" * 9999,
]


def examined(content: bytes) -> Report:
    """The report on a file, which is JSON and has a summary."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fuzzed.fmu"
        path.write_bytes(content)
        report = check(path, timeout=2.0)
    assert json.loads(report.json())["errors"] == report.count(Severity.ERROR)
    assert report.summary().startswith("fuzzed.fmu")
    assert all(finding.message.isprintable() and len(finding.message) < 1500 for finding in report.findings)
    return report


def archived(description: str | bytes, **others: bytes) -> bytes:
    """An archive with a description."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(DESCRIPTION, description)
        for name, data in others.items():
            archive.writestr(name, data)
    return content.getvalue()


@pytest.fixture(scope="session")
def actuator(fmu_folder: Path) -> bytes:
    """A whole FMU."""
    return (fmu_folder / "Actuator.fmu").read_bytes()


@given(content=st.binary(max_size=400))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_random_bytes(content: bytes) -> None:
    for start in (b"", b"PK\x03\x04", b"PK\x05\x06"):
        assert examined(start + content).failed


@given(description=st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_random_descriptions(description: bytes) -> None:
    assert examined(archived(description)).failed


@given(data=st.data())
@settings(max_examples=150, deadline=None, derandomize=True)
def test_descriptions_with_a_few_wrong_values(data: st.DataObject) -> None:
    """Valid or not against the schema; there is no binary that could run."""
    places = list(_VALUE.finditer(PLAIN))[3:]
    xml = PLAIN
    for place in sorted(data.draw(st.sets(st.sampled_from(places), min_size=1, max_size=4)), key=lambda m: -m.start()):
        value = data.draw(st.sampled_from(HOSTILE) | st.text("01-+.eEnN ax[]{}';", max_size=6))
        value = value.replace("&", "").replace("<", "").replace('"', "")
        xml = f"{xml[: place.start(2)]}{value}{xml[place.end(2) :]}"
    assert examined(archived(xml)).failed


@given(data=st.data())
@settings(max_examples=80, deadline=None, derandomize=True)
def test_descriptions_without_some_lines(data: st.DataObject) -> None:
    lines = PLAIN.splitlines(keepends=True)
    gone = data.draw(st.sets(st.integers(1, len(lines) - 1), min_size=1, max_size=3))
    twice = data.draw(st.integers(1, len(lines) - 1))
    xml = "".join(line * (2 if i == twice else 1) for i, line in enumerate(lines) if i not in gone)
    examined(archived(xml))


def test_mutants_of_a_rich_description() -> None:
    """A quarter of them gets past the schema, and every rule about files finds something."""
    seen = []
    for seed in range(MUTANTS):
        try:
            report = examined(archived(mutant(random.Random(seed), RICH)))
        except Exception as error:
            error.add_note(f"seed {seed}")
            raise
        seen.append({f.rule for f in report.findings if f.severity != Severity.NOTE})
    assert sum("1" not in rules for rules in seen) > MUTANTS / 4
    assert set.union(*seen) >= {"1", "2", "3", "4", "5", "6", "7", ROLE}


def test_cut_archives(actuator: bytes) -> None:
    for n in range(0, len(actuator), len(actuator) // 40):
        assert examined(actuator[:n]).failed


def test_flipped_bytes(actuator: bytes) -> None:
    """In the directory at the end, where they matter, and anywhere."""
    rng = random.Random(5)
    for i in range(60):
        damaged = bytearray(actuator)
        for _ in range(3):
            damaged[-rng.randrange(1, 1500) if i % 2 else rng.randrange(len(damaged))] ^= 1 << rng.randrange(8)
        examined(bytes(damaged))


def test_damaged_libraries(fmu_folder: Path, tmp_path: Path) -> None:
    """They are loaded, and may crash, in another process."""
    fmu = fmu_folder / "Actuator.fmu"
    with zipfile.ZipFile(fmu) as archive:
        library = archive.read(LIBRARY)
    rng = random.Random(7)
    for i in range(16):
        damaged = bytearray(library)
        for _ in range(2**i % 500):
            damaged[rng.randrange(64 if i % 4 == 0 else len(damaged))] = rng.randrange(256)
        report = check(repacked(fmu, tmp_path, {LIBRARY: bytes(damaged)}), timeout=2.0)
        assert json.loads(report.json())
    report = check(repacked(fmu, tmp_path, {LIBRARY: library[: len(library) // 2]}), timeout=2.0)
    assert report.failed


@pytest.mark.skipif(HOST.extension != ".so", reason="reads ELF files")
def test_damaged_tables_end_in_one_error(fmu_folder: Path) -> None:
    with zipfile.ZipFile(fmu_folder / "Actuator.fmu") as archive:
        library = archive.read(LIBRARY)
    rng = random.Random(9)
    for i in range(2000):
        damaged = bytearray(library[: rng.randrange(64, len(library))] if i % 3 == 0 else library)
        for _ in range(8):
            struct.pack_into("<Q", damaged, rng.randrange(16, min(4000, len(damaged)) - 8), rng.getrandbits(64))
        with suppress(elf.ElfError):
            elf.read(bytes(damaged))


CORPUS: dict[str, bytes] = {
    "empty": b"",
    "empty archive": b"PK\x05\x06" + bytes(18),
    "entities": archived(
        '<!DOCTYPE x [<!ENTITY a "aa"><!ENTITY b "&a;&a;&a;">]><fmiModelDescription>&b;</fmiModelDescription>'
    ),
    "file entity": archived('<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><fmiModelDescription guid="&a;"/>'),
    "UTF-16": archived('<?xml version="1.0" encoding="UTF-16"?><fmiModelDescription/>'.encode("utf-16")),
    "unknown encoding": archived('<?xml version="1.0" encoding="klingon"?><fmiModelDescription/>'),
    "deep": archived("<a>" * 5000),
    "other root": archived('<ssd fmiVersion="2.0"/>'),
    "namespace": archived('<fmiModelDescription xmlns="urn:x" fmiVersion="2.0"/>'),
    "huge name": archived(PLAIN.replace('name="u"', f'name="{"u" * 100_000}"')),
    "huge index": archived(
        PLAIN.replace('name="u"', f'name="tau_cmd[{"9" * 5000}]"').replace('name="y"', 'name="tau_cmd[999999999]"')
    ),
    "huge entry": archived(PLAIN, **{"n" * 5000: b""}),
    "bomb": archived(b" " * 40 * 1024**2),
    "large bomb elsewhere": archived(PLAIN, zeros=bytes(8 * 1024**2)),
    "large but legal": archived(
        PLAIN.replace("</ModelStructure>", "</ModelStructure>" + "<!-- " + "-x" * 300_000 + " -->")
    ),
}


ZEROS = "0" * 5000  # legal before an integer of the schema; Python's int refuses so many digits
LONG_NUMBERS: dict[str, tuple[str, str]] = {
    "value reference": ('valueReference="0"', f'valueReference="{ZEROS}"'),
    "index": ('<Unknown index="2"', f'<Unknown index="{ZEROS}2"'),
    "dependency": ('dependencies="1"', f'dependencies="{ZEROS}1"'),
    "derivative": ('<Real start="0"/>', f'<Real start="0" derivative="{ZEROS}1"/>'),
    "exponent": (
        "<DefaultExperiment",
        f'<UnitDefinitions><Unit name="x"><BaseUnit m="-{ZEROS}1"/></Unit></UnitDefinitions><DefaultExperiment',
    ),
}


@pytest.mark.parametrize("name", list(LONG_NUMBERS))
def test_numbers_with_thousands_of_zeros(name: str) -> None:
    old, new = LONG_NUMBERS[name]
    changed = PLAIN.replace(old, new, 1)
    assert changed != PLAIN
    report = examined(archived(changed))
    assert [f.rule for f in report.findings if f.severity == Severity.ERROR] == ["6"], "there is no binary, and no more"


def test_the_zeros_are_not_lost() -> None:
    changed = PLAIN.replace('<Unknown index="2" dependencies="1"/></Init', f'<Unknown index="{ZEROS}300"/></Init')
    sentence = "InitialUnknowns: the index 300 is not that of a variable"
    assert_found(examined(archived(changed)), "4", Severity.ERROR, sentence)


def test_thousands_of_sources_take_no_longer_than_their_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The archive is opened a few times, not for each of them; findings are counted, not kept."""
    opened, plain = [], Content.__init__

    def counted(content: Content, file: Any) -> None:
        opened.append(file)
        plain(content, file)

    content = archived(PLAIN, **{f"sources/{i}.c": b'#include "x.h"\n' * 50 for i in range(3000)})
    monkeypatch.setattr(Content, "__init__", counted)
    report = examined(content)
    assert 0 < len(opened) < 30
    assert_found(report, "7", Severity.WARNING, "There are 149992 more findings like these")


def test_more_sources_than_anyone_writes_are_left_unread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive_rules, "LARGEST_SOURCES", 100)
    sources = {f"sources/{i}.c": b'#include "x.h"\n' * 4 for i in range(3)}
    found = [f.message.partition(" ")[0] for f in examined(archived(PLAIN, **sources)).findings if f.rule == "7"]
    assert found == ["sources/0.c", "sources/1.c"], "60 bytes and the 40 left; the third is not opened"


def library(symbols: int, names: bytes) -> bytes:
    """An ELF file with a table of symbols whose names begin at 1, 2, 3, ... in `names`."""
    table, dynamic = 64 + 2 * 56, 64 + 2 * 56 + 24 * symbols
    hash_table = dynamic + 4 * 16
    strings = hash_table + 8
    content = bytearray(strings) + b"\0" + names
    content[:6] = b"\x7fELF\x02\x01"
    struct.pack_into("<H", content, 18, 62)
    struct.pack_into("<Q", content, 32, 64)
    struct.pack_into("<HH", content, 54, 56, 2)
    struct.pack_into("<IIQQQQ", content, 64, 1, 0, 0, 0, 0, len(content))
    struct.pack_into("<IIQQQQ", content, 120, 2, 0, dynamic, 0, 0, 64)
    for i in range(symbols):
        struct.pack_into("<IBBHQQ", content, table + 24 * i, i, 0x12, 0, 1, 0, 0)
    for i, entry in enumerate([(5, strings), (6, table), (4, hash_table), (0, 0)]):
        struct.pack_into("<QQ", content, dynamic + 16 * i, *entry)
    struct.pack_into("<II", content, hash_table, 1, symbols)
    return bytes(content)


def test_symbols_without_an_end_cost_no_memory() -> None:
    """2000 names of 4 MB each would be 8 GB."""
    assert elf.read(library(4, b"abc\0")).exported == {"abc", "bc", "c"}
    with pytest.raises(elf.ElfError, match="no end, or is too long"):
        elf.read(library(2000, b"a" * 4_000_000 + b"\0"))


@pytest.mark.parametrize("name", list(CORPUS))
def test_hostile_files(name: str) -> None:
    report = examined(CORPUS[name])
    assert report.failed
    assert "root:" not in report.json()


def test_a_hundred_thousand_variables_take_seconds() -> None:
    rows = "".join(f'<ScalarVariable name="v{i}" valueReference="{i}"><Real/></ScalarVariable>' for i in range(100_000))
    report = examined(archived(PLAIN.replace("</ModelVariables>", rows + "</ModelVariables>")))
    assert_found(report, "6", Severity.ERROR, "no binary for")
