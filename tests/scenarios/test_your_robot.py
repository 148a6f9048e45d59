"""docs/your-robot.md, followed literally: from a URDF file to FMUs, a contact task, and another controller."""

from pathlib import Path

import numpy as np
import pytest

from orchestration import Result, System
from tests.scenarios.pages import ROOT
from tests.scenarios.tutorial import Printed, blocks, follow

PAGE = ROOT / "docs" / "your-robot.md"
SHOWN = [block.line for block in blocks(PAGE) if block.kind == "text"]
PAYLOAD = 0.8  # kg, as the page says
UNITS = {
    *("VirtualTrajectory", "ForceSensor", "HoganImpedance", "CraigAdaptiveImpedance", "SlotineLiAdaptiveImpedance"),
    *("SpongOrtegaAdaptiveImpedance", "Actuator", "Plant"),
}


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[int, Printed]]:
    """The reader's folder when all is done, and what was printed, by line of the page."""
    folder = tmp_path_factory.mktemp("reader")
    return folder / "mine", {printed.line: printed for printed in follow(PAGE, folder)}


@pytest.mark.parametrize("line", SHOWN)
def test_commands_print_what_the_page_shows(followed: tuple[Path, dict[int, Printed]], line: int) -> None:
    printed = followed[1][line]
    assert printed.agree, f"{PAGE.name}, line {line}, shows\n{printed.shown}\nand the commands print\n{printed.real}"


def test_the_lines_of_python_do_what_the_page_says(
    followed: tuple[Path, dict[int, Printed]], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(followed[0])
    (code,) = [block for block in blocks(PAGE) if block.kind == "python"]
    names: dict[str, object] = {}
    exec(compile("\n" * code.line + code.text, str(PAGE), "exec"), names)
    assert capsys.readouterr().out == (
        "('joint waist', 'joint shoulder', 'joint elbow') [120.0, 120.0, 80.0, 30.0, 30.0, 20.0]\n"
    )
    for dotted in ("robot.arm.inertia", "robot.joints.efforts"):
        assert eval(dotted, names) is not None


def test_the_folder_has_the_units_and_a_package_of_five(followed: tuple[Path, dict[int, Printed]]) -> None:
    folder = followed[0] / "arm"
    assert {path.stem for path in folder.glob("*.fmu")} == {f"{unit}Arm6" for unit in UNITS}
    assert max(path.stat().st_size for path in folder.glob("*.fmu")) < 1e6
    system = System.read(folder / "Arm6.ssp")
    assert [component.name for component in system.components] == [
        "trajectory", "sensor", "controller", "actuator", "plant",
    ]  # fmt: skip
    assert system.unconnected_inputs() == []
    assert (system.step, system.stop_time) == (1e-4, 2.0)
    assert np.asarray(system["actuator"]["tau_max"]).tolist() == [120, 120, 80, 30, 30, 20]
    assert system["plant"]["payload_mass"] == PAYLOAD
    assert not np.asarray(system["controller"]["p_start"])[-10:].any()


def test_the_tool_slides_across_the_table_and_its_mass_is_found(followed: tuple[Path, dict[int, Printed]]) -> None:
    run, hogan = (Result.read(followed[0] / "arm" / f"{name}.parquet") for name in ("run", "hogan"))
    for result, largest in ((run, 1e-3), (hogan, 5e-3)):
        force = result["plant.F_ext"][:, 2]
        touching = force != 0
        assert force.min() > -80
        assert force.max() == 0  # the table pushes only: the tip's force on it points down
        assert 0.2 < np.count_nonzero(touching) * 1e-4 < 0.4
        assert not touching[0]
        assert not touching[-1]
        path = result["plant.x"][touching, 1]
        assert np.ptp(path) > 0.1  # m, along the table
        error = np.linalg.norm(result["controller.e"][:, :3], axis=1)
        assert error.max() < largest
        assert not result["actuator.saturated"].any()
    assert run["controller.p_hat"][-1, -10] == pytest.approx(PAYLOAD, abs=2e-3)
    unloaded = np.linalg.norm(run["controller.e"][-1, :3])
    assert unloaded < np.linalg.norm(hogan["controller.e"][-1, :3]) / 20
