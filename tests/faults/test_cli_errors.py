"""Evidence that the command line explains what is wrong: one sentence, no traceback, no debris.

Exit code 2 says that the request cannot be carried out as it stands, start values that an FMU refuses
included; 1 that a run failed on its way; 0 success.
"""

import re
from pathlib import Path

import pytest

from orchestration import System
from tests.faults.cli import Command

SHORT = ("--stop", "0.01")

BAD_SETTINGS = {
    "plant.stiffness=1": r"plant has no variable stiffness; there are dt_max, q_start, dq_start, m and 20 more",
    "arm.K_f=1": r"System fig2 has no component arm; there are trajectory, sensor, controller, actuator, plant",
    "K_f=1": r"'K_f' is not of the form component\.variable, such as plant\.K_f\.",
    "plant.K_f": r"--set plant\.K_f: COMPONENT\.VARIABLE=VALUE is needed, such as",
    "plant.q[1]=0": r"plant\.q\[1\] has causality output; only parameters, inputs and initial states can be set; ",
    "plant.K_f=hard": r"plant\.K_f = 'hard': a plain number in N/m is needed, without a unit\.",
    "plant.K_f=": r"plant\.K_f = '': a plain number in N/m is needed, without a unit\.",
    "sensor.seed=0.5": r"sensor\.seed = '0\.5': an integer of 32 bits is needed, ",
    "sensor.seed=1e12": r"sensor\.seed = '1e12': an integer of 32 bits is needed, ",
    "sensor.contact_gated=2": r"sensor\.contact_gated = '2': true or false is needed, ",
    "plant.q_start[1]=nan": r"plant\.q_start\[1\] = 'nan': a plain number in rad is needed",
    "plant.tau[1]=NaN": r"plant\.tau\[1\] = 'NaN': a plain number in N\.m is needed",  # though a connection drives it
    "sensor.sample_time=nan": r"sensor\.sample_time = 'nan': a plain number in s is needed",
    "sensor.sample_time=0": r"sensor: sample time 0 s is not positive; use 0\.0001 s, the step\.",
    "sensor.sample_time=1.5e-4": r"sensor: sample time 0\.00015 s is not a multiple of the step 0\.0001 s; use ",
    "plant.q_start[2]=0": r'controller: fmi2ExitInitializationMode .* message: "The arm is singular: .*"\.',
    "plant.K_f=-1": r'plant: fmi2SetReal returned fmi2Error; .* message: ".*K_f = -1 must be at least 0 N/m',
    "plant.m[1]=inf": r"plant: fmi2SetReal returned fmi2Error; .*m\[1\] = inf is not finite",
    "trajectory.period=0": r"trajectory: fmi2SetReal returned fmi2Error; .*period = 0 must be at least 1e-12 s",
}
BAD_OPTIONS = {
    "fig2 --step 3e-4": r"trajectory: sample time 0\.0001 s is not a multiple of the step 0\.0003 s; use",
    "fig2 --step 0": r"The step is 0 s; it must be positive\.",
    "fig2 --step nan": r"The step is nan; give a finite number, in s\.",
    "fig2 --step small": r"Invalid value for '--step': .*number",
    "fig2 --step 1e-4 --sample-time 1e-4": r"--step and --sample-time exclude each other",
    "fig2 --stop 0.00015": r"from 0 s to 0\.00015 s is not a multiple of the step 0\.0001 s; stop at 0\.0001 s",
    "fig2 --stop -1": r"The stop time -1 s is not after the start time 0 s; give a later stop time",
    "fig2 --stop 0": r"The stop time 0 s is not after the start time 0 s; give a later stop time",
    "fig2 --stop nan": r"The stop time is nan; give a finite number, in s",
    "fig2 --stop 1e9": r"System fig2: 1e\+13 steps need 80 TB of memory, the machine has .*; use a larger step",
    "fig2 --step 1e-10": r"System fig2: 2e\+10 steps need 160 GB of memory, the machine has",
    "fig2 --algorithm adaptive --absolute m2=1e-3": r"absolute tolerance in m2 does nothing: the units .* are m, m/s",
    "fig2 --controller missing.fmu": r"missing\.fmu: there is no such FMU; its folder has no \.fmu file\.",
    "missing.ssp": r"missing\.ssp: there is no such package; its folder has no \.ssp file\.",
    "fig1": r"There is no scenario fig1; did you mean fig",
    "fig2 --algorithm euler": r"There is no algorithm 'euler'; there are gauss-seidel, jacobi",
    "fig2 --order plant,sensor": r"order plant, sensor must name each of trajectory, sensor, controller, act",
    "fig2 --record plant.energy": r"plant has no variable energy; there are ",
    "fig2 --record plant.tau*": r"record: no output fits 'plant\.tau\*'",
    "fig2 --out fig2.xlsx": r"fig2\.xlsx: results are written as \.csv or \.parquet",
    "fig2 --exchange both": r"no exchange 'both'; there are sequential, parallel",
    "fig2 --input-order 3": r"order 3 of the inputs is not 0, 1 or 2",
    "fig2 --tolerance 1e-6": r"Algorithm gauss-seidel has no tolerance; iterative, newton and adaptive have",
    "fig2 --algorithm newton --tolerance 0": r"The relative tolerance is 0; it must be positive",
    "fig2 --algorithm adaptive --absolute m=x": r"--absolute: 'x' is not a number",
    "fig2 --algorithm adaptive --absolute m": r"--absolute m: NAME=VALUE is needed",
    "fig2 --every 0": r"every = 0: every n-th step",
    "fig2 --crossing plant.tau[1]": r"plant\.tau\[1\] is a Real of causality input; crossings need a Real output",
    "fig2 --ratio sensor=5": r"sensor: steps of 5 communication steps must fit its sample time",
    "fig2 --ratio sensor=half": r"--ratio: 'half' is not an integer",
    "fig2 --ratio robot=2": r"no component robot; there are trajectory, sensor",
    "fig2 --algorithm newton --ratio sensor=1 --ratio plant=2": r"Steps of several lengths do not go together",
    "fig2 --fast": r"No such option: --fast",
    "": r"Missing argument",
}


@pytest.mark.parametrize("setting", BAD_SETTINGS)
def test_bad_start_values(adaptimp: Command, tmp_path: Path, setting: str) -> None:
    outcome = adaptimp("run", "fig2", "--set", setting, "--out", "x.csv")
    assert re.search(BAD_SETTINGS[setting], outcome.sentence), outcome.sentence
    assert outcome.code == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("options", BAD_OPTIONS)
def test_bad_options(adaptimp: Command, tmp_path: Path, options: str) -> None:
    outcome = adaptimp("run", *options.split())
    assert re.search(BAD_OPTIONS[options], outcome.sentence), outcome.sentence
    assert outcome.code == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "pattern"),
    [
        (
            ("build", "--platform", "amiga"),
            r"There is no platform amiga; there are linux64, win64, .*, aarch64-darwin, all\.",
        ),
        (("simulate",), r"No such command 'simulate'"),
    ],
)
def test_other_bad_requests(adaptimp: Command, tmp_path: Path, arguments: tuple[str, ...], pattern: str) -> None:
    outcome = adaptimp(*arguments)
    assert re.match(pattern, outcome.sentence), outcome.sentence
    assert outcome.code == 2
    assert not list(tmp_path.iterdir())


def test_file_that_is_no_archive(adaptimp: Command, tmp_path: Path) -> None:
    (tmp_path / "notes.fmu").write_text("text")
    outcome = adaptimp("run", "fig2", "--controller", "notes.fmu")
    assert re.search(r"notes\.fmu is not a readable zip archive", outcome.sentence)
    assert outcome.code == 2


def test_controller_that_commands_nothing(adaptimp: Command, fmu_folder: Path) -> None:
    outcome = adaptimp("run", "fig2", "--controller", fmu_folder / "ForceSensor.fmu")
    assert re.match(
        r"ForceSensor\.fmu looks like sensor, not like controller: it has no output tau_cmd", outcome.sentence
    )
    assert outcome.code == 2


def test_unconnected_input(adaptimp: Command, packages: dict[str, Path]) -> None:
    warned = adaptimp("run", packages["loose"], *SHORT)
    assert warned.code == 0
    sentence = "Unconnected inputs keep their start values: sensor.F_ext[2]."
    assert warned.err.strip() == f"Warning: {sentence}"
    refused = adaptimp("run", packages["loose"], *SHORT, "--strict")
    assert (refused.code, refused.sentence) == (2, f"{sentence} Connect them, or run without strict.")
    assert adaptimp("run", packages["good"], *SHORT, "--strict").err == ""


def test_units_that_differ(adaptimp: Command, packages: dict[str, Path]) -> None:
    outcome = adaptimp("run", packages["units"], *SHORT)
    assert outcome.sentence == "Connection plant.x[1] -> sensor.F_ext[1]: units m and N differ."
    assert outcome.code == 2


@pytest.mark.parametrize("place", ["file.txt/x.csv", "folder.csv", "/proc/none/x.csv"])
def test_places_that_cannot_be_written(adaptimp: Command, tmp_path: Path, place: str) -> None:
    (tmp_path / "file.txt").write_text("mine")
    (tmp_path / "folder.csv").mkdir()
    outcome = adaptimp("run", "fig2", *SHORT, "--out", place)
    assert re.search(r"nothing can be written to \S+: .*; choose|folder\.csv is a folder", outcome.sentence)
    assert outcome.code == 2
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["file.txt", "folder.csv"]


@pytest.mark.parametrize("command", ["build", "paper"])
def test_folders_that_cannot_be_written(adaptimp: Command, tmp_path: Path, command: str) -> None:
    (tmp_path / "file.txt").write_text("mine")
    outcome = adaptimp(command, "--out", "file.txt/out")
    assert re.search(r"^--out: nothing can be written to file\.txt/out: ", outcome.sentence)
    assert outcome.code == 2


def test_failed_run_keeps_its_rows_apart(adaptimp: Command, tmp_path: Path) -> None:
    outcome = adaptimp("run", "fig2", "--set", "controller.K[1]=1e9", "--out", "x.csv")
    found = re.fullmatch(
        r'plant: fmi2DoStep returned fmi2Error at t = (\S+) s \(step (\d+)\); .* message: ".*diverge.*"\.',
        outcome.sentence,
    )
    assert found
    assert outcome.code == 1
    step = int(found[2])
    assert float(found[1]) == pytest.approx(step * 1e-4, rel=1e-8)  # printed with nine digits
    assert [p.name for p in tmp_path.iterdir()] == ["x.partial.csv"]
    lines = (tmp_path / "x.partial.csv").read_text().splitlines()
    assert len(lines) == step + 2  # names, rows 0 to `step`
    assert f"wrote x.partial.csv: the {step + 1} rows before the failure" in outcome.err


def test_a_package_without_step_or_stop_time(adaptimp: Command, fmu_folder: Path, tmp_path: Path) -> None:
    """As packages of other tools are; what is missing is asked for, and then the run is made."""
    System.connected_by_name("lone", {"plant": fmu_folder / "Plant.fmu"}).write(tmp_path / "lone.ssp")
    outcome = adaptimp("run", "lone.ssp", *SHORT)
    assert (outcome.code, outcome.sentence) == (
        2,
        "System lone has no communication step; give one, in s, as `step` or --step.",
    )
    outcome = adaptimp("run", "lone.ssp", "--step", "1e-3")
    assert (outcome.code, outcome.sentence) == (
        2,
        "System lone has no stop time; give one, in s, as `stop_time` or --stop.",
    )
    assert adaptimp("run", "lone.ssp", "--step", "1e-3", *SHORT).code == 0
