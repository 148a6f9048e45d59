"""Tests that damaged files of all kinds end in a value or a named error; `tests.strangers.fuzz` tries many more."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from orchestration import ArchiveError
from orchestration.sandbox.archive import entry_names
from tests.strangers.hostile.archives import fmu
from tests.strangers.hostile.mutations import TARGETS, examine, mutated, seen_by_others
from tests.strangers.hostile.zips import DEFLATED, STORED, Row, zipped

EXAMPLES = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture(autouse=True)
def own_folders(left_over: Callable[[], list[str]]) -> None:
    """Let caches and temporary files be those of the test."""
    assert not left_over()


@pytest.mark.parametrize("name", TARGETS)
def test_good_files_pass(name: str) -> None:
    read, seeds = TARGETS[name]
    assert {examine(read, seed) for seed in seeds} <= {"", "LibraryError"}  # the seed of a library is its beginning


@pytest.mark.parametrize("name", TARGETS)
@EXAMPLES
@given(seed=st.integers(0, 2**32))
def test_damaged_files_end_in_a_named_error(name: str, seed: int) -> None:
    read, seeds = TARGETS[name]
    for content in seeds:
        examine(read, mutated(content, seed))


@EXAMPLES
@given(
    rows=st.lists(
        st.tuples(
            st.text(st.characters(codec="utf-8"), min_size=1, max_size=20),
            st.binary(max_size=200),
            st.sampled_from([STORED, DEFLATED]),
        ),
        max_size=5,
    ),
    seed=st.none() | st.integers(0, 2**32),
)
def test_what_passes_is_what_others_see(rows: list[tuple[str, bytes, int]], seed: int | None, tmp_path: Path) -> None:
    """An archive with any names, damaged or not, is refused, or has the entries that Python's own reader finds."""
    content = zipped([Row(*row) for row in rows])
    path = tmp_path / "any.zip"
    path.write_bytes(content if seed is None else mutated(content, seed))
    try:
        names = entry_names(path)
    except ArchiveError:
        return
    assert list(names) == seen_by_others(path.read_bytes())


@EXAMPLES
@given(seed=st.integers(0, 2**32))
def test_what_passes_after_damage_is_what_others_see(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "damaged.zip"
    path.write_bytes(mutated(fmu(Row("resources/a", b"a" * 99, DEFLATED)), seed))
    try:
        names = entry_names(path)
    except ArchiveError:
        return
    assert list(names) == seen_by_others(path.read_bytes())
