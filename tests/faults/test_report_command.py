"""Evidence that ``adaptimp report`` and ``run --plot F.html`` write pages, and refuse bad requests before work."""

from pathlib import Path

import numpy as np
import pytest

from orchestration import Result
from orchestration.cli.codes import ExitCode
from tests.faults.cli import Command, runner


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command line in a folder with two results."""
    monkeypatch.chdir(tmp_path)
    time = np.array([0.0, 0.1, 0.2])
    for name, last in (("one", 3.0), ("two", 4.0)):
        Result(time, ("tank.level",), np.array([[1.0], [2.0], [last]]), units={"tank.level": "m"}).write(f"{name}.csv")
    return runner(monkeypatch, capsys)


def test_a_report_about_two_files(adaptimp: Command, tmp_path: Path) -> None:
    done = adaptimp("report", "one.csv", "two.csv", "-o", "new/both.html")
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith("wrote new/both.html, 0.")
    text = (tmp_path / "new" / "both.html").read_text(encoding="utf-8")
    assert "The results differ: 1 of 1 common columns differ, tank.level most, by 1, 0.5 of its range" in text
    assert adaptimp("report", "one.csv", "-o", "new/both.html").out.startswith("replaced new/both.html")


def test_a_run_and_a_system_become_pages(adaptimp: Command, tmp_path: Path) -> None:
    done = adaptimp("run", "fig2", "--stop", "0.01", "-o", "fig2.parquet", "--plot", "run.html")
    assert done.code == 0
    assert "wrote run.html" in done.out
    text = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert "adaptimp run fig2 --stop 0.01 --hash" in text
    assert "so there is no ledger" in text  # the system is at hand
    assert adaptimp("report", "fig2.parquet").out.startswith("wrote report.html")
    assert "which a file of rows does not have" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("one.csv", "-o", "page.pdf"), ExitCode.REFUSED, "page.pdf: a page has the suffix .html; 'adaptimp plot'"),
        (("one.csv", "two.csv", "one.csv"), ExitCode.REFUSED, "3 runs were given; a report is about one run"),
        (("one.csv", "one.csv"), ExitCode.REFUSED, "one.csv is given twice; name each run once."),
        (("three.csv",), ExitCode.REFUSED, "three.csv"),
        (("fig22",), ExitCode.REFUSED, "There is no scenario fig22"),
        (("one.csv", "-o", "one.csv/page.html"), ExitCode.REFUSED, "--out: nothing can be written to one.csv"),
    ],
)
def test_what_cannot_be_reported_is_refused(
    adaptimp: Command, tmp_path: Path, words: tuple[str, ...], code: ExitCode, said: str
) -> None:
    done = adaptimp("report", *words)
    assert said in done.err
    assert done.code == code
    assert not list(tmp_path.glob("*.html"))


def test_pictures_and_pages_are_told_apart(adaptimp: Command) -> None:
    done = adaptimp("run", "fig2", "--stop", "0.01", "--plot", "run.bmp")
    assert done.code == ExitCode.REFUSED
    assert "cannot have the suffix .bmp; choose .png, .svg, .pdf, .webp, .gif, .html." in done.err
    done = adaptimp("run", "fig2", "--stop", "0.01", "--plot", "run.html", "--dark")
    assert "--dark is for pictures; run.html is a page, which has a button for that." in done.err
    done = adaptimp("plot", "one.csv", "-o", "run.html")
    assert "choose .png, .svg, .pdf, .webp, .gif." in done.err
