"""What the wheel holds: FMUs that are whole, for five platforms, and no trace of where it was built."""

import hashlib
import io
import json
import tarfile
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from adaptimp_fmu import PLATFORMS, build
from fmus import carried
from fmus.carried import definitions_hash
from fmus.catalog import MODELS, VARIANTS
from orchestration.errors import OrchestrationError
from orchestration.paper.page.live_data import programs
from orchestration.paper.scenarios import ALL_SCENARIOS, SCENARIOS
from orchestration.paper.scenarios import VARIANTS as COMPARED

ROOT = Path(__file__).parents[2]
Contents = dict[str, bytes]


@pytest.fixture(scope="module")
def contents(wheel: Path) -> Contents:
    """All files of the wheel by name."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_it_holds_the_packages_and_no_tests(contents: Contents) -> None:
    tops = {name.partition("/")[0] for name in contents}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"adaptimp_fmu", "fmus", "orchestration"}
    assert not [name for name in contents if "test_" in name or name.endswith(".pyc")]
    assert {"adaptimp_fmu/runtime/step.c", "orchestration/py.typed"} <= set(contents)


def test_every_carried_fmu_has_binaries_for_all_platforms(contents: Contents) -> None:
    names = sorted(name.partition("fmus/carried/")[2] for name in contents if name.endswith(".fmu"))
    needed = {identifier for scenario in ALL_SCENARIOS.values() for identifier in scenario.models.values()}
    assert names == sorted(f"{identifier}.fmu" for identifier in {*MODELS, *needed})
    for identifier in (name.removesuffix(".fmu") for name in names):
        with zipfile.ZipFile(io.BytesIO(contents[f"fmus/carried/{identifier}.fmu"])) as fmu:
            assert fmu.testzip() is None
            binaries = {name for name in fmu.namelist() if name.startswith("binaries/")}
            expected = {f"binaries/{p.name}/{identifier}{p.extension}" for p in PLATFORMS.values()}
            assert binaries == expected


@pytest.mark.parametrize("identifier", ["ForceSensor", "SlotineLiAdaptiveImpedanceNoCoriolis"])
def test_an_fmu_is_the_one_that_the_checkout_builds(contents: Contents, identifier: str, tmp_path: Path) -> None:
    built = build((MODELS | VARIANTS)[identifier](), tmp_path, PLATFORMS.values())
    assert built.read_bytes() == contents[f"fmus/carried/{identifier}.fmu"]


def test_the_manifest_has_the_hash_of_each_file(contents: Contents) -> None:
    known = json.loads(contents["fmus/carried/manifest.json"])
    prefix = "fmus/carried/"
    files = {name.removeprefix(prefix): text for name, text in contents.items() if name.startswith(prefix)}
    files.pop("manifest.json")
    assert known["files"] == {name: hashlib.sha256(text).hexdigest() for name, text in files.items()}
    assert known["definitions"] == definitions_hash()
    assert set(known["fmus"]) == set(MODELS | VARIANTS)


@pytest.fixture
def without_a_compiler(contents: Contents, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder that the wheel carries, in the place of the compiler and the cache."""

    def refused(*arguments: object) -> None:
        raise AssertionError(arguments)

    folder = tmp_path / "carried"
    folder.mkdir()
    for name, text in contents.items():
        if name.startswith("fmus/carried/"):
            (folder / Path(name).name).write_bytes(text)
    monkeypatch.setattr(carried, "FOLDER", folder)
    monkeypatch.setattr("adaptimp_fmu.binary.compile_library", refused)
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    carried.manifest.cache_clear()
    yield folder
    carried.manifest.cache_clear()


def test_the_carried_modules_are_those_that_the_checkout_compiles(contents: Contents) -> None:
    modules = {name: text for name, text in contents.items() if name.endswith(".wasm")}
    made = {program.record["description"]["identity"]: program.module for program in programs().values()}
    assert modules == {f"fmus/carried/{identity}.wasm": module for identity, module in made.items()}


def test_the_live_page_needs_no_compiler(without_a_compiler: Path) -> None:
    assert len(programs()) == len(list(without_a_compiler.glob("*.wasm")))
    module = sorted(without_a_compiler.glob("*.wasm"))[0]
    module.write_bytes(module.read_bytes() + b"\0")
    with pytest.raises(OrchestrationError, match=f"{module.name} is not the file that the wheel of adaptimp brought"):
        programs()


def test_the_archive_holds_the_scenarios(contents: Contents) -> None:
    with tarfile.open(fileobj=io.BytesIO(contents["fmus/carried/scenarios.tar.xz"])) as archive:
        assert set(archive.getnames()) == {f"{name}.ssp" for name in SCENARIOS | COMPARED}


def test_the_sdist_gives_the_same_wheel(wheel: Path, wheel_of_sdist: Path) -> None:
    assert wheel_of_sdist.read_bytes() == wheel.read_bytes()


def test_nothing_says_where_it_was_built(contents: Contents) -> None:
    places = [str(ROOT).encode(), str(Path.home()).encode() + b"/", f"{tempfile.gettempdir()}/adaptimp-".encode()]
    for name, text in contents.items():
        texts = [text]
        if name.endswith(".fmu"):
            with zipfile.ZipFile(io.BytesIO(text)) as fmu:
                texts = [fmu.read(entry) for entry in fmu.namelist()]
        assert not [place for place in places for part in texts if place in part], name
