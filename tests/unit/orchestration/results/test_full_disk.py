"""Tests that a full disk is reported, and that existing files stay as they are."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from orchestration import OrchestrationError
from orchestration.results.parquet_file import ParquetSink
from tests.unit.orchestration.stored import NAMES, files, sample, stream

WHOLE = 5000  # bytes that can be written until the disk counts as full


@contextmanager
def full_disk() -> Iterator[None]:
    """Limit the length of files to `WHOLE` bytes, so that writing fails as on a full disk.

    The limit also holds for the output file of the test run, so it must end with the context. Python does not notice
    that the bytecode of a module is cut off by the limit, so none is written.
    """
    resource = pytest.importorskip("resource", reason="Windows has no limit on the size of files")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    written, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    resource.setrlimit(resource.RLIMIT_FSIZE, (WHOLE, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        sys.dont_write_bytecode = written


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_full_disk_leaves_nothing_but_the_old_file(tmp_path: Path, suffix: str) -> None:
    (tmp_path / f"x{suffix}").write_text("old")
    message = rf"x{suffix}: the result cannot be written: File too large; choose another place\.$"
    with full_disk(), pytest.raises(OrchestrationError, match=message):
        sample(5000).write(tmp_path / f"x{suffix}")
    gc.collect()  # a writer that is still open would try to write again, and warn
    assert files(tmp_path) == [f"x{suffix}"]
    assert (tmp_path / f"x{suffix}").read_text() == "old"


@pytest.mark.usefixtures("small_groups")
def test_a_disk_that_fills_up_ends_the_stream(tmp_path: Path) -> None:
    sink = ParquetSink(tmp_path / "x.parquet", NAMES)
    message = r"x\.parquet: the result cannot be written: File too large; choose another place\.$"
    with full_disk(), pytest.raises(OrchestrationError, match=message):
        stream(sink, sample(5000), 1)
    gc.collect()
    assert 64 < sink.count < 5000
    assert (sink.written, files(tmp_path)) == (None, [])


def test_a_partial_file_that_does_not_fit_does_not_hide_the_failure(tmp_path: Path) -> None:
    with full_disk(), pytest.raises(ValueError, match="diverged") as caught:
        stream(ParquetSink(tmp_path / "x.parquet", NAMES), sample(5000), 5000, ValueError("diverged"))
    gc.collect()
    assert caught.value.__notes__ == [
        f"{tmp_path / 'x.parquet'}: the result cannot be written: File too large; choose another place. No row is kept."
    ]
    assert files(tmp_path) == []
