"""Tests that the examples in docstrings of the package run."""

from pathlib import Path

import pytest

from adaptimp_fmu.files import cache_contents, cache_folder, cache_use, sealed_file, temporary_folder, whole_file
from tests.unit.examples import failures

EXAMPLES = {
    f.__name__: f
    for f in (
        whole_file.Draft,
        whole_file.whole_file,
        whole_file.write_whole,
        whole_file.shortened,
        temporary_folder.temporary_folder,
        temporary_folder.sweep,
        sealed_file.write_sealed,
        sealed_file.read_sealed,
        cache_use.use,
        cache_contents.places,
        cache_contents.amount,
        cache_contents.clear,
        cache_folder.temporary_cache,
    )
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_example_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert failures(name, EXAMPLES[name], tmp_path, monkeypatch) == ""
