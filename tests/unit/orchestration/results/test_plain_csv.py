"""CSV without Arrow has the bytes and the numbers of CSV with Arrow."""

import math
import struct
from pathlib import Path

import numpy as np
import pytest

from orchestration.errors import OrchestrationError
from orchestration.master.series_files import read_table
from orchestration.results import csv_file
from orchestration.results.columns import Columns
from orchestration.results.formats import read_columns

EDGES = (0.0, -0.0, 1.0, 1e-4, 9.999e-5, 1e-6, 9.99e-7, 1e9, 9999999999.5, 1e10, 1e15, 1e16, 1.5e300, 5e-324)
COUNT = 20_000


@pytest.fixture
def without_arrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the file formats find no pyarrow."""
    for module in ("orchestration.results.csv_file", "orchestration.master.series_files"):
        monkeypatch.setattr(f"{module}.has", lambda _: False)


def columns() -> Columns:
    """Numbers of all sizes and kinds, and texts with all that needs quotes."""
    random = np.random.default_rng(1)
    bits = [struct.unpack("d", random.bytes(8))[0] for _ in range(COUNT)]
    usual = random.uniform(-1, 1, COUNT) * 10.0 ** random.integers(-9, 13, COUNT)
    edges = np.resize([*EDGES, *(-edge for edge in EDGES), math.nan, math.inf, -math.inf], COUNT)
    texts = np.resize(np.array(["", 'say "x"', "a,b", "two\nlines", "\udc80", "µ"], object), COUNT)
    rows = np.column_stack([bits, usual, edges])
    return Columns(np.arange(COUNT) * 1e-4, ("a.bits", 'a."usual"', "a.edges"), rows, texts={"a.text": texts})


def test_the_bytes_are_those_of_arrow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    csv_file.write_csv(columns(), tmp_path / "arrow.csv")
    monkeypatch.setattr("orchestration.results.csv_file.has", lambda _: False)
    csv_file.write_csv(columns(), tmp_path / "plain.csv")
    assert (tmp_path / "plain.csv").read_bytes() == (tmp_path / "arrow.csv").read_bytes()


def test_what_is_read_is_what_arrow_reads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "rows.csv"
    csv_file.write_csv(columns(), path)
    arrow = csv_file.read_csv(path)
    monkeypatch.setattr("orchestration.results.csv_file.has", lambda _: False)
    plain = csv_file.read_csv(path)
    assert plain.names == arrow.names
    assert plain.time.tobytes() == arrow.time.tobytes()
    assert plain.rows.tobytes() == arrow.rows.tobytes()
    assert plain.texts["a.text"].tolist() == arrow.texts["a.text"].tolist()


@pytest.mark.usefixtures("without_arrow")
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('"time","a.b"\n0,1\n1\n', "row 3 has 1 cells, and the first line names 2 columns"),
        ('"time","a.b"\n0,1_000\n', "column a.b has a cell that is not a number: '1_000'"),
        ('"time","a.b"\n0,\n', "column a.b has a cell that is not a number: ''"),
        ('"x","a.b"\n0,1\n', "its first column is x, not time"),
    ],
)
def test_a_file_of_something_else_is_refused(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "rows.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(OrchestrationError) as error:
        read_columns(path)
    assert says in str(error.value)


@pytest.mark.usefixtures("without_arrow")
def test_an_empty_cell_of_measured_data_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "measured.csv"
    path.write_text("\ufefftime,F\n0,1.5\n1,\n", encoding="utf-8")
    (time, force) = read_table(path).columns
    assert (time[0], force[0]) == ("time", "F")
    np.testing.assert_array_equal(force[1], [1.5, math.nan])
