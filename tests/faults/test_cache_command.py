"""Evidence that ``adaptimp cache`` lists what is kept, and that ``adaptimp cache clear`` disturbs nobody."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.faults.cli import Command

MODEL = """from adaptimp_fmu import SampledModel
model = SampledModel("Gain", "Multiplies")
model.output("y", 2 * model.input("u", 1.0, description="In"), description="Out")
"""
HASH = "0123456789abcdef0123456789abcdef"
WORKS = """
import sys
from orchestration import System, simulate
system = System.read("gain.ssp")
print("ready", flush=True)
sys.stdin.readline()
print(simulate(system, 0.01, step=1e-4).status, flush=True)
"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of caches of this test alone, the working directory beside it, and no temporary cache."""
    (tmp_path / "temporary").mkdir()
    (tmp_path / "Gain.py").write_text(MODEL, encoding="utf-8")
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    monkeypatch.chdir(tmp_path)
    return tmp_path / "cache"


def test_what_is_kept_is_listed_and_removed_and_made_again(adaptimp: Command, cache: Path) -> None:
    assert adaptimp("cache").out == f"{cache}: nothing is kept.\n"
    assert adaptimp("build", "Gain.py", "-o", ".").code == 0
    assert adaptimp("export", "Gain.fmu", "-o", "gain.ssp").code == 0
    assert adaptimp("info", "gain.ssp").code == 0
    size = sum(path.stat().st_size for path in (cache / "binaries").rglob("*.*"))
    listed = adaptimp("cache")
    assert (listed.code, listed.err) == (0, "")
    assert listed.out.startswith(f"{cache}\nkind ")
    assert re.search(rf"^binaries +1 +{size / 1000:.3g} kB  compiled libraries", listed.out, re.MULTILINE)
    assert re.search(r"^ssp +\d+ ", listed.out, re.MULTILINE)
    assert not re.search(r"^claims ", listed.out, re.MULTILINE)
    found = json.loads(adaptimp("cache", "--json").out)
    assert found[str(cache)]["binaries"] == {"files": 1, "size": size, "used": 0}

    removed = adaptimp("cache", "clear", "binaries")
    assert (removed.code, removed.err) == (0, "")
    said = f"1 file, {size / 1000:.3g} kB"
    assert removed.out == f"{cache / 'binaries'}: {said} removed\nfreed: {said}\n"
    assert adaptimp("cache", "clear", "binaries").out == "freed: 0 files, 0 B\n"
    assert adaptimp("build", "Gain.py", "-o", ".").code == 0
    assert len(list((cache / "binaries").rglob("Gain.*"))) == 1


def test_what_took_long_to_make_is_removed_by_name_only(adaptimp: Command, cache: Path) -> None:
    (cache / "claims").mkdir(parents=True)
    (cache / "claims" / f"{HASH}.json").write_text("[]")
    (cache / "robustness").mkdir()
    (cache / "robustness" / "store.json").write_text('{"adaptimp": "store of runs", "format": 1}')
    outcome = adaptimp("cache", "clear")
    assert outcome.code == 0
    assert outcome.out.endswith("freed: 1 file, 2 B\n")
    assert outcome.err == "Notice: robustness took long to make, and is kept; adaptimp cache clear robustness.\n"
    assert list((cache / "claims").iterdir()) == []
    assert adaptimp("cache", "clear", "claims").err == ""
    assert adaptimp("cache", "clear", "robustness", "claims").out.endswith("freed: 1 file, 42 B\n")
    assert not (cache / "robustness").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("empty",), "There is no action empty; give 'adaptimp cache' to list, or 'adaptimp cache clear' to remove."),
        (("clear", "fmu"), "The cache holds no fmu; did you mean fmus?"),
    ],
)
def test_what_there_is_not_is_refused(
    adaptimp: Command, cache: Path, arguments: tuple[str, ...], sentence: str
) -> None:
    outcome = adaptimp("cache", *arguments)
    assert (outcome.code, outcome.sentence) == (2, sentence)
    assert not cache.exists()


def test_another_process_goes_on(adaptimp: Command, cache: Path) -> None:
    """It has read a package, whose FMU lies in the cache, and runs it after the cache was cleared."""
    assert adaptimp("build", "Gain.py", "-o", ".").code == 0
    assert adaptimp("export", "Gain.fmu", "-o", "gain.ssp").code == 0
    (cache / "ssp" / HASH).mkdir(parents=True)
    with subprocess.Popen(
        [sys.executable, "-c", WORKS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        outcome = adaptimp("cache", "clear")
        assert outcome.code == 0
        assert outcome.err == f"Notice: {cache / 'ssp'}: 1 in use by another process, and kept.\n"
        assert process.communicate("\n")[0] == "complete\n"
    assert not (cache / "ssp" / HASH).exists()
    assert adaptimp("cache", "clear").err == ""
    assert list((cache / "ssp").iterdir()) == []
