"""Fixtures: Fig. 5, the run of it with conventional control, and the foreign controllers."""

from pathlib import Path

import pytest

from orchestration import Options, Result, System, simulate
from orchestration.paper.scenarios import AT_FIRST
from tests.interop.foreign.builders import hand_written, without_compiler


@pytest.fixture(scope="session")
def fig5(fmu_folder: Path) -> System:
    """The system of Fig. 5 at the earlier calibration: noise, a wrong mass, contact."""
    scenario = AT_FIRST["fig5-first"]
    return scenario.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in scenario.models.values()})


@pytest.fixture(scope="session")
def conventional(fig5: System, fmu_folder: Path) -> Result:
    """Fig. 5 with our own conventional controller."""
    system = fig5.replace("controller", fmu_folder / "HoganImpedance.fmu")
    columns = ("plant.q", "plant.dq", "plant.x", "plant.F_ext", "controller.tau_cmd")
    return simulate(system, options=Options(record=[f"{name}[{i}]" for name in columns for i in (1, 2)]))


@pytest.fixture(scope="session")
def right(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The hand-written controller without a mistake."""
    if why := without_compiler():
        pytest.skip(why)
    return hand_written(tmp_path_factory.mktemp("right"))
