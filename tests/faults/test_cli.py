"""Evidence for the command line when all is well, and for what it must not do: load much, or leave debris."""

import csv
import json
import os
import re
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import SampledModel, build
from orchestration import Component, Result, System, simulate
from orchestration.cli.app import app
from tests.faults.cli import Command

ADAPTIMP = Path(sysconfig.get_path("scripts")) / "adaptimp"
ESCAPES = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
HEAVY = ("numba", "casadi", "fmpy", "numpy", "scipy", "matplotlib", "lxml", "rich", "orchestration.master")
COMMANDS = [command.name or command.callback.__name__ for command in app.registered_commands if command.callback]


def test_run_writes_one_row_per_communication_point(adaptimp: Command, fig2: System, tmp_path: Path) -> None:
    outcome = adaptimp("run", "fig2", "--out", "new/fig2.csv")
    assert outcome.code == 0
    assert outcome.err == ""
    assert "order trajectory > sensor > controller > actuator > plant, step 0.0001 s" in outcome.out
    assert "wrote new/fig2.csv: 20001 rows" in outcome.out
    with (tmp_path / "new" / "fig2.csv").open(newline="") as file:
        header, *lines = csv.reader(file)
    result = simulate(fig2)
    assert header == ["time", *result.names]
    read = np.array(lines, dtype=float)
    assert read[:, 0].tobytes() == result.time.tobytes()
    assert np.ascontiguousarray(read[:, 1:]).tobytes() == result.rows.tobytes()


def test_options_do_what_the_library_does(adaptimp: Command, fig2: System, tmp_path: Path) -> None:
    order = ("plant", "actuator", "controller", "sensor", "trajectory")
    outcome = adaptimp(
        *("run", "fig2", "--set", "plant.K_f=5e4", "--set", "sensor.contact_gated=false"),
        *("--algorithm", "jacobi"),
        *("--order", ",".join(order), "--sample-time", "2e-4", "--stop", "0.1", "--out", "x.csv"),
        *("--record", "plant.x[1],controller.tau_cmd[2]"),
    )  # fmt: skip
    assert outcome.code == 0
    system = fig2.set({"plant.K_f": 5e4, "sensor.contact_gated": False}).with_sample_time(2e-4)
    result = simulate(system, 0.1, algorithm="jacobi", order=order)
    table = np.genfromtxt(tmp_path / "x.csv", delimiter=",", skip_header=1)
    np.testing.assert_array_equal(table[:, 1], result["plant.x[1]"])
    np.testing.assert_array_equal(table[:, 2], result["controller.tau_cmd[2]"])
    assert table.shape == (501, 3)


def columns(path: Path) -> list[str]:
    """Names of the columns of a CSV file, without time."""
    with path.open(newline="") as file:
        return next(csv.reader(file))[1:]


def test_names_arrays_and_patterns_are_recorded(adaptimp: Command, tmp_path: Path) -> None:
    """The option is repeatable, and the last one is not the only one."""
    outcome = adaptimp(
        *("run", "fig2", "--stop", "1e-3", "-o", "x.csv"),
        *("--record", "plant.x[2],plant.q", "--record", "controller.e*", "--record", "plant.x[2]"),
    )  # fmt: skip
    assert outcome.code == 0
    e = [f"controller.e[{i}]" for i in (1, 2)]
    assert columns(tmp_path / "x.csv") == ["plant.x[2]", "plant.q[1]", "plant.q[2]", *e]


def test_arrays_are_set_with_one_number_or_one_each(adaptimp: Command, fig2: System, tmp_path: Path) -> None:
    settings = ("--set", "controller.K=8000", "--set", "plant.m=[2, 1.5]")
    outcome = adaptimp("run", "fig2", "--stop", "0.01", *settings, "--record", "plant.x", "-o", "x.csv")
    assert outcome.code == 0
    expected = simulate(fig2.set({"controller.K": 8000.0, "plant.m": [2.0, 1.5]}), 0.01, record="plant.x")
    table = np.genfromtxt(tmp_path / "x.csv", delimiter=",", skip_header=1)
    np.testing.assert_array_equal(table[:, 1:], expected["plant.x"])
    refused = adaptimp("run", "fig2", "--set", "controller.K=[1,2,3]")
    assert refused.code == 2
    assert refused.sentence.startswith("controller.K has 2 elements, but 3 values are given")


def test_a_controller_is_named_by_its_model(adaptimp: Command) -> None:
    outcome = adaptimp("run", "fig2", "--stop", "1e-3", "--controller", "SlotineLiAdaptiveImpedance")
    assert outcome.code == 0
    assert "controller.s[1]" in outcome.out


def test_one_fmu_runs_alone(adaptimp: Command, fmu_folder: Path, tmp_path: Path) -> None:
    plant = fmu_folder / "Plant.fmu"
    outcome = adaptimp("run", plant, "--stop", "0.01", "--step", "1e-3", "--record", "Plant.x", "-o", "x.csv")
    assert outcome.code == 0
    assert "Plant.tau[1]" in outcome.err  # keeps its start value, as a warning says
    assert columns(tmp_path / "x.csv") == ["Plant.x[1]", "Plant.x[2]"]
    by_its_own = adaptimp("run", plant, "--json")  # for the time and with the step of its default experiment
    report = json.loads(by_its_own.out)
    suggested = Component.read(plant).description.experiment
    assert (by_its_own.code, report["step"], report["time"]) == (0, suggested.step, suggested.stop_time)


def test_version_and_short_help(adaptimp: Command) -> None:
    assert re.fullmatch(r"adaptimp \d+\.\d+\.\d+\n", adaptimp("--version").out)
    assert adaptimp("run", "-h").out == adaptimp("run", "--help").out != ""


def test_a_package_runs_like_its_scenario(adaptimp: Command, packages: dict[str, Path], tmp_path: Path) -> None:
    for system in ("fig2", packages["good"]):
        assert adaptimp("run", system, "--stop", "0.05", "--out", f"{Path(system).stem}.csv").code == 0
    assert (tmp_path / "fig2.csv").read_bytes() == (tmp_path / "good.csv").read_bytes()


def test_summary_names_every_signal(adaptimp: Command, fig2: System) -> None:
    outcome = adaptimp("run", "fig2", "--stop", "0.01")
    for component in fig2.components:
        for variable in component.description.of_causality("output"):
            assert f"{component.name}.{variable.name} " in outcome.out


def test_dropped_connections_are_told(adaptimp: Command, fmu_folder: Path, tmp_path: Path) -> None:
    same = fmu_folder / "HoganImpedance.fmu"
    outcome = adaptimp("run", "fig2", "--controller", same, "--stop", "0.01")
    assert (outcome.code, outcome.err) == (0, "")
    model = SampledModel("Limp", "A controller that does nothing")
    zero = model.parameter("zero", [0.0, 0.0], unit="N.m", description="Zero")
    model.output("tau_cmd", zero, unit="N.m", description="Commanded torque")
    limp = adaptimp("run", "fig2", "--controller", build(model, tmp_path), "--stop", "0.01")
    assert limp.code == 0
    values, connections = limp.err.splitlines()
    assert values.startswith("Notice: controller: start values dropped, Limp has no M[1], M[2], ")
    assert connections.startswith("Notice: controller: connections dropped, Limp has no input q[1], q[2], dq[1], ")


@pytest.mark.parametrize("arguments", [(), *((name,) for name in COMMANDS)])
def test_help(adaptimp: Command, arguments: tuple[str, ...]) -> None:
    outcome = adaptimp(*arguments, "--help")
    assert outcome.code == 0
    assert re.match(rf"Usage: .*{' '.join(('adaptimp', *arguments))} \[OPTIONS\]", outcome.out)
    assert "--help" in outcome.out
    assert outcome.err == ""


@pytest.mark.parametrize("arguments", [(), *((name,) for name in COMMANDS)])
def test_help_imports_nothing_heavy(arguments: tuple[str, ...]) -> None:
    code = (
        "import sys\n"
        "from orchestration.cli import main\n"
        f"sys.argv = {['adaptimp', *arguments, '--help']!r}\n"
        "try:\n    main()\n"
        f"finally:\n    print('loaded', [n for n in {HEAVY!r} if n in sys.modules])\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.endswith("loaded []\n")


@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGINT for another process")
@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_interrupt_keeps_the_rows_that_are_complete(tmp_path: Path, suffix: str) -> None:
    """Sent as soon as the progress bar shows, which the program draws between steps; the run has a minute to go."""
    slow = ["--set", "plant.dt_max=1e-7", "--stop", "200", "--no-verdict"]
    chosen = ["--record", "plant.x[1]", "--every", "10", "--out", f"long.{suffix}"]
    code, err = interrupted([ADAPTIMP, "run", "fig2", *slow, *chosen], tmp_path)
    assert code == 130  # as shells have it
    partial = f"long.partial.{suffix}"
    assert "Interrupted: the run was stopped.\n" in err
    assert f"wrote {partial}" in err
    assert [path.name for path in tmp_path.iterdir()] == [partial]
    result = Result.read(tmp_path / partial)
    assert result.time.tobytes() == (np.arange(len(result.time)) * 10 * 1e-4).tobytes()
    assert 1 < len(result.time) < 200_000
    assert np.isfinite(result["plant.x[1]"]).all()


def interrupted(command: Sequence[str | Path], folder: Path) -> tuple[int, str]:
    """Run a program that sees a terminal, and interrupt it when it shows that it is running.

    Returns
    -------
    tuple of int and str
        Exit code, and what the program wrote to its standard error.
    """
    terminal, end = os.openpty()
    with subprocess.Popen(
        command,
        cwd=folder,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "80"},
        stdout=subprocess.DEVNULL,
        stderr=end,
        # A shell starts what it puts into the background with SIGINT ignored, and children inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    ) as run:
        os.close(end)
        shown = said_until(terminal, b"running")
        run.send_signal(signal.SIGINT)
        shown += said_until(terminal)
    os.close(terminal)
    text = ESCAPES.sub("", shown.decode(errors="replace"))
    return run.returncode, text.replace("\r\n", "\n").replace("\r", "")


def said_until(terminal: int, word: bytes | None = None) -> bytes:
    """What a terminal is sent up to a word, without a word up to the end of the last program."""
    said = b""
    while word is None or word not in said:
        try:
            more = os.read(terminal, 4096)
        except OSError:  # Linux reports the end as an error
            more = b""
        if not more:
            assert word is None, f"the program ended without showing {word!r}: {said!r}"
            break
        said += more
    return said


def test_interrupt_before_the_first_step_is_said(adaptimp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("orchestration.cli.run.prepare", interrupted)
    outcome = adaptimp("run", "fig2")
    assert outcome.code == 130
    assert outcome.err == "Interrupted.\n"


def test_installed_command_explains_itself(tmp_path: Path) -> None:
    run = subprocess.run([ADAPTIMP, "run", "none.ssp"], cwd=tmp_path, capture_output=True, text=True, check=False)
    sentence = "Error: none.ssp: there is no such package; its folder has no .ssp file.\n"
    assert (run.returncode, run.stdout, run.stderr) == (2, "", sentence)
