"""Tests that the examples in docstrings of the package run."""

from pathlib import Path

import pytest

from adaptimp_fmu.files import sealed_file, temporary_folder, whole_file
from tests.unit.examples import failures

EXAMPLES = {
    f.__name__: f
    for f in (
        whole_file.Draft,
        whole_file.whole_file,
        whole_file.write_whole,
        temporary_folder.temporary_folder,
        temporary_folder.sweep,
        sealed_file.write_sealed,
        sealed_file.read_sealed,
    )
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_example_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert failures(name, EXAMPLES[name], tmp_path, monkeypatch) == ""
