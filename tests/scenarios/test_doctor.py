"""Evidence that an examination names the culprit of known faults, and that its commands mend them."""

import shlex
from pathlib import Path

import pytest

from orchestration import Connection, Diagnosis, Finding, System, diagnose, scenario, simulate
from orchestration.analysis.doctor.finding import Severity
from orchestration.cli.settings import start_value
from tests.faults.cli import Command, runner
from tests.reference.problems import PROBLEMS, wall
from tests.scenarios import clinic
from tests.sharing import made_once

WITHOUT_LIMIT = 600.0  # s; every study is complete, however busy the machine is


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the five packages of `clinic`."""
    return made_once(tmp_path_factory, "clinic", clinic.write)


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command line."""
    return runner(monkeypatch, capsys)


def found(diagnosis: Diagnosis, id_: str) -> Finding:
    finding = diagnosis.of(id_)
    assert finding is not None, str(diagnosis)
    return finding


def examined(system: System | Path, *arguments: float, **options: object) -> Diagnosis:
    return diagnose(system, *arguments, budget=WITHOUT_LIMIT, **options)  # type: ignore[arg-type]


def prescribed(packages: Path, name: str, kind: str, adaptimp: Command, monkeypatch: pytest.MonkeyPatch) -> str:
    """The command that an examination of a package prescribes against a finding; it runs as it is."""
    import json

    monkeypatch.chdir(packages)
    outcome = adaptimp("doctor", f"{name}.ssp", "--json", "--budget", WITHOUT_LIMIT)
    assert outcome.code == 1
    command = next(f["command"] for f in json.loads(outcome.out)["findings"] if f["id"] == kind)
    words = shlex.split(command)
    assert words[:3] == ["adaptimp", "run", f"{name}.ssp"]
    assert adaptimp(*words[1:], "--no-verdict", "-q").code == 0
    return command


@pytest.mark.parametrize("name", ["fig2", "fig5"])
def test_the_figures_are_healthy(name: str) -> None:
    diagnosis = examined(scenario(name))
    assert diagnosis.healthy, str(diagnosis)
    assert diagnosis.signals


def test_chatter_is_no_error_and_has_no_order() -> None:
    finding = found(examined(scenario("fig5")), "no-order")
    assert {"controller.F_c[1]", "controller.tau_cmd[1]"} <= set(finding.figures["signals"])
    assert not any(name.startswith(("trajectory.", "plant.x")) for name in finding.figures["signals"])


def test_a_jacobi_loop_at_2_ms_has_its_culprit_and_a_cure() -> None:
    system = scenario("fig5").with_sample_time(2e-3)
    diagnosis = examined(system, algorithm="jacobi")
    finding = found(diagnosis, "stability")
    assert finding.severity is Severity.ERROR
    assert finding.subject.startswith("plant.dq")
    assert "controller.dq" in finding.sentence
    assert found(diagnosis, "run").severity is Severity.ERROR
    assert finding.command.startswith("simulate(system")
    # Gauss-Seidel at this step is stable at first, and diverges at the wall: the advice has been tried.
    assert finding.command != "simulate(system, stop_time=2, step=0.002)"
    assert eval(finding.command, {"simulate": simulate, "system": system}).status == "complete"
    assert found(diagnosis, "delays").command == "", "what was not tried is no advice beside an error"


def test_a_run_that_diverges_later_has_a_shorter_step() -> None:
    system = scenario("fig5").with_sample_time(2e-3)
    diagnosis = examined(system)
    assert found(diagnosis, "stability").severity is Severity.NOTE  # stable at the start, before the wall
    finding = found(diagnosis, "run")
    assert finding.severity is Severity.ERROR
    assert 0.9 < finding.figures["until"] < 1.0  # s; the arm meets the wall at 0.94 s
    assert eval(finding.command, {"simulate": simulate, "system": system}).status == "complete"


def test_two_masses_with_the_step_doubled_have_their_culprit() -> None:
    graded = {}
    for step in (1e-2, 2e-2):
        system = PROBLEMS["force-displacement"].system(step, 1.0)
        diagnosis = examined(system)
        graded[step] = found(diagnosis, "stability")
        assert graded[step].subject == "right.F"
        assert found(diagnosis, "energy").subject == "right.F"
    # 0.25 to 0.75 k h^2 / m a step: the growth over a run is in proportion to the step, 3.9 % at 10 ms.
    growths = [finding.figures["growth"] for finding in graded.values()]
    assert growths[1] == pytest.approx(2 * growths[0], rel=0.2)


def test_an_undamped_spring_is_no_alarm() -> None:
    finding = found(examined(wall.system(1e-4, 1.0, m=1.0, k=100.0)), "stability")
    assert finding.severity is Severity.NOTE
    assert "0.25 %" in finding.sentence  # k h / 4 m per second
    worse = found(examined(wall.system(2e-2, 1.0, m=1.0, k=100.0)), "stability")
    assert worse.severity is Severity.WARNING
    assert "order=2" in worse.command


@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_a_prediction_that_the_run_does_not_bear_out_is_a_note(step: float) -> None:
    springs = [Connection("arm", f"q[{i}]", "arm", f"tau[{i}]", factor=-200.0) for i in (1, 2)]  # N.m/rad
    arm = System.of({"arm": scenario("fig2")["plant"]}).connect(*springs)
    verdict = arm.stability(step)
    assert not verdict.stable  # the linear prediction alone would be an alarm
    assert verdict.hidden == ("arm",)
    finding = found(examined(arm, 1.0, step), "stability")
    assert finding.severity is Severity.NOTE
    assert "does not bear that out" in finding.sentence
    assert "arm moves so fast" in finding.sentence


def test_a_damper_that_diverges_is_borne_out() -> None:
    diagnosis = examined(PROBLEMS["damper pair"].system(1e-2, 1.0))
    assert found(diagnosis, "stability").severity is Severity.ERROR
    assert "nothing in common" in found(diagnosis, "accuracy").sentence
    assert diagnosis.of("energy") is None


def test_a_difference_that_is_taken_for_a_temperature(packages: Path) -> None:
    diagnosis = examined(packages / "thermal.ssp")
    finding = found(diagnosis, "relative-quantity")
    assert (finding.severity, finding.subject) == (Severity.WARNING, "room.T")
    assert "room.T is declared as a difference" in finding.sentence
    assert "thermostat.T as an absolute value" in finding.sentence


def test_an_amplifier_before_its_controller(packages: Path, adaptimp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    command = prescribed(packages, "drive", "delays", adaptimp, monkeypatch)
    order = ("controller", "amplifier", "motor")
    assert command == f"adaptimp run drive.ssp --order {','.join(order)}"
    finding = found(examined(packages / "drive.ssp"), "delays")
    assert finding.subject == "controller.u"
    assert finding.figures["late"] == ["controller.u -> amplifier.u_cmd"]
    assert examined(packages / "drive.ssp", order=order).of("delays") is None


def test_a_step_that_divides_no_period(packages: Path, adaptimp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    assert prescribed(packages, "sampled", "sampling-period", adaptimp, monkeypatch).endswith("--step 0.001")
    diagnosis = examined(packages / "sampled.ssp")
    finding = found(diagnosis, "sampling-period")
    assert (finding.severity, finding.subject) == (Severity.ERROR, "controller.sample_time")
    assert diagnosis.signals  # the rest is examined with the step that fits
    assert examined(packages / "sampled.ssp", 0.5, 1e-3).of("sampling-period") is None


def test_a_tyre_that_is_too_stiff(packages: Path, adaptimp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    command = prescribed(packages, "quarter-car", "stiffness", adaptimp, monkeypatch)
    system = System.read(packages / "quarter-car.ssp")
    before = examined(system)
    assert found(before, "stiffness").subject == "wheel.dt_max"
    assert "k_t = 4e+07 N/m on m = 40 kg" in found(before, "stiffness").sentence
    name, value = start_value(shlex.split(command)[-1])
    after = examined(system.set({name: value}))
    assert after.of("stiffness") is None


def test_two_tanks_that_answer_at_once(packages: Path, adaptimp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    command = prescribed(packages, "two-tanks", "algebraic-loop", adaptimp, monkeypatch)
    assert command.endswith("--algorithm newton")
    diagnosis = examined(packages / "two-tanks.ssp")
    finding = found(diagnosis, "algebraic-loop")
    assert finding.severity is Severity.WARNING
    assert set(finding.figures["signals"]) == {"left.p", "right.p", "pipe.q_1", "pipe.q_2"}
    assert found(diagnosis, "energy").subject == "left.p"
    solved = examined(packages / "two-tanks.ssp", algorithm="newton")
    assert found(solved, "algebraic-loop").severity is Severity.NOTE
    worst = [max(signal.relative for signal in d.signals) for d in (diagnosis, solved)]
    assert worst[1] < worst[0]
