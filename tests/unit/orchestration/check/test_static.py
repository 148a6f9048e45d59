"""Tests of rules 1 to 8: the project's FMUs break none, and each broken rule is reported by its number."""

import io
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from adaptimp_fmu.toolchain import host_platform
from fmus.catalog import MODELS
from orchestration import ArchiveError, SystemDescriptionError
from orchestration.check import Report, Severity
from orchestration.check.static import elf
from tests.unit.orchestration.checked import DESCRIPTION, Edit, assert_found, check, edited, repacked, swap

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE
LIBRARY = f"binaries/{host_platform().name}/HoganImpedance{host_platform().extension}"
UNKNOWN = r'<Unknown index="(\d+)" dependencies="[^"]*"/>'
Checked = Callable[[Edit], Report]


@pytest.fixture
def hogan(fmu_folder: Path) -> Path:
    """The controller without adaptation."""
    return fmu_folder / "HoganImpedance.fmu"


@pytest.mark.parametrize("unit", list(MODELS))
def test_ours_have_no_findings(fmu_folder: Path, unit: str) -> None:
    report = check(fmu_folder / f"{unit}.fmu")
    assert report.findings == ()
    assert report.role is not None
    assert not report.failed


def section(name: str, edit: Edit) -> Edit:
    """An edit within one element of the description."""

    def change(xml: str) -> str:
        start, end = xml.index(f"<{name}>"), xml.index(f"</{name}>")
        return xml[:start] + edit(xml[start:end]) + xml[end:]

    return change


BROKEN: dict[str, tuple[Edit, str, Severity, str]] = {
    "version": (swap('fmiVersion="2.0"', 'fmiVersion="3.0"'), "1", ERROR, "fmiVersion 3.0; .* 2.0 are needed"),
    "not well-formed": (lambda xml: xml[:-9], "1", ERROR, "is not well-formed XML"),
    "schema": (swap('start="2"', 'start="two"'), "1", ERROR, "violates the schema in line [0-9]+: .*two"),
    "model exchange": (
        swap(r"<CoSimulation.*?</CoSimulation>", '<ModelExchange modelIdentifier="HoganImpedance"/>'),
        *("1", ERROR, "no CoSimulation element"),
    ),
    "combination": (
        swap('causality="parameter" variability="fixed"', 'causality="parameter" variability="discrete"'),
        *("2", ERROR, "sample_time: causality parameter and variability discrete exclude each other"),
    ),
    "initial of a parameter": (
        swap('variability="fixed" initial="exact"', 'variability="fixed" initial="approx"'),
        *("2", ERROR, "sample_time: initial approx is illegal for a fixed parameter; exact is"),
    ),
    "continuous Integer": (
        swap(r'causality="input" variability="continuous">\s*<Real[^>]*/>', 'causality="input"><Integer start="1"/>'),
        *("2", ERROR, r"q\[1\] has, by default, variability continuous, which only a Real can have"),
    ),
    "initial of an input": (
        swap('causality="input"', 'causality="input" initial="exact"'),
        *("3", WARNING, r"q\[1\] has initial exact, but is an input"),
    ),
    "two times": (
        swap(
            r'(<ScalarVariable name=)"gravity"',
            r"""<ScalarVariable name="t" valueReference="9001" causality="independent"><Real/></ScalarVariable>
            <ScalarVariable name="n" valueReference="9002" causality="independent"><Integer/></ScalarVariable>
            \1"gravity\"""",
        ),
        *("2", ERROR, "t, n are independent variables; there is one time only"),
    ),
    "a time that is counted": (
        swap(
            r'(<ScalarVariable name=)"gravity"',
            r"""<ScalarVariable name="n" valueReference="9002" causality="independent"><Integer/></ScalarVariable>
            \1"gravity\"""",
        ),
        *("2", ERROR, "n is an independent variable of type Integer; time is a Real"),
    ),
    "two starts of an alias": (
        swap(r'(name="M\[2\]" valueReference)="\d+"', r'\1="1"'),
        *("3", ERROR, r"are one variable \(valueReference 1\) with several start values: .*M\[2\] = 2"),
    ),
    "two units of an alias": (
        swap(r'(name="gravity" valueReference)="\d+"', r'\1="1"'),
        *("5", ERROR, r"gravity are one variable \(valueReference 1\), but have several units: .*m/s2"),
    ),
    "reinit": (
        swap('start="-0.7227342478"', 'start="-0.7227342478" reinit="true"'),
        *("3", WARNING, r"q\[1\] have the attribute reinit, which is for model exchange only"),
    ),
    "no start": (
        swap('start="-0.7227342478"', ""),
        *("3", ERROR, r"q\[1\] is an input, but no start value"),
    ),
    "start of a calculated": (
        swap(r'(initial="calculated">\s*<Real)', r'\1 start="1"'),
        *("3", ERROR, r"tau_cmd\[1\] has initial calculated, but a start value"),
    ),
    "output not listed": (
        section("Outputs", swap(UNKNOWN, "")),
        *("4", WARNING, r"Outputs lacks tau_cmd\[1\]"),
    ),
    "unknown not listed": (
        section("InitialUnknowns", swap(UNKNOWN, "")),
        *("4", WARNING, r"InitialUnknowns lacks tau_cmd\[1\]"),
    ),
    "more than outputs": (
        section("Outputs", swap(UNKNOWN, '<Unknown index="1" dependencies=""/>')),
        *("4", WARNING, "Outputs lists sample_time, which do not belong there"),
    ),
    "descending": (
        section("InitialUnknowns", swap(rf"({UNKNOWN})\s*({UNKNOWN})", r"\3 \1")),
        *("4", WARNING, "InitialUnknowns is not in ascending order"),
    ),
    "dependencies descending": (
        section("InitialUnknowns", swap(r'dependencies="(\d+) (\d+)', r'dependencies="\2 \1')),
        *("4", WARNING, "dependencies of .* are not in ascending order"),
    ),
    "no such index": (
        section("Outputs", swap(r'index="\d+"', 'index="4000"')),
        *("4", ERROR, "Outputs: the index 4000 is not that of a variable"),
    ),
    "kinds": (
        section("Outputs", swap(r'dependencies="[^"]*"', 'dependencies="18" dependenciesKind="fixed fixed"')),
        *("4", ERROR, r"tau_cmd\[1\] has 2 dependenciesKind for 1 dependencies"),
    ),
    "silent about dependencies": (
        section("Outputs", swap(r'dependencies="[^"]*"', "")),
        *("4", WARNING, r"Outputs: tau_cmd\[1\] without dependencies"),
    ),
    "name twice": (swap(r'name="M\[2\]"', 'name="M[1]"'), "5", ERROR, r"The name M\[1\] is used more than once"),
    "name": (swap(r'name="gravity"', 'name="2 g"'), "5", WARNING, "The name 2 g breaks the grammar"),
    "unit": (swap('<Unit name="N.m">', '<Unit name="Nm">'), "5", ERROR, "unit N.m is not declared in UnitDefinitions"),
    "base unit": (
        swap(r'<Unit name="kg">.*?</Unit>', '<Unit name="kg"/>'),
        *("5", WARNING, "unit kg has no BaseUnit"),
    ),
    "type": (swap('SimpleType name="Force"', 'SimpleType name="Power"'), "5", ERROR, "the type Force is not declared"),
    "start below min": (swap('min="1e-12" start="2"', 'min="3" start="2"'), "5", WARNING, r"start 2 is outside of \[3"),
    "min above max": (swap('min="1e-12" start="2"', 'min="3" max="1" start="2"'), "5", WARNING, "min 3 exceeds max 1"),
    "stop": (swap('stopTime="2"', 'stopTime="-2"'), "5", ERROR, "stopTime -2.0 must be later than startTime 0.0"),
    "step": (swap('stepSize="0.0001"', 'stepSize="-1"'), "5", ERROR, "stepSize -1 must be positive"),
    "serialization": (
        swap('canGetAndSetFMUstate="true"', ""),
        *("6", ERROR, "canSerializeFMUstate is true, but canGetAndSetFMUstate false"),
    ),
    "identifier": (
        swap('modelIdentifier="HoganImpedance"', 'modelIdentifier="../HoganImpedance"'),
        *("6", ERROR, "modelIdentifier '../HoganImpedance' is not a C identifier"),
    ),
    "other identifier": (
        swap('modelIdentifier="HoganImpedance"', 'modelIdentifier="Other"'),
        *("6", ERROR, r"HoganImpedance\.\w+ is not named after the modelIdentifier Other"),
    ),
    "category twice": (
        swap('Category name="logStatusWarning"', 'Category name="logStatusError"'),
        *("6", WARNING, "log category logStatusError is declared more than once"),
    ),
    "source": (
        swap('<File name="model.c"/>', '<File name="x.c"/>'),
        "7",
        WARNING,
        "source file x.c is declared, but not",
    ),
    "GUID": (swap(r'guid="\{\w', 'guid="{x'), "9", ERROR, "refuses the GUID of the description"),
}


@pytest.mark.parametrize("fault", list(BROKEN))
def test_a_broken_description(hogan: Path, tmp_path: Path, fault: str) -> None:
    edit, rule, severity, message = BROKEN[fault]
    assert_found(check(edited(hogan, tmp_path, edit)), rule, severity, message)


def test_an_unsafe_archive(hogan: Path, tmp_path: Path) -> None:
    report = check(repacked(hogan, tmp_path, {"../evil.so": b""}))
    assert_found(report, "7", ERROR, r"HoganImpedance.fmu: entry '../evil.so' leads outside the archive")
    assert report.facts == ("Nothing further could be examined.",)


def test_a_missing_description(hogan: Path, tmp_path: Path) -> None:
    assert_found(check(repacked(hogan, tmp_path, {DESCRIPTION: None})), "1", ERROR, "has no modelDescription.xml")


def test_a_missing_include(hogan: Path, tmp_path: Path) -> None:
    report = check(repacked(hogan, tmp_path, {"sources/philox.h": None}))
    assert_found(report, "7", WARNING, "includes philox.h, which is not in the archive")


def test_no_binary_for_this_machine(hogan: Path, tmp_path: Path) -> None:
    report = check(repacked(hogan, tmp_path, {LIBRARY: None, "binaries/mips/HoganImpedance.so": b""}))
    assert_found(report, "6", ERROR, "no binary for .*, this machine; there are: mips; fmpy compile builds one")
    assert report.facts == ("The binary was not run.",)


def test_a_binary_of_another_name_elsewhere(hogan: Path, tmp_path: Path) -> None:
    report = check(repacked(hogan, tmp_path, {"binaries/mips/X.so": b""}))
    assert_found(report, "6", WARNING, "binaries/mips has no file named after the model, HoganImpedance")
    assert not report.failed


@pytest.mark.skipif(host_platform().extension != ".so", reason="reads ELF files")
@pytest.mark.parametrize("content", [b"", b"no library", b"\x7fELF\x02\x01" + bytes(200)])
def test_a_binary_that_is_no_library(hogan: Path, tmp_path: Path, content: bytes) -> None:
    report = check(repacked(hogan, tmp_path, {LIBRARY: content}))
    assert_found(report, "8", ERROR, r"HoganImpedance.so is not a shared library: ")
    assert_found(report, "8", ERROR, r"Loading: the library '.*HoganImpedance.so' is not a 64-bit ELF library")


def test_a_binary_for_another_processor(hogan: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(hogan) as archive:
        content = archive.read(LIBRARY)
    report = check(repacked(hogan, tmp_path, {"binaries/aarch64-linux/HoganImpedance.so": content}))
    assert_found(report, "8", ERROR, "aarch64-linux/HoganImpedance.so is for x86_64, not aarch64")


def test_libraries_of_others_are_read() -> None:
    """One with a GNU hash table alone, as systems have them: that of a Python extension."""
    import numpy.linalg._umath_linalg as extension

    library = elf.read(Path(extension.__file__).read_bytes())
    assert "PyInit__umath_linalg" in library.exported
    assert any(name.startswith("libc.so") for name in library.needed)


def test_many_alike_findings_are_counted(hogan: Path, tmp_path: Path) -> None:
    report = check(
        edited(hogan, tmp_path, lambda xml: xml.replace('causality="input"', 'causality="input" initial="exact"'))
    )
    assert report.count(WARNING) == 9
    assert_found(report, "3", WARNING, "There are 6 more findings like these")


def test_what_cannot_be_examined(tmp_path: Path, hogan: Path) -> None:
    with pytest.raises(ArchiveError, match="no such file"):
        check(tmp_path / "missing.fmu")
    with pytest.raises(ArchiveError, match="is a folder; give the path of a file"):
        check(tmp_path)
    with pytest.raises(SystemDescriptionError, match="no role pilot; there are controller, "):
        check(hogan, "pilot")


def test_two_descriptions(hogan: Path, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        content = io.BytesIO(hogan.read_bytes())
        with zipfile.ZipFile(content, "a") as archive:
            archive.writestr(DESCRIPTION, "<x/>")
    path = tmp_path / "two.fmu"
    path.write_bytes(content.getvalue())
    assert_found(check(path), "7", ERROR, "occurs more than once")
