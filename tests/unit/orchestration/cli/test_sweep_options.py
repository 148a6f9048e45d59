"""Evidence that options and the keys of a study's file make the same request, and that wrong ones are refused."""

import inspect
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from orchestration.cli.app import app
from orchestration.cli.sweep_command import sweep, with_words
from orchestration.cli.sweep_file import KEYS
from orchestration.cli.sweep_options import sweep_request
from orchestration.cli.sweep_request import Samples
from orchestration.errors import SystemDescriptionError

STUDY = """
system = "fig5"
controller = "SlotineLiAdaptiveImpedance"
seeds = "1-30"
measure = ["peak_force", "worst = max(controller.e[1])"]
samples = 64
method = "random"
sample-seed = 3
stop = 1
step = 1e-4
algorithm = "jacobi"
isolate = ["controller", "plant"]
workers = 1
best = "min:peak_force"
map = { tau_cmd = "Torque" }
set.plant.mu = 0.2
set.plant.m = [2, 1.5]
set.sensor.contact_gated = true

[vary]
"plant.K_f" = "1e4:1e6 log"
controller.K_d = [50, 100.0]
"""
OPTIONS = {
    "controller": "SlotineLiAdaptiveImpedance",
    "seeds": "1-30",
    "measure": ["peak_force", "worst = max(controller.e[1])"],
    "samples": 64,
    "method": "random",
    "sample-seed": 3,
    "stop": 1.0,
    "step": 1e-4,
    "algorithm": "jacobi",
    "isolate": ["controller", "plant"],
    "workers": 1,
    "best": "min:peak_force",
    "map": ["tau_cmd=Torque"],
    "set": ["plant.mu=0.2", "plant.m=[2,1.5]", "sensor.contact_gated=true"],
    "vary": ["plant.K_f=1e4:1e6 log"],
}


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def test_a_file_and_options_make_the_same_request(study: Path) -> None:
    from_file, from_options = sweep_request(str(study), {}), sweep_request("fig5", OPTIONS)
    assert from_file.vary == {"plant.K_f": "1e4:1e6 log", "controller.K_d": [50, 100.0]}
    assert replace(from_file, vary={}) == replace(from_options, vary={})
    assert from_file.samples == Samples(64, "random", 3)


def test_the_keys_are_the_options() -> None:
    options = {name.strip("_").replace("_", "-") for name in inspect.signature(sweep).parameters}
    assert set(KEYS) == options - {"resume", "ready", "dry-run", "json"}


def test_an_option_replaces_its_key(study: Path) -> None:
    request = sweep_request(
        str(study), {"stop": 0.5, "seeds": "7", "vary": ["plant.K_f=1,2"], "set": ["plant.mu=0.3"], "json": True}
    )
    assert (request.stop, request.seeds, request.json) == (0.5, "7", True)
    assert request.vary == {"plant.K_f": "1,2", "controller.K_d": [50, 100.0]}
    assert dict(text.split("=") for text in request.systems[""].settings)["plant.mu"] == "0.3"


def test_files_are_found_beside_the_file(study: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.ssp").write_bytes(b"")
    text = 'system = {ours = "fig5", theirs = "mine.ssp"}\nmeasure = {peak = "max(plant.x[1])"}\nstore = "runs"\n'
    study.write_text(text + 'vary.both = {variables = ["plant.K_f", "plant.D_f"], values = [1, 2]}\n', encoding="utf-8")
    request = sweep_request(str(study), {})
    assert {name: asked.name for name, asked in request.systems.items()} == {
        "ours": "fig5",
        "theirs": str(tmp_path / "mine.ssp"),
    }
    assert request.store == tmp_path / "runs"
    assert request.measures == ("peak = max(plant.x[1])",)
    assert request.vary == {"both": {"variables": ["plant.K_f", "plant.D_f"], "values": [1, 2]}}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("system = 'fig5'\nmeasures = ['a']", "there is no key measures; did you mean measure?"),
        ("system = 'fig5'\nstop = 'two'", "stop is 'two'; a number is needed."),
        ("system = 'fig5'\nworkers = true", "workers is True; an integer is needed."),
        ("system = 'fig5'\nstep = true", "step is True; a number is needed."),
        ("system = 'fig5'\nseeds = [1.5]", "seeds is [1.5]; a text or an integer or a list of integers is needed."),
        ("system = 5", "system is 5; a text or a table is needed."),
        ("system = {a = 5}", "Variant a of the study is 5; a text, the name of a system, is needed."),
        ("seeds = '1-3'", 'the key system is missing; write system = "fig5", or the name of a file.'),
        ("system = fig5", "is not TOML: Invalid value (at line 1, column 10)."),
        ("system = 'fig5'\nvary.both = {variables = ['a.b']}", "both has the keys variables; variables, a list,"),
    ],
)
def test_wrong_files_are_refused(study: Path, text: str, said: str) -> None:
    study.write_text(text, encoding="utf-8")
    with pytest.raises(SystemDescriptionError) as caught:
        sweep_request(str(study), {})
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("system", "given", "said"),
    [
        (None, {}, "A system or the file of a study is needed"),
        ("nothing.toml", {}, "nothing.toml: there is no such file of a study."),
        ("fig5", {"vary": ["plant.K_f"]}, "--vary plant.K_f: NAME=RANGE is needed, such as plant.K_f=1e4:1e6:9log."),
        ("fig5", {"vary": ["a.b=1", "a.b=2"]}, "--vary a.b: the factor is given twice, as 1 and as 2; give it once."),
        ("fig5", {"vary": ["a.b=1"], "method": "sobol"}, "method is about points that are drawn"),
        ("fig5", {"resume": Path("runs")}, "SYSTEM fig5: --resume runs takes the study as it is; leave SYSTEM"),
        (
            None,
            {"resume": Path("runs"), "seeds": "1-2"},
            "--seeds: --resume runs takes the study as it is; leave",
        ),
        (None, {"ready": "c11", "set": ["plant.mu=1"]}, "--set: --ready c11 takes the study as it is; leave --set out"),
        (None, {"resume": Path("runs"), "store": Path("x")}, "--store: --resume runs takes the study as it is"),
    ],
)
def test_wrong_options_are_refused(system: str | None, given: dict[str, Any], said: str) -> None:
    with pytest.raises(SystemDescriptionError) as caught:
        sweep_request(system, given)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"measure": [], "seeds": "1-2"}, "Nothing is measured; give --measure, such as peak_force"),
        ({"measure": ["peak_force"]}, "Nothing varies; give --vary or --seeds: NAME=RANGE is needed"),
        (
            {"measure": ["a"], "samples": 4},
            "--samples 4: there is no factor to draw; give --vary, such as plant.K_f=1e4",
        ),
        ({"measure": ["a"], "samples": 4, "seeds": "1-2"}, "--samples 4: there is no factor to draw; give --vary"),
        ({"measure": ["a"], "seeds": "1", "retry-failed": True}, "--retry-failed is about runs that a store has"),
        ({"out": Path("x.txt")}, "--out x.txt: tables are written as .csv, .parquet, .nc"),
        ({"cluster": "tcp://a:1", "workers": 2}, "--cluster and --workers exclude each other"),
        ({"measure": ["a"], "seeds": "1", "step": 1e-4, "sample-time": 1e-4}, "--step and --sample-time exclude"),
    ],
)
def test_requests_without_sense_are_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(SystemDescriptionError) as caught:
        sweep_request("fig5", given).require_sense()
    assert said in str(caught.value)


def test_resuming_takes_options_that_are_not_the_study() -> None:
    request = sweep_request(None, {"resume": Path("runs"), "workers": 1, "out": Path("x.csv"), "dry-run": False})
    assert (request.resume, request.store, request.workers, request.out) == (
        Path("runs"),
        Path("runs"),
        1,
        Path("x.csv"),
    )
    request.require_sense()


def test_zero_is_a_value() -> None:
    request = sweep_request("fig5", {"samples": 4, "sample-seed": 0, "workers": 0, "stop": 0.0, "set": []})
    assert (request.samples, request.workers, request.stop) == (Samples(4, seed=0), 0, 0.0)


def test_plot_takes_a_folder_or_none() -> None:
    assert with_words(["fig5", "--plot"]) == ["fig5", "--plot", "plots"]
    assert with_words(["--plot", "-o", "x.csv"]) == ["--plot", "plots", "-o", "x.csv"]
    assert with_words(["--plot", "out", "fig5"]) == ["--plot", "out", "fig5"]


def test_seeds_that_are_given_several_times_are_joined(monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, Any] = {}

    def run_sweep(_: str | None, options: dict[str, Any]) -> int:
        given.update(options)
        return 0

    monkeypatch.setattr("orchestration.cli.sweep.run_sweep", run_sweep)
    words = ["sweep", "fig7", "--seeds", "1-2", "--seeds", "4", "--measure", "peak_force"]
    outcome = CliRunner().invoke(app, words)
    assert outcome.exit_code == 0, outcome.output
    assert given["seeds"] == "1-2,4"


def test_failed_runs_of_a_store_are_made_again_on_request(study: Path) -> None:
    study.write_text(f'retry-failed = true\nstore = "runs"\n{STUDY}', encoding="utf-8")
    given = {"retry-failed": True}
    assert sweep_request(str(study), {}).retry_failed
    assert sweep_request(None, {"resume": Path("runs"), **given}).retry_failed
    assert sweep_request("fig5", {"store": Path("runs"), **given}).retry_failed
    assert not sweep_request("fig5", {"store": Path("runs"), "retry-failed": False}).retry_failed
