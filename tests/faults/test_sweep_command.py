"""Evidence for ``adaptimp sweep``: its table, what it says, what it refuses, and how it goes on after Ctrl-C."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from orchestration import Study, System
from orchestration.campaigns.execution.progress import Tally
from orchestration.cli.sweep_report import SweepReport
from orchestration.paper.studies.ready import READY_STUDIES, ReadyStudy
from tests.faults.cli import Command, Outcome

PAGE = Path(__file__).parents[2] / "docs" / "campaigns.md"
DEPTH = "depth = max(plant.penetration)"
MEASURES = ("--measure", DEPTH, "--measure", "max(abs(controller.e[1]))")
SHORT = ("--stop", "0.01")
GRID = ("fig2", "--vary", "plant.K_f=1e4:1e6:3log", "--vary", "controller.K=2000,4000", *MEASURES, *SHORT)

RESUME = "adaptimp sweep --resume runs"


@pytest.fixture
def study(fig2: System) -> Study:
    """The study that `GRID` asks for."""
    measures = [DEPTH, "max(abs(controller.e[1]))"]
    factors = {"plant.K_f": [1e4, 1e5, 1e6], "controller.K": [2000.0, 4000.0]}
    return Study(fig2, measure=measures, stop_time=0.01).grid(factors)


def test_the_table_is_that_of_the_study(adaptimp: Command, study: Study, tmp_path: Path) -> None:
    table = study.run()
    assert isinstance(table, xr.Dataset)
    outcome = adaptimp(*("sweep", *GRID), "-o", "x.nc")
    assert (outcome.code, outcome.err) == (0, "")
    with xr.open_dataset(tmp_path / "x.nc", engine="scipy") as found:
        assert dict(found.sizes) == {"K_f": 3, "K": 2}
        assert found["depth"].attrs["units"] == "m"
        np.testing.assert_array_equal(found["depth"].to_numpy(), table["depth"].to_numpy())
    frame = table.to_dataframe().reset_index()
    for file, read in (("x.csv", pd.read_csv), ("x.parquet", pd.read_parquet)):
        assert f"\nwrote {file}: 6 rows\n" in adaptimp("sweep", *GRID, "-o", file).out
        found = read(tmp_path / file)
        assert list(found.columns) == list(frame.columns)
        np.testing.assert_array_equal(found["depth"].to_numpy(), frame["depth"].to_numpy())
    assert "replaced x.csv: 6 rows" in adaptimp("sweep", *GRID, "-o", "x.csv").out


def test_a_terminal_reads_counts_and_extremes(adaptimp: Command, study: Study) -> None:
    table = study.run()
    assert isinstance(table, xr.Dataset)
    outcome = adaptimp("sweep", *GRID)
    assert outcome.err == ""
    assert re.match(r"fig2: 6 runs: 6 complete, 0 failed; \S+ runs/s, \S+ s\n", outcome.out)
    line = next(line for line in outcome.out.splitlines() if line.startswith("depth"))
    frame = table.to_dataframe().reset_index()
    at = frame.loc[frame["depth"].idxmin()].to_dict()
    place = f"K_f={at['K_f']:g}, K={at['K']:g}"
    assert " ".join(line.split()) == f"depth m min {at['depth']:.6g} {place}"


def documented() -> list[str]:
    """Keys of the object, as the page gives them."""
    section = PAGE.read_text(encoding="utf-8").partition("\n## Numbers for programs\n")[2]
    return re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE)


def read(outcome: Outcome) -> dict[str, Any]:
    """The object, which has all documented keys and no other."""
    found = json.loads(outcome.out)
    assert list(found) == documented()
    assert found["exit_code"] == outcome.code
    return found


def test_the_object_has_the_documented_keys(adaptimp: Command, study: Study) -> None:
    table = study.run()
    assert isinstance(table, xr.Dataset)
    found = read(adaptimp("sweep", *GRID, "--json"))
    assert (found["status"], found["runs"], found["complete"], found["failed"]) == ("complete", 6, 6, 0)
    assert found["factors"] == ["K_f", "K"]
    assert found["measures"]["depth"]["max"] == table["depth"].to_numpy().max()
    refused = read(adaptimp("sweep", "fig2", "--vary", "plant.K=1,2", *MEASURES, "--json"))
    assert (refused["status"], refused["exit_code"], refused["runs"]) == ("refused", 2, 0)


@pytest.mark.parametrize("options", [("nothing.toml",), (), ("fig2", "--vary", "plant.K_f"), ("--resume", "runs")])
def test_what_cannot_be_begun_is_an_object_too(adaptimp: Command, options: tuple[str, ...]) -> None:
    outcome = adaptimp("sweep", *options, "--json")
    found = read(outcome)
    assert (found["status"], found["exit_code"], found["message"]) == ("refused", 2, outcome.sentence)


def test_failed_runs_are_rows(adaptimp: Command, tmp_path: Path) -> None:
    some = adaptimp("sweep", "fig2", "--vary", "plant.K_f=-1,1e5,-2", *MEASURES, *SHORT, "-o", "x.csv")
    assert some.code == 0
    assert some.out.startswith("fig2: 3 runs: 1 complete, 2 failed")
    assert re.fullmatch(r"2 runs failed: plant: .*K_f = -1 must be at least 0 N/m.*\n", some.err)
    found = pd.read_csv(tmp_path / "x.csv")
    assert found["status"].tolist() == ["failed", "complete", "failed"]
    assert found["depth"].isna().tolist() == [True, False, True]
    every = adaptimp("sweep", "fig2", "--vary", "plant.K_f=-1,-2", *MEASURES, *SHORT, "--json")
    assert every.code == 1
    assert read(every)["message"].startswith("2 runs failed, and none is complete: plant: ")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--vary", "plant.Kf=1,2", *MEASURES), r"did you mean plant\.K_f"),
        (("--vary", "K_q=1,2", *MEASURES), r"Factor K_q: no component has a start value of this name"),
        (("--vary", "sample_tim=1,2", *MEASURES), r"did you mean .*sample_time"),
        (("--vary", "m=1,2", "--vary", "K_f=10:1e4", *MEASURES), r"Factor K_f: '10:1e4'"),
        (("--vary", "l=1,2", *MEASURES), r"controller, plant .*write controller\.l or plant\.l"),
        (("--vary", "K_f=", *MEASURES), r"Factor K_f: ''; "),
        (("--vary", "K_f=1:1:5", *MEASURES), r"two different ends"),
        (("--vary", "K_f=1,1", *MEASURES), r"is there twice"),
        (("--seeds", "1-x", *MEASURES), r"Factor seed: '1-x'; write "),
        (("--vary", "K_f=1,2", "--measure", "max(plant.penetratio)"), r"did you mean plant\.penetration\?"),
        (("--vary", "K_f=1,2", "--measure", "maxi(plant.x[1])"), r"maxi"),
        (("--vary", "K_f=1:2", "--samples", "4", "--method", "sobel", *MEASURES), r"did you mean sobol"),
        (("--vary", "K_f=1,2", "--best", "min:depht", *MEASURES), r"did you mean depth\?"),
        (("--vary", "K_f=1,2", "--best", "depth", *MEASURES), r"write min:MEASURE"),
        (("--vary", "K_f=1,2", "--workers", "0", *MEASURES), r"workers is 0; "),
        (("--vary", "K_f=1,2", "-o", "x.xlsx", *MEASURES), r"\.csv, \.parquet, \.nc"),
    ],
)
def test_what_is_wrong_is_refused_with_help(
    adaptimp: Command, tmp_path: Path, options: tuple[str, ...], said: str
) -> None:
    outcome = adaptimp("sweep", "fig2", *options, *SHORT)
    assert outcome.code == 2
    assert re.search(said, outcome.sentence), outcome.sentence
    assert outcome.out == ""
    assert not list(tmp_path.iterdir())


def test_a_folder_that_is_no_store_is_refused(adaptimp: Command, tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("", encoding="utf-8")
    for options in (("--resume", "mine"), ("--resume", "nothing"), (*GRID, "--store", "mine/thesis.tex")):
        outcome = adaptimp("sweep", *options)
        assert outcome.code in (1, 2)
        assert re.search(r"mine|nothing", outcome.sentence)
    assert not (tmp_path / "nothing").exists()


def test_an_interrupted_campaign_goes_on(adaptimp: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert adaptimp("sweep", *GRID, "-o", "whole.csv").code == 0
    add = Tally.add

    def interrupted(tally: Tally, *arguments: Any, **named: Any) -> None:
        add(tally, *arguments, **named)
        if tally.done:
            raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Tally, "add", interrupted)
        outcome = adaptimp("sweep", *GRID, "--workers", "1", "--store", "runs", "--json")
    found = read(outcome)
    assert (found["status"], outcome.code) == ("interrupted", 130)
    assert 0 < found["complete"] < 6
    assert outcome.err == f"Interrupted: {found['complete']} of 6 runs are in runs; go on with: {RESUME}\n"
    resumed = adaptimp("sweep", "--resume", "runs", "-o", "resumed.csv")
    assert f"; {found['complete']} were in the store; " in resumed.out
    assert (tmp_path / "resumed.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    assert "; 6 were in the store\n" in adaptimp("sweep", *GRID, "--store", "runs").out


def test_rows_without_a_store_are_rescued(adaptimp: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Tally, "add", interrupted)
    outcome = adaptimp("sweep", *GRID, "--workers", "1", "-o", "x.csv")
    assert outcome.code == 130
    assert re.search(r"^Interrupted: .* no store keeps them; --store FOLDER does\.$", outcome.err, re.MULTILINE)
    assert [file.name for file in tmp_path.iterdir()] == ["x.partial.csv"]
    found = pd.read_csv(tmp_path / "x.partial.csv")
    assert f"wrote x.partial.csv: the {len(found)} rows before that" in outcome.err
    assert set(found["status"]) == {"complete"}
    assert 0 < len(found) < 6


def test_failed_runs_are_made_again_on_request(adaptimp: Command) -> None:
    adaptimp("sweep", "fig2", "--vary", "plant.K_f=1e4,-1", *MEASURES, *SHORT, "--store", "runs")
    assert "; 2 were in the store\n" in adaptimp("sweep", "--resume", "runs").out
    assert "; 1 were in the store; " in adaptimp("sweep", "--resume", "runs", "--retry-failed").out


def test_a_dry_run_makes_no_table(adaptimp: Command, tmp_path: Path) -> None:
    outcome = adaptimp("sweep", *GRID, "--store", "runs", "-o", "x.csv", "--workers", "2", "--dry-run")
    lines = [" ".join(line.split()) for line in outcome.out.splitlines()]
    assert lines[0] == "fig2: 6 runs, 100 steps each (0.01 s)"
    assert "K_f 3 10000, 100000, 1e+06" in lines
    assert "measures: depth [m], max(abs(controller.e[1])) [m]" in lines
    assert re.fullmatch(r"One run takes .* here, so all of them take about .* with 2 workers\.", lines[-1])
    assert not list(tmp_path.iterdir())


def test_a_dry_run_of_steps_and_of_too_many_runs(adaptimp: Command) -> None:
    steps = adaptimp("sweep", "fig2", "--vary", "sample_time=1e-4,1e-3", *MEASURES, *SHORT, "--dry-run")
    assert steps.out.startswith("fig2: 2 runs, 10 to 100 steps each (0.01 s)\n")
    many = ("--vary", "K_f=1:2:2000", "--vary", "m=1:2:2000", "--seeds", "1-20")
    assert adaptimp("sweep", "fig2", *many, *MEASURES, "--dry-run").out == (
        "fig2: 80000000 runs, too many to list their factors\n"
    )


def test_the_same_study_from_a_file(adaptimp: Command, tmp_path: Path) -> None:
    text = f'system = "fig2"\nstop = 0.01\nmeasure = ["{DEPTH}", "max(abs(controller.e[1]))"]\n'
    text += 'vary = {"plant.K_f" = "1e4:1e6:3log", "controller.K" = [2000, 4000]}\n'
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    assert adaptimp("sweep", *GRID, "-o", "options.csv").code == 0
    assert adaptimp("sweep", "study.toml", "-o", "file.csv").code == 0
    assert (tmp_path / "file.csv").read_bytes() == (tmp_path / "options.csv").read_bytes()


def test_ready_studies_are_listed_and_run(
    adaptimp: Command, study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    listed = json.loads(adaptimp("sweep", "--ready", "--json").out)
    assert listed == {name: ready.summary for name, ready in READY_STUDIES.items()}
    text = adaptimp("sweep", "--ready").out
    assert all(re.search(rf"^{re.escape(name)}  +\w", text, re.MULTILINE) for name in listed)
    first = next(iter(listed))
    assert f"did you mean {first}" in adaptimp("sweep", "--ready", f"{first}s").sentence
    small = {"small": ReadyStudy("A small one", lambda: study)}
    monkeypatch.setattr("orchestration.paper.studies.ready.READY_STUDIES", small)
    assert adaptimp("sweep", "--ready", "small", "-o", "ready.csv").out.startswith(
        "small: 6 runs: 6 complete, 0 failed"
    )
    assert adaptimp("sweep", *GRID, "-o", "options.csv").code == 0
    assert (tmp_path / "ready.csv").read_bytes() == (tmp_path / "options.csv").read_bytes()


def test_variants_share_points_and_samples(adaptimp: Command, tmp_path: Path) -> None:
    text = f'measure = "{DEPTH}"\nstop = 0.01\nsystem = {{plain = "fig2", payload = "fig4"}}\n'
    text += 'samples = 4\nvary = {"plant.K_f" = "1e4:1e6 log"}\n'
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    assert adaptimp("sweep", "study.toml", "-o", "x.csv").code == 0
    found = pd.read_csv(tmp_path / "x.csv")
    plain, payload = (found[found["system"] == name] for name in ("plain", "payload"))
    assert plain["K_f"].tolist() == payload["K_f"].tolist()
    assert len(set(plain["K_f"])) == 4


def test_the_report_of_an_interruption_is_no_success() -> None:
    report = SweepReport("fig2", "gauss-seidel")
    report.ended_by(KeyboardInterrupt())
    assert (report.status, report.exit_code, report.message) == ("interrupted", 130, "The campaign was interrupted.")
