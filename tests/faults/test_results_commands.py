"""Evidence for ``adaptimp plot``, ``adaptimp compare`` and ``run --plot``: what they write, say, and refuse."""

import json
from pathlib import Path

import numpy as np
import pytest

from orchestration import Result
from tests.faults.cli import Command

SHORT = ("--stop", "0.01", "--no-verdict")


def kind_of(path: Path) -> str:
    beginning = path.read_bytes()[:5]
    known = {b"\x89PNG\r": "png", b"<?xml": "svg", b"%PDF-": "pdf", b"RIFF": "webp", b"GIF8": "gif"}
    return next(kind for begin, kind in known.items() if beginning.startswith(begin))


@pytest.fixture
def results(adaptimp: Command) -> Command:
    """The command line in a folder with three results."""
    assert adaptimp("run", "fig2", *SHORT, "-o", "a.parquet").code == 0
    assert adaptimp("run", "fig2", *SHORT, "--set", "controller.K[1]=3000", "-o", "b.parquet").code == 0
    assert adaptimp("run", "fig2", *SHORT, "--record", "plant.x", "-o", "tip.csv").code == 0
    return adaptimp


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
@pytest.mark.parametrize("rows", [None, "x.csv", "x.parquet"])
def test_a_run_is_drawn(adaptimp: Command, tmp_path: Path, suffix: str, rows: str | None) -> None:
    outcome = adaptimp("run", "fig2", *SHORT, "--plot", f"new/x.{suffix}", *(["-o", rows] if rows else []))
    assert (outcome.code, outcome.err) == (0, "")
    assert f"wrote {Path('new') / f'x.{suffix}'}\n" in outcome.out
    assert kind_of(tmp_path / "new" / f"x.{suffix}") == suffix


@pytest.mark.parametrize("suffix", ["webp", "gif"])
def test_the_arm_moves_in_a_picture(results: Command, tmp_path: Path, suffix: str) -> None:
    outcome = results("plot", "a.parquet", "-o", f"new/x.{suffix}")
    assert (outcome.code, outcome.out, outcome.err) == (0, f"wrote {Path('new') / f'x.{suffix}'}\n", "")
    assert kind_of(tmp_path / "new" / f"x.{suffix}") == suffix


def test_the_same_rows_give_the_same_picture(results: Command, tmp_path: Path) -> None:
    assert results("run", "fig2", *SHORT, "--plot", "run.png", "-o", "fig2.parquet").code == 0
    assert results("plot", "fig2.parquet", "-o", "plot.png").code == 0
    assert (tmp_path / "run.png").read_bytes() == (tmp_path / "plot.png").read_bytes()
    assert results("plot", "fig2.parquet", "--dark").out == "wrote fig2.png\n"
    assert (tmp_path / "fig2.png").read_bytes() != (tmp_path / "plot.png").read_bytes()


def test_columns_are_drawn_by_unit(results: Command, tmp_path: Path) -> None:
    outcome = results("plot", "a.parquet", "b.parquet", "plant.x", "controller.tau_cmd", "-o", "x.svg")
    assert (outcome.code, outcome.err) == (0, "")
    text = (tmp_path / "x.svg").read_text(encoding="utf-8")
    for name in ("a: plant.x[1]", "b: plant.x[2]", "a: controller.tau_cmd[1]", "time (s)"):
        assert f">{name}</text>" in text


def test_a_result_that_is_not_of_the_loop_is_drawn_by_unit(results: Command) -> None:
    outcome = results("plot", "a.parquet", "tip.csv")
    assert outcome.code == 0
    assert outcome.err == (
        "Notice: tip has no controller.e, plant.F_ext and actuator.tau of the paper's loop, so each unit has a panel.\n"
    )


def test_results_in_the_plane_and_in_space_are_drawn_by_unit(results: Command) -> None:
    assert results("run", "puma", *SHORT, "-o", "puma.parquet").code == 0
    outcome = results("plot", "a.parquet", "puma.parquet")
    assert (outcome.code, outcome.err) == (
        0,
        "Notice: a has 2 and puma has 6 task coordinates, so each unit has a panel.\n",
    )


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (
            ("a.parquet", "-o", "x.bmp"),
            r"x.bmp: a picture cannot have the suffix .bmp; choose .png, .svg, .pdf, .webp, .gif.",
        ),
        (("a.parquet", "-o", "x"), r"x: a picture needs a suffix; choose .png, .svg, .pdf, .webp, .gif."),
        (("a.parquet", "b.parquet", "-o", "x.gif"), r"x.gif: a moving picture shows one result, and 2 were given."),
        (
            ("a.parquet", "plant.x", "-o", "x.gif"),
            r"x.gif: a moving picture shows the arm and no chosen columns; leave plant.x out.",
        ),
        (
            ("tip.csv", "-o", "x.webp"),
            r"tip: a moving picture shows an arm, and needs plant.q, plant.F_ext; record all columns of the plant.",
        ),
        (("c.parquet",), "c.parquet: there is no such file of a result; did you mean b.parquet or a.parquet?"),
        (("plant.x",), "plant.x: a result to draw is needed, a file with the suffix .csv or .parquet."),
        (
            ("a.parquet", "plant.y"),
            "The result has no column plant.y; did you mean plant.x or plant.q or plant.dx or plant.dq?",
        ),
        (("a.parquet", "a.parquet"), "a.parquet is given twice; name each result once."),
        (
            tuple(f"{i}.csv" for i in range(8)),
            "8 results were given, and colours tell 7 apart; draw fewer in one picture.",
        ),
    ],
)
def test_plot_refuses(results: Command, words: tuple[str, ...], sentence: str) -> None:
    outcome = results("plot", *words)
    assert (outcome.code, outcome.sentence) == (2, sentence)


def test_plot_refuses_unreadable_files_and_places(results: Command, tmp_path: Path) -> None:
    (tmp_path / "bad.parquet").write_text("hello")
    assert results("plot", "bad.parquet").sentence.startswith("bad.parquet does not hold a result: ")
    sentence = results("plot", "a.parquet", "-o", "tip.csv/x.png").sentence
    assert sentence.startswith("--out: nothing can be written to tip.csv: ")
    Result(np.zeros(0), ("a.x",), np.zeros((0, 1))).write(tmp_path / "empty.csv")
    assert "has no rows, so there is nothing to draw" in results("plot", "empty.csv").sentence


def test_run_refuses_a_picture_before_it_begins(adaptimp: Command, tmp_path: Path) -> None:
    outcome = adaptimp("run", "fig2", "--plot", "x.bmp", "-o", "x.csv")
    assert (outcome.code, outcome.out) == (2, "")
    assert not (tmp_path / "x.csv").exists()


def test_equal_results_agree(results: Command) -> None:
    assert results("run", "fig2", *SHORT, "-o", "a.csv").code == 0
    outcome = results("compare", "a.parquet", "a.csv")
    assert (outcome.code, outcome.out) == (0, "The results agree in all bits: 40 columns, 101 rows.\n")


def test_differences_are_listed_with_their_first_row(results: Command) -> None:
    outcome = results("compare", "a.parquet", "b.parquet")
    assert outcome.code == 1
    *_, verdict = outcome.out.splitlines()
    assert verdict.startswith("The results differ: ")
    found = json.loads(results("compare", "a.parquet", "b.parquet", "--json").out)
    assert (found["exit_code"], found["identical"], found["verdict"]) == (1, False, verdict)
    a, b = Result.read("a.parquet"), Result.read("b.parquet")
    for name, column in found["columns"].items():
        unequal = np.flatnonzero(a[name] != b[name])
        assert column["first_row"] == (int(unequal[0]) if len(unequal) else None)
        assert column["largest"] == np.abs(a[name] - b[name]).max()
    assert [name for name in found["columns"] if name.startswith("trajectory.")]
    assert found["columns"]["trajectory.x_v[1]"]["first_row"] is None


def test_results_of_other_columns_and_rows_differ(results: Command) -> None:
    assert (
        results("run", "fig2", "--stop", "0.005", "--no-verdict", "--record", "plant.x,plant.q", "-o", "c.csv").code
        == 0
    )
    outcome = results("compare", "tip.csv", "c.csv")
    assert outcome.code == 1
    assert outcome.out == (
        "The results differ: only the second has plant.q[1], plant.q[2]; 51 rows are common to the 101 and 51 of the"
        " two; in what both have, all bits agree.\n"
    )


def test_compare_refuses(results: Command, tmp_path: Path) -> None:
    outcome = results("compare", "a.parquet", "c.parquet", "--json")
    assert outcome.code == 2
    assert json.loads(outcome.out)["error"] == outcome.sentence
    Result(np.array([5.0]), ("plant.x[1]",), np.zeros((1, 1))).write(tmp_path / "late.csv")
    assert "no common communication point" in results("compare", "a.parquet", "late.csv").sentence
