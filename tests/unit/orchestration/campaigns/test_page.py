"""The page of a study: one file that holds its pictures, its numbers, and what failed."""

import base64
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from orchestration import StudyError, UnknownNameError
from orchestration.campaigns.pictures.page import PAGE, write_page
from tests.unit.orchestration.campaigns.tables import MASSES, SEEDS, K, force, grid, samples

NOISY = grid({"K_f": K, "m": MASSES, "seed": SEEDS}, force, lambda K_f, m, seed: (K_f * m > 5e5) & (seed > m))


def test_a_page_is_one_file_with_everything_in_it(tmp_path: Path) -> None:
    files = write_page(NOISY, tmp_path / "plots", command="adaptimp sweep fig7 <now>", limits={"peak": 300.0})
    assert [file.name for file in files] == ["peak-heat-map.png", "peak-boundary.png", PAGE]
    text = files[-1].read_text(encoding="utf-8")
    assert "<script" not in text
    assert not re.search(r"(src|href)=\"(?!data:)", text)
    inside = [base64.b64decode(data) for data in re.findall(r"base64,([^\"]+)", text)]
    assert inside == [file.read_bytes() for file in files[:-1]]
    assert "<h1>Study of fig7</h1>" in text
    failed = int((NOISY["status"] == "failed").sum())
    assert f"48 runs, {failed} failed, algorithm gauss-seidel, until 2 s." in text
    assert "<pre>adaptimp sweep fig7 &lt;now&gt;</pre>" in text
    assert text.count("its last message: &lt;b&gt;&amp;.") == failed
    finite = NOISY["peak"].values[np.isfinite(NOISY["peak"].values)]
    assert f'<td class="number">{np.median(finite):.5g}</td>' in text
    assert "<td>K_f</td><td>N/m</td>" in text


def test_measures_whose_names_look_alike_have_pictures_of_their_own(tmp_path: Path) -> None:
    points = pd.DataFrame({"K_f": K})
    table = samples(points, np.sqrt(K)).rename(columns={"peak": "max(a.x)"})
    table.insert(1, "max(a x)", K)
    files = write_page(table, tmp_path)
    assert [file.name for file in files] == ["max_a_x_-marginals.png", "max_a.x_-marginals.png", PAGE]
    table.insert(1, "max(a-x) ", K)
    table.insert(1, "max(a-x)", 2 * K)
    names = [file.name for file in write_page(table, tmp_path)]
    assert len(set(names)) == len(names) == 5


def test_the_rows_of_failed_runs_have_an_end(tmp_path: Path) -> None:
    table = samples(pd.DataFrame({"K_f": np.geomspace(1, 2, 150)}), np.full(150, np.nan))
    text = write_page(table, tmp_path)[-1].read_text(encoding="utf-8")
    assert text.count("its last message") == 100
    assert "50 more runs failed" in text


def test_the_same_table_gives_the_same_page(tmp_path: Path) -> None:
    pages = [write_page(NOISY, tmp_path / name)[-1].read_bytes() for name in "ab"]
    assert pages[0] == pages[1]


def test_what_cannot_be_written_or_limited_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="no measure 'peek'"):
        write_page(NOISY, tmp_path, limits={"peek": 1.0})
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="cannot be written"):
        write_page(NOISY, tmp_path / "file")
    with pytest.raises(StudyError, match="The table has no measure"):
        write_page(NOISY.drop_vars("peak"), tmp_path)
