"""What is kept in the folder of caches: it is counted, and removed without what is not the cache's or is in use."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from adaptimp_fmu import SampledModel, build
from adaptimp_fmu.files import cache_use
from adaptimp_fmu.files.cache_contents import KINDS, Amount, amount, clear, places
from adaptimp_fmu.files.cache_folder import TAG, TAG_TEXT, tagged_cache

ROOT = Path(__file__).parents[4]
HASH, OTHER = "0123456789abcdef0123456789abcdef", "f" * 32
USES = """
import sys
from pathlib import Path
from adaptimp_fmu.files.cache_use import use
use(Path(sys.argv[1]), *sys.argv[2:])
print("ready", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of caches, with an entry of two files of 5 bytes of each kind of folders."""
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    for name, kind in KINDS.items():
        if kind.entries == r"[0-9a-f]{32}":
            entry = tmp_path / "cache" / name / HASH / "linux64"
            entry.mkdir(parents=True)
            (entry / "Plant.so").write_bytes(b"12345")
            (entry.parent / "Plant.fmu").write_bytes(b"12345")
    return tmp_path / "cache"


@contextmanager
def working_with(cache: Path, *parts: str) -> Iterator[None]:
    """Another process that works with a folder of a cache."""
    command = [sys.executable, "-c", USES, str(cache), *parts]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        yield
        process.communicate("")


def test_entries_are_counted_and_removed(cache: Path) -> None:
    for kind in (KINDS["fmus"], KINDS["kernel"], KINDS["ssp"], KINDS["native"], KINDS["binaries"]):
        assert amount(cache, kind) == Amount(files=2, size=10)
        assert clear(cache, kind) == Amount(files=2, size=10)
        assert amount(cache, kind) == clear(cache, kind) == Amount()
        assert list((cache / kind.name).iterdir()) == []


def test_nothing_else_is_touched(cache: Path, tmp_path: Path) -> None:
    """The cache is a folder in which a user has files of the same names as ours."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("mine")
    for name in KINDS:
        (cache / name / "thesis").mkdir(parents=True)
        (cache / name / "thesis" / "chapter.txt").write_text("mine")
        (cache / name / "letter.txt").write_text("mine")
        (cache / name / f"{HASH}.txt").write_text("mine")
        (cache / name / OTHER).symlink_to(tmp_path / "mine")
    (cache / "claims" / HASH).mkdir()
    (cache / "robustness" / "store.json").write_text('{"results": 1}')
    (cache / "zig" / TAG).write_text("Signature: 8a477f597d28d172789f06886806bc55\n# This folder was made by zig.\n")
    (cache / HASH).mkdir()
    ours = [path for path in cache.rglob("*") if HASH in path.parts and path.parent.name != "cache"]
    expected = {path for path in cache.rglob("*") if "claims" in path.parts or path not in ours}
    for kind in KINDS.values():
        clear(cache, kind)
    left = {path for path in cache.rglob("*") if cache_use.FOLDER not in path.relative_to(cache).parts}
    assert left == expected
    assert (tmp_path / "mine" / "letter.txt").read_text() == "mine"


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="only POSIX has owners")
def test_what_another_user_wrote_stays(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("adaptimp_fmu.files.cache_contents.os.getuid", lambda: os.stat(cache).st_uid + 1)
    assert clear(cache, KINDS["fmus"]) == Amount()
    assert (cache / "fmus" / HASH).is_dir()


def test_folders_of_other_programs_are_removed_if_they_were_made_here(cache: Path) -> None:
    folder = tagged_cache("zig")
    (folder / "o").mkdir()
    (folder / "o" / "object").write_bytes(b"123")
    assert tagged_cache("zig") == folder
    assert amount(cache, KINDS["zig"]) == Amount(files=2, size=3 + len(TAG_TEXT))
    assert clear(cache, KINDS["zig"]).files == 2
    assert not folder.exists()
    (cache / "matplotlib").mkdir()
    (cache / "matplotlib" / "matplotlibrc").write_text("mine")
    assert not (tagged_cache("matplotlib") / TAG).exists()
    assert clear(cache, KINDS["matplotlib"]) == Amount()


def test_what_a_living_process_works_with_stays(cache: Path) -> None:
    (cache / "fmus" / OTHER).mkdir()
    (cache / "fmus" / OTHER / "Gain.fmu").write_bytes(b"123")
    with working_with(cache, "fmus", HASH):
        assert clear(cache, KINDS["fmus"]) == Amount(files=1, size=3, used=1)
        assert [path.name for path in (cache / "fmus").iterdir()] == [HASH]
        assert len(list((cache / cache_use.FOLDER).glob("*.list"))) == 1
    assert clear(cache, KINDS["fmus"]) == Amount(files=2, size=10)
    assert list((cache / cache_use.FOLDER).glob("*.list")) == []


def test_an_fmu_in_the_cache_stays_as_long_as_the_process_that_asked_for_it(cache: Path, tmp_path: Path) -> None:
    model = SampledModel("Gain", "Multiplies")
    model.output("y", 2 * model.input("u", 1.0, description="In"), description="Out")
    path = build(model)
    assert path.is_relative_to(cache / "fmus")
    assert clear(cache, KINDS["fmus"]) == Amount(files=2, size=10, used=1)
    assert clear(cache, KINDS["binaries"]).files == 3
    assert path.is_file()
    elsewhere = build(model, cache=tmp_path / "own")
    assert clear(tmp_path / "own", KINDS["fmus"]) == Amount(used=1)
    assert elsewhere.is_file()


def test_the_temporary_cache_is_found(cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert places() == [cache]
    user = os.getuid() if hasattr(os, "getuid") else "cache"
    (tmp_path / f"adaptimp-{user}").mkdir(mode=0o700)
    assert places() == [cache, tmp_path / f"adaptimp-{user}"]
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "missing"))
    assert places() == [tmp_path / f"adaptimp-{user}"]


def test_every_folder_of_the_cache_is_a_kind() -> None:
    """Names in the calls that make folders there, and the folders of those calls that name none."""
    found = {"ssp", "native", "robustness"}  # named by constants, or added to the folder
    for package in ("adaptimp_fmu", "orchestration", "fmus"):
        for path in (ROOT / package).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            found |= set(re.findall(r'(?:writable_cache|tagged_cache)\("(\w+)"', text))
            found |= set(re.findall(r'cached\(cache, \("(\w+)"', text))
    assert found == set(KINDS)
