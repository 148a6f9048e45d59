"""What a program cannot contain is refused by one sentence: which component, which file, why, and what to do."""

import re
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from orchestration import ArchiveError, ContainerError, System
from orchestration.containers.plan import plan_of
from tests.strangers.contained.fmus import packed_sources, small, small_description, small_sources

Make = Callable[[Path], Path]


def made(*, description: dict[str, Any] | None = None, edit: dict[str, str] | None = None) -> Make:
    """Makes a small FMU without a binary; `edit` replaces files."""
    return lambda folder: small(folder, "Odd", binary=False, edit=edit or {}, **(description or {}))


def changed(old: str, new: str) -> Make:
    """Makes a small FMU whose description is changed."""

    def make(folder: Path) -> Path:
        xml = small_description("Odd")
        assert old in xml
        return packed_sources(folder / "Odd.fmu", xml.replace(old, new), small_sources(), None)

    return make


def with_entry(name: str) -> Make:
    """Makes a small FMU with one more entry in its archive."""

    def make(folder: Path) -> Path:
        path = made()(folder)
        with zipfile.ZipFile(path, "a") as archive:
            archive.writestr(name, "data")
        return path

    return make


def without_sources(folder: Path) -> Path:
    return packed_sources(folder / "Odd.fmu", small_description("Odd"), {}, None)


def only_a_binary(folder: Path) -> Path:
    path = without_sources(folder)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("binaries/linux64/Odd.so", "data")
    return path


SMALL_C: str = small_sources()["small.c"]
ADVICE = r"; replace the component, or run the system without making a program of it\.$"
CASES: dict[str, tuple[Make, str]] = {
    "no sources": (without_sources, r"has neither sources nor binaries, and a program is made of C sources" + ADVICE),
    "a binary alone": (only_a_binary, r"has binaries only, and a program is made of C sources" + ADVICE),
    "no list": (
        made(description={"files": ()}),
        r"has sources, but its modelDescription\.xml lists no SourceFiles to compile" + ADVICE,
    ),
    "a file that is not there": (
        made(description={"files": ("small.c", "lost.c")}),
        r"lists the source file 'lost\.c', which is not in its archive" + ADVICE,
    ),
    "C++": (
        made(description={"files": ("small.c", "more.cpp")}, edit={"more.cpp": "class A {};"}),
        r"has the source file more\.cpp, which is C\+\+, and a program is made of C" + ADVICE,
    ),
    "another language": (
        made(description={"files": ("small.c", "more.f90")}, edit={"more.f90": ""}),
        r"has the source file 'more\.f90', which is not a file of C" + ADVICE,
    ),
    "a file name with a quotation mark": (
        made(description={"files": ("small.c", "a&quot;b.c")}, edit={'a"b.c': ""}),
        r"has the source file 'a\"b\.c', whose name a program cannot include" + ADVICE,
    ),
    "resources": (
        with_entry("resources/table.csv"),
        r"has files that it may read while it runs \(resources/table\.csv\), and a program has no files" + ADVICE,
    ),
    "a tool": (
        changed('canGetAndSetFMUstate="true"', 'needsExecutionTool="true"'),
        r"declares needsExecutionTool, and a program has no tool beside it" + ADVICE,
    ),
    "an error": (
        made(edit={"gain.h": "#define GAIN nothing\n"}),
        r"do not compile by themselves: \S*parts/helper\.c:5:.* error: .*'nothing'.*\.$",
    ),
    "a header in a folder that C does not search": (
        made(edit={"parts/helper.c": '#include "gain.h"\n'}),
        r"do not compile by themselves: .* error: 'gain\.h' file not found\.$",
    ),
    "a file of this machine": (
        made(edit={"gain.h": '#include "/etc/hostname.h"\n#include "/etc/passwd"\n'}),
        r"do not compile by themselves: .* error: '/etc/hostname\.h' file not found\.$",
    ),
    "an empty file of this machine": (
        made(edit={"gain.h": '#include "/dev/null"\n#define GAIN 1\n'}),
        r"include /dev/null, a file outside of the FMU and of the C library\.$",
    ),
    "a name that no macro reaches": (
        made(edit={"parts/helper.c": 'int hidden __asm__("bare") = 1;\ndouble helper(double u) { return u; }\n'}),
        r"define bare in parts/helper\.c by means that a macro does not reach, so other components could clash with"
        r" that; such names need the prefix Odd_\.$",
    ),
    "a name that is C text": (
        made(edit={"parts/helper.c": 'int f(void) __asm__("a\\n#error b");\nint f(void) { return 1; }\n'}),
        r"define a\\n#error b in parts/helper\.c by means that a macro does not reach",
    ),
    "a missing function": (
        made(edit={"small.c": SMALL_C.replace("NAMED(fmi2Terminate)", "ended")}),
        r"do not define fmi2Terminate; a program calls them, so export the FMU with complete sources\.$",
    ),
    "functions for states missing": (
        made(edit={"small.c": SMALL_C.replace("NAMED(fmi2SetFMUstate)", "put")}),
        r"do not define fmi2SetFMUstate; a program calls them, so export the FMU with complete sources\.$",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_what_cannot_be_contained_is_refused(case: str, tmp_path: Path) -> None:
    make, why = CASES[case]
    system = replace(System.of({"odd": make(tmp_path)}), step=0.01)
    with pytest.raises(ContainerError, match=rf"^odd: (the sources of )?Odd\.fmu {why}"):
        plan_of(system)


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ("CoSimulation", "ModelExchange", r"an FMI 2\.0 FMU for model exchange"),
        ('fmiVersion="2.0"', 'fmiVersion="3.0"', r"an FMI 3\.0 FMU for co-simulation"),
        ('fmiVersion="2.0"', 'fmiVersion="1.0"', r"an FMI 1\.0 FMU for co-simulation"),
    ],
)
def test_other_kinds_of_fmus_are_no_components(old: str, new: str, found: str, tmp_path: Path) -> None:
    path = changed(old, new)(tmp_path)
    message = rf"Odd\.fmu is {found}; one of FMI 2\.0 for co-simulation is needed\.$"
    with pytest.raises(ArchiveError, match=message):
        System.of({"odd": path})


def test_a_start_value_of_a_string_is_refused(tmp_path: Path) -> None:
    head = 'valueReference="0" causality="parameter" variability="fixed"'
    text = f'<ScalarVariable name="text" {head}><String start="abcd"/></ScalarVariable>'
    path = made(description={"more": text})(tmp_path)
    system = replace(System.of({"odd": path}), step=0.01)
    plan_of(system)
    message = (
        r"^odd: the system gives the String text a start value, and a program has no Strings; leave it at the start"
        r" value of Odd\.fmu, or run the system without making a program of it\.$"
    )
    with pytest.raises(ContainerError, match=message):
        plan_of(system.set({"odd.text": "other"}))


def test_a_connection_of_strings_is_refused(tmp_path: Path) -> None:
    head = 'variability="discrete" valueReference'
    texts = f'<ScalarVariable name="heard" causality="input" {head}="0"><String start="a"/></ScalarVariable>'
    texts += f'<ScalarVariable name="said" causality="output" {head}="1"><String/></ScalarVariable>'
    path = made(description={"more": texts})(tmp_path)
    system = replace(System.of({"a": path, "b": path}).connect("a.said -> b.heard"), step=0.01)
    message = r"^Connection a\.said -> b\.heard: a program has no Strings; remove the connection"
    with pytest.raises(ContainerError, match=message):
        plan_of(system)


def test_an_algebraic_loop_is_named(tmp_path: Path) -> None:
    path = changed('dependencies="10"', 'dependencies="1"')(tmp_path)
    system = replace(System.of({"a": path, "b": path}).connect("a.y -> b.u", "b.y -> a.u"), step=0.01)
    with pytest.raises(ContainerError, match=re.escape("a.y -> b.u")) as refused:
        plan_of(system)
    assert "b.y -> a.u" in str(refused.value)
