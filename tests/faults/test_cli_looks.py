"""Evidence that commands look right: help in sections, widths, encodings, what is said and what is not."""

import io
import json
import os
import re
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from fmus.catalog import MODELS
from fmus.catalog import VARIANTS as MODEL_VARIANTS
from orchestration import Result, System, simulate
from orchestration.cli.app import app
from orchestration.cli.codes import MEANINGS
from orchestration.master.algorithm import ALGORITHMS, SUMMARIES
from orchestration.paper.scenarios import ALL_SCENARIOS
from tests.faults.cli import Command

ADAPTIMP = Path(sysconfig.get_path("scripts")) / "adaptimp"
PAGE = Path(__file__).parents[2] / "docs" / "command-line.md"
COMMANDS = [command.name or command.callback.__name__ for command in app.registered_commands if command.callback]
SHORT = ("--stop", "1e-3")
SOME = ("--record", "plant.x,controller.e")


@pytest.mark.parametrize("columns", [60, 80, 120])
@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_help_fits_and_is_plain(
    adaptimp: Command, monkeypatch: pytest.MonkeyPatch, command: str | None, columns: int
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    text = adaptimp(*([command] if command else []), "--help").out
    assert text.isascii()
    assert "\x1b" not in text
    assert max(map(len, text.splitlines())) <= columns
    for section in ("Examples:", "Exit codes:", "Messages and help:"):
        assert text.count(f"\n{section}\n") == 1
    for code in MEANINGS:
        assert re.search(rf"^  {code.value} +\w", text, re.MULTILINE)


def test_options_of_run_stand_in_sections(adaptimp: Command) -> None:
    text = adaptimp("run", "--help").out
    places = [text.index(f"\n{name}:\n") for name in ("Arguments", "System", "Algorithm", "Time", "Rows", "Care")]
    assert places == sorted(places)
    assert "\nOptions:\n" not in text
    assert places[1] < text.index("--controller") < places[2] < text.index("--tolerance") < places[3]


def test_the_page_names_the_exit_codes_and_commands() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for code in MEANINGS:
        assert re.search(rf"^\| {code.value} \| ", text, re.MULTILINE)
    for command in COMMANDS:
        assert f"| `adaptimp {command}" in text


def test_list_names_everything_with_a_line(adaptimp: Command) -> None:
    text = adaptimp("list").out
    for name in (*ALL_SCENARIOS, *MODELS, *MODEL_VARIANTS, *ALGORITHMS):
        assert re.search(rf"^  {re.escape(name)} +\w.{{9}}", text, re.MULTILINE), name
    assert set(SUMMARIES) == set(ALGORITHMS)


def test_info_of_an_fmu(adaptimp: Command, fmu_folder: Path) -> None:
    outcome = adaptimp("info", fmu_folder / "HoganImpedance.fmu")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith("HoganImpedance: FMI 2.0 FMU for co-simulation\n")
    lines = [" ".join(line.split()) for line in outcome.out.splitlines()]
    assert "K[2] N/m 4000 Target stiffness" in lines
    assert "q[2] rad -0.722734, 1.44547 Angle of joint" in lines
    assert "tau_cmd[2] N.m Commanded torque of joint" in lines
    assert "p_hat[3] N.m.s/rad Estimated viscous friction of joint 1" in lines  # units and texts differ
    assert "default experiment start 0 s, stop 2 s, step 0.0001 s" in lines
    by_name = json.loads(adaptimp("info", "HoganImpedance", "--json").out)
    found = json.loads(adaptimp("info", fmu_folder / "HoganImpedance.fmu", "--json").out)
    assert by_name | {"file": ""} == found | {"file": ""}
    (stiffness,) = (v for v in found["variables"] if v["name"] == "K[2]")
    assert stiffness == {
        "name": "K[2]",
        "causality": "parameter",
        "variability": "tunable",
        "type": "Real",
        "unit": "N/m",
        "start": 4000.0,
        "min": stiffness["min"],
        "max": None,
        "description": "Target stiffness along x2 (up)",
    }
    carried = " ".join(outcome.out.split())
    assert "HoganImpedance.exp (experiment/smoke-test), HoganImpedance_in.csv (testcase)" in carried
    assert "fig2.ssv (parameter for fig2, fig3)" in carried
    assert found["references"][0]["file"] == "HoganImpedance.exp"
    assert found["notices"] == []


def test_info_of_an_fmu_whose_references_are_damaged(adaptimp: Command, fmu_folder: Path) -> None:
    """No tool needs the manifest of references, so the rest is shown."""
    with zipfile.ZipFile(fmu_folder / "Actuator.fmu") as whole, zipfile.ZipFile("x.fmu", "w") as damaged:
        for name in whole.namelist():
            damaged.writestr(name, b"<fmiReferences" if name.endswith("manifest.xml") else whole.read(name))
    outcome = adaptimp("info", "x.fmu")
    assert outcome.code == 0
    text = " ".join(outcome.out.split())
    assert "notice extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml is not" in text
    assert "tau_max[2] N.m" in text


def test_info_of_a_system(adaptimp: Command, packages: dict[str, Path], fig2: System) -> None:
    for name in ("fig2", packages["good"]):
        text = adaptimp("info", name).out
        lines = [" ".join(line.split()) for line in text.splitlines()]
        assert lines[0] == "System fig2: 5 components, 20 connections; stop 2 s, step 0.0001 s"
        assert "controller HoganImpedance every 0.0001 s 14 14 17" in lines
        assert "trajectory -> controller x_v, dx_v, ddx_v" in lines
        assert "plant.m[2] kg 2, 1" in lines
        assert "plant.q_start[2] rad -0.722734, 1.44547 assumed" in lines
    assert "sensor.F_ext[2]" in adaptimp("info", packages["loose"]).out
    found = json.loads(adaptimp("info", "fig2", "--json").out)
    assert found["connections"] == [str(connection) for connection in fig2.connections]
    assert found["experiment"] == {"start": 0.0, "stop": 2.0, "step": 1e-4}
    assert found["assumptions"] == dict(fig2.assumptions)


def test_info_says_the_value_of_each_element_that_differs(adaptimp: Command) -> None:
    lines = [" ".join(line.split()) for line in adaptimp("info", "puma").out.splitlines()]
    assert "plant.payload_inertia[6] kg.m2 0.002, 0, 0.002, 0, 0, 0.001 assumed" in lines
    assert "trajectory.wall_normal[3] 0, 0, -1 assumed" in lines


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_info_of_a_result(adaptimp: Command, suffix: str) -> None:
    assert adaptimp("run", "fig2", *SHORT, *SOME, "-o", f"x.{suffix}").code == 0
    text = adaptimp("info", f"x.{suffix}").out
    assert text.startswith(f"x.{suffix}: 11 rows, t = 0 to 0.001 s, 4 columns\n")
    assert re.search(r"^plant\.x\[2\] +(m +)?0 +0\.0031\d* +0\.0031", text, re.MULTILINE)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("fig22", r"fig22 is neither an \.fmu, .* did you mean fig2"),
        ("HoganImp", r"did you mean HoganImpedance"),
        ("x.csv", r"x\.csv: there is no such file of a result"),
        ("x.fmu", r"x\.fmu: there is no such FMU"),
        ("x.ssp", r"x\.ssp: there is no such package"),
    ],
)
def test_info_of_nothing(adaptimp: Command, name: str, said: str) -> None:
    outcome = adaptimp("info", name)
    assert outcome.code == 2
    assert re.search(said, outcome.sentence), outcome.sentence


def test_export_takes_what_run_takes(adaptimp: Command, fig2: System, tmp_path: Path, fmu_folder: Path) -> None:
    changes = ("--set", "controller.K=[4000,2000]", "--sample-time", "2e-4")
    swapped = ("--controller", "SlotineLiAdaptiveImpedance")
    outcome = adaptimp("export", "fig2", *changes, *swapped, "-o", "new/x.ssp")
    assert outcome.out.startswith("wrote new/x.ssp: 5 components, 22 connections, ")
    assert outcome.err.startswith("Notice: ")
    fmu = fmu_folder / "SlotineLiAdaptiveImpedance.fmu"
    expected = fig2.replace("controller", fmu).set({"controller.K": [4000.0, 2000.0]}).with_sample_time(2e-4)
    read = System.read(tmp_path / "new" / "x.ssp")
    assert [c.start for c in read.components] == [c.start for c in expected.components]
    assert (read.connections, read.step) == (expected.connections, 2e-4)
    for system in (("fig2", *changes, *swapped), ("new/x.ssp",)):
        assert adaptimp("run", *system, *SHORT, *SOME, "-o", f"{len(system)}.csv").code == 0
    assert (tmp_path / f"{1 + len(changes) + len(swapped)}.csv").read_bytes() == (tmp_path / "1.csv").read_bytes()
    assert adaptimp("export", "new/x.ssp", "-o", "y.ssp").code == 0
    assert adaptimp("export", "spong-ortega", "-o", "z.ssp").code == 0
    assert (
        "x.zip: the name does not say what to write; end it with one of .ssp, "
        in adaptimp("export", "fig2", "-o", "x.zip").sentence
    )
    assert "--map says what --controller" in adaptimp("export", "fig2", "--map", "a=b", "-o", "x.ssp").sentence


def test_export_of_a_scenario_with_reals_only(adaptimp: Command, tmp_path: Path) -> None:
    swapped = ("--controller", "SlotineLiAdaptiveImpedance")
    assert adaptimp("export", "fig5", "--reals", *swapped, "-o", "x.ssp").code == 0
    read = System.read(tmp_path / "x.ssp")
    assert read["controller"].description.model_name == "SlotineLiAdaptiveImpedance"
    assert {v.type for c in read.components for v in c.description.variables.values()} == {"Real"}
    for name in ("x.ssp", "plant.fmu"):
        outcome = adaptimp("export", name, "--reals", "-o", "y.ssp")
        assert outcome.code == 2
        assert outcome.sentence.startswith(
            f"--reals: {name} has FMUs of its own, and --reals is for scenarios such as fig5"
        )


def test_replacing_a_file_is_said(adaptimp: Command, tmp_path: Path) -> None:
    for said in ("wrote", "replaced"):
        for file in ("x.csv", "x.parquet"):
            assert f"\n{said} {file}: 11 rows" in adaptimp("run", "fig2", *SHORT, "-o", file).out
        failed = ("--set", "controller.K[1]=1e9", "--no-verdict", "-o", "bad.csv")
        assert f"{said} bad.partial.csv: the " in adaptimp("run", "fig2", *failed).err
        assert adaptimp("export", "fig2", "-o", "x.ssp").out.startswith(f"{said} x.ssp: ")
    code = "from adaptimp_fmu import SampledModel\nm = SampledModel('Gain', 'Multiplies')\n"
    code += "m.output('y', {} * m.input('u', 1.0, description='In'), description='Out')\n"
    for factor, end in ((2, "kB"), (2, "kB"), (3, "kB, replaced")):
        (tmp_path / "gain.py").write_text(code.format(factor), encoding="utf-8")
        assert adaptimp("build", "gain.py", "-o", ".").out.endswith(f"{end}\n")


def test_a_run_may_start_later(adaptimp: Command, tmp_path: Path) -> None:
    times = ("--start", "0.5", "--stop", "0.502")
    assert adaptimp("run", "fig2", *times, *SOME, "-o", "x.csv").code == 0
    time = Result.read(tmp_path / "x.csv").time
    assert (len(time), time[0], time[-1]) == (21, 0.5, 0.502)
    refused = adaptimp("run", "fig2", "--start", "3")
    assert (refused.code, refused.sentence) == (
        2,
        "The stop time 2 s is not after the start time 3 s; give a later stop time.",
    )


@pytest.mark.parametrize("place", ["before", "after"])
def test_quiet_verbose_and_debug_stand_anywhere(adaptimp: Command, place: str) -> None:
    def typed(option: str, *command: str) -> tuple[str, ...]:
        return (option, *command) if place == "before" else (*command, option)

    quiet = adaptimp(*typed("-q", "run", "fig2", *SHORT))
    assert (quiet.code, quiet.out, quiet.err, quiet.waits) == (0, "", "", "")
    assert "Error: There is no scenario" in adaptimp(*typed("--quiet", "run", "fig9")).err
    assert adaptimp(*typed("-q", "list")).out.startswith("Scenarios")
    verbose = adaptimp(*typed("-v", "run", "fig2", *SHORT))
    assert re.search(r"^Plant for \w+: the binary is in the cache, |^compiled Plant for ", verbose.err, re.MULTILINE)
    assert re.search(r"^unpacked .*Plant\.fmu of plant in \S+ s$", verbose.err, re.MULTILINE)
    assert re.search(r"^(loaded|compiled) the master's loop .*in \S+ s$", verbose.err, re.MULTILINE)
    both = adaptimp("--quiet", *typed("--verbose", "list"))
    assert (both.code, both.sentence) == (2, "--quiet and --verbose exclude each other; give one of them.")


def test_what_takes_long_is_said_but_steps_only_on_a_terminal(
    adaptimp: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("orchestration.cli.output.PROGRESS_AFTER", 0.0)
    outcome = adaptimp("run", "fig2", *SHORT, *SOME, "-o", "x.csv")
    assert (outcome.code, outcome.err) == (0, "")
    said = outcome.waits.splitlines()
    places = [
        next(i for i, line in enumerate(said) if line.startswith(begun))
        for begun in ("unpacking", "initializing", "compiling or loading the master's loop", "judging", "writing")
    ]
    assert places == sorted(places)
    assert "running" not in outcome.waits
    assert adaptimp("-q", "run", "fig2", *SHORT).waits == ""


def test_debug_shows_where_an_error_arose(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    from orchestration.cli import main

    for arguments in (["--debug", "run", "fig9"], ["run", "fig9", "--debug"]):
        monkeypatch.setattr(sys, "argv", ["adaptimp", *arguments])
        with pytest.raises(SystemExit) as exit_:
            main()
        out, err = capsys.readouterr()
        assert (exit_.value.code, out) == (2, "")
        assert err.startswith("Traceback (most recent call last):\n")
        assert err.endswith("\nError: There is no scenario fig9; did you mean fig7 or fig6 or fig5 or fig4?\n")


def test_a_fault_of_the_program_has_a_code_of_its_own(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from orchestration.cli import listing, main

    def broken(*, json: bool) -> None:
        raise ZeroDivisionError(json)

    monkeypatch.setattr(listing, "list_all", broken)
    monkeypatch.setattr(sys, "argv", ["adaptimp", "list"])
    with pytest.raises(SystemExit) as exit_:
        main()
    assert exit_.value.code == 3
    err = capsys.readouterr().err
    assert "ZeroDivisionError: False" in err
    assert err.endswith("Error: this is a fault of adaptimp; please report it with the lines above.\n")


@pytest.mark.parametrize("columns", [40, 60, 80, 120, None])
def test_no_number_of_a_summary_is_cut(
    adaptimp: Command, fig2: System, monkeypatch: pytest.MonkeyPatch, columns: int | None
) -> None:
    if columns is None:
        monkeypatch.delenv("COLUMNS", raising=False)
    else:
        monkeypatch.setenv("COLUMNS", str(columns))
    outcome = adaptimp("run", "fig2", *SHORT, *SOME)
    _, *lines, _ = outcome.out.splitlines()  # what is run, and how long it took
    words = " ".join(lines).split()
    result = simulate(fig2, 1e-3, record=["plant.x", "controller.e"])
    for name in result.names:
        numbers = [f"{x + 0.0:.6g}" for x in (result[name].min(), result[name].max(), result[name][-1])]
        assert {name, *numbers} <= set(words)
    if columns:
        assert max(map(len, lines)) <= columns


ENVIRONMENTS = {
    "ascii": {"PYTHONIOENCODING": "ascii"},
    "c": {"LC_ALL": "C"},
    "no-color": {"NO_COLOR": "1"},
    "narrow": {"COLUMNS": "60"},
}


@pytest.mark.parametrize("environment", ENVIRONMENTS)
def test_output_is_whole_in_any_environment(fmu_folder: Path, environment: str) -> None:
    """In a process, as streams take their encoding from the environment."""
    env = {k: v for k, v in os.environ.items() if k not in ("LANG", "LC_ALL", "COLUMNS")} | ENVIRONMENTS[environment]
    for command in (["check", fmu_folder / "Plant.fmu"], ["info", fmu_folder / "Plant.fmu"]):
        run = subprocess.run([ADAPTIMP, *command], env=env, capture_output=True, check=False)
        assert (run.returncode, b"\x1b" in run.stdout) == (0, False), run.stderr
        assert b"Plant" in run.stdout
    assert run.stdout.isascii()


def test_characters_that_a_stream_lacks_are_escaped(
    adaptimp: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = "from adaptimp_fmu import SampledModel\nm = SampledModel('Gain', 'Multiplies')\n"
    code += "m.output('y', 2 * m.input('u', 1.0, description='Größe in µ'), description='Out')\n"
    (tmp_path / "gain.py").write_text(code, encoding="utf-8")
    assert adaptimp("build", "gain.py", "-o", ".").code == 0
    raw = io.BytesIO()
    stream = io.TextIOWrapper(raw, encoding="ascii", write_through=True)
    monkeypatch.setattr(sys, "argv", ["adaptimp", "info", "Gain.fmu"])
    monkeypatch.setattr(sys, "stdout", stream)
    from orchestration.cli import main

    with pytest.raises(SystemExit) as exit_:
        main()
    assert exit_.value.code == 0
    assert rb"Gr\xf6\xdfe in \xb5" in raw.getvalue()


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("adaptimp in", {"info"}),
        ("adaptimp run fig", {name for name in ALL_SCENARIOS if name.startswith("fig")}),
        ("adaptimp run fig2 --algorithm n", {"newton"}),
        (
            "adaptimp run fig2 --controller Hog",
            {"HoganImpedance", *(name for name in MODEL_VARIANTS if name.startswith("Hogan"))},
        ),
        ("adaptimp run fig2 --set pl", {"plant."}),
        ("adaptimp run fig2 --set plant.K", {"plant.K_f="}),
        ("adaptimp run fig2 --record controller.tau", {f"controller.tau_cmd{i}" for i in ("", "[1]", "[2]")}),
        ("adaptimp run fig2 --record plant.x,plant.ga", {"plant.x,plant.gap"}),
        ("adaptimp run sensor-stuck --set sensor.failure_d", {"sensor.failure_duration="}),
        ("adaptimp run here.ssp --set sensor.se", {"sensor.seed="}),
        ("adaptimp run her", {"here.ssp"}),
        ("adaptimp info Pl", {"Plant", "Plant3R", *(name for name in MODEL_VARIANTS if name.startswith("Plant"))}),
        ("adaptimp run broken.ssp --set a", set()),
        ("adaptimp new c", {"controller"}),
        ("adaptimp new controller Mine --from s", {"slotine-li", "spong-ortega"}),
        ("adaptimp cache c", {"clear"}),
        ("adaptimp cache clear ker", {"kernel"}),
    ],
)
def test_completion(
    adaptimp: Command,
    packages: dict[str, Path],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    typed: str,
    offered: set[str],
) -> None:
    (tmp_path / "here.ssp").write_bytes(packages["good"].read_bytes())
    (tmp_path / "broken.ssp").write_text("text")
    monkeypatch.setenv("_ADAPTIMP_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - 1))
    assert set(adaptimp().out.split()) == offered


def test_the_script_for_the_shell_is_shown(adaptimp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION", "1")
    text = adaptimp("--help").out
    assert "--install-completion" in text
    assert "--show-completion" in text
