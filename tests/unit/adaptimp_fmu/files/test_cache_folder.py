"""The folder of caches, and the temporary one in its place where nothing can be written."""

import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from adaptimp_fmu import default_cache
from adaptimp_fmu.files import cache_folder as module

MODEL = """from adaptimp_fmu import SampledModel
model = SampledModel("Gain", "Multiplies")
model.output("y", 2 * model.input("u", 1.0, description="In"), description="Out")
"""


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for temporary files, and a file in the place of the cache."""
    (tmp_path / "taken").write_text("a file", encoding="utf-8")
    (tmp_path / "temporary").mkdir()
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "taken"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    return tmp_path / "temporary"


def test_a_cache_that_can_be_written_to_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    assert module.writable_cache("a", "b") == tmp_path / "cache" / "a" / "b"
    assert (tmp_path / "cache" / "a" / "b").is_dir()


def test_a_temporary_cache_is_said_once(temporary: Path) -> None:
    sentence = (
        r"^Nothing can be written to the cache \S+taken: .+\. This process uses \S+; set ADAPTIMP_CACHE to a folder"
    )
    with pytest.warns(module.TemporaryCacheWarning, match=sentence):
        folder = module.writable_cache("ssp")
    assert folder.is_relative_to(temporary)
    assert folder.is_dir()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert module.writable_cache("ssp") == folder
    assert default_cache() == module.cache_folder() == folder.parent


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="only POSIX has owners and modes of folders")
def test_a_temporary_folder_that_others_can_write_to_is_not_used(temporary: Path) -> None:
    """Machine code is run from the cache, so nobody else may put files there."""
    known = temporary / f"adaptimp-{os.getuid()}"
    known.mkdir()
    known.chmod(0o777)
    with pytest.warns(module.TemporaryCacheWarning):
        folder = module.writable_cache("kernel")
    assert not folder.is_relative_to(known)
    assert folder.is_relative_to(temporary)
    assert folder.parent.stat().st_mode & 0o022 == 0


def test_where_nothing_can_be_written_at_all_it_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "taken").write_text("a file", encoding="utf-8")
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "taken"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "taken"))
    with pytest.raises(OSError, match="taken"):
        module.writable_cache("ssp")


def test_matplotlib_gets_a_folder_where_there_is_no_home(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("XDG_CONFIG_HOME", "XDG_CACHE_HOME"):
        monkeypatch.setenv(variable, str(temporary.parent / "taken"))
    monkeypatch.setenv("MPLCONFIGDIR", "any")  # so that the test's end removes what is set below
    monkeypatch.delenv("MPLCONFIGDIR")
    monkeypatch.delitem(sys.modules, "matplotlib", raising=False)
    with pytest.warns(module.TemporaryCacheWarning):
        module.let_matplotlib_write()
    assert Path(os.environ["MPLCONFIGDIR"]).is_relative_to(temporary)


def test_a_model_is_built_without_a_home(tmp_path: Path) -> None:
    """By a real process, and by the compiler in a process of its own."""
    for name, text in (("taken", "a file"), ("mine.py", MODEL)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "temporary").mkdir()
    home = str(tmp_path / "taken")
    removed = ("ADAPTIMP_CACHE", "XDG_CACHE_HOME", "ZIG_GLOBAL_CACHE_DIR")
    environment = {name: value for name, value in os.environ.items() if name not in removed}
    environment |= {"HOME": home, "TMPDIR": str(tmp_path / "temporary")}
    command = [sys.executable, "-c", "from orchestration.cli import main; main()", "build", "mine.py", "--out", "built"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = [line for line in done.stderr.splitlines() if not line.endswith(" ...")]  # what takes long is said, too
    assert len(said) == 1
    assert re.fullmatch(r"Warning: Nothing can be written to the cache \S+: .*", said[0])
    assert (tmp_path / "built" / "Gain.fmu").is_file()
