"""The compiled loops give the same bits as the same source code without compilation.

Without compilation (NUMBA_DISABLE_JIT=1) every FMI call goes through ctypes, which knows the types of
C. A wrong type, address or count in the compiled calls would change numbers here.
"""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, System, simulate
from tests.reference.problems import PROBLEMS
from tests.unit.orchestration.runs import ALGORITHMS, at_zero, falling
from tests.unit.orchestration.small_models import mixed
from tests.unit.orchestration.small_models import system as make_system

ROOT = Path(__file__).parents[3]
STEPS = 200
IN_CONTACT = {
    "plant.wall_offset": -1.501,
    "trajectory.wall_offset": -1.501,
}  # m; the tip starts at -n.x = 1.5
ORACLE = """
import sys
import numba
import numpy as np
from orchestration import System, simulate
from orchestration.master.kernel import fixed_step
assert not hasattr(fixed_step.run, "signatures"), "the loop is compiled"
for name in sys.argv[3:]:
    system = System.read(f"{sys.argv[1]}/{name}.ssp")
    for algorithm in ("gauss-seidel", "jacobi"):
        result = simulate(system, int(sys.argv[2]) * system.step, algorithm=algorithm)
        np.save(f"{sys.argv[1]}/{name}-{algorithm}.npy", result.rows)
"""
GENERAL = [name for name, algorithm in ALGORITHMS.items() if not algorithm.plain]
SHORT = 24  # steps of the general loop, because this loop is slow without compilation
GENERAL_ORACLE = """
import sys
import numpy as np
from orchestration import Options, System, simulate
from orchestration.master.kernel import step_control
from orchestration.master.algorithm import *
from orchestration.master.options import Crossings
assert not hasattr(step_control.run, "signatures"), "the loop is compiled"
for name, algorithm, options in eval(sys.stdin.read()):
    system = System.read(f"{sys.argv[1]}/{name}.ssp")
    result = simulate(system, int(sys.argv[2]) * system.step, algorithm=algorithm, options=options)
    np.savez(f"{sys.argv[1]}/{name}-{algorithm.name}.npz", time=result.time, rows=result.rows)
"""


@pytest.fixture(scope="module")
def systems(fig2: System, small: dict[str, Path]) -> dict[str, System]:
    """Return three systems: Fig. 2 in contact from the start, all types of signals, and connections that scale."""
    plain = mixed(small)
    scaled = [replace(c, factor=-0.3, offset=0.1) if c.target == "plant" else c for c in plain.connections]
    return {"fig2": fig2.set(IN_CONTACT), "mixed": plain, "scaled": replace(plain, connections=tuple(scaled))}


@pytest.fixture(scope="module")
def oracle(systems: dict[str, System], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder with the rows that the short loop recorded without compilation."""
    folder = tmp_path_factory.mktemp("oracle")
    for name, system in systems.items():
        system.write(folder / f"{name}.ssp")
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "ADAPTIMP_CACHE": str(folder / "cache")}
    command = [sys.executable, "-c", ORACLE, str(folder), str(STEPS), *systems]
    run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return folder


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
@pytest.mark.parametrize("name", ["fig2", "mixed", "scaled"])
def test_compiled_loop_equals_its_source_bitwise(
    systems: dict[str, System], oracle: Path, name: str, algorithm: str
) -> None:
    system = systems[name]
    result = simulate(system, STEPS * system.run_step(), algorithm=algorithm)
    expected = np.load(oracle / f"{name}-{algorithm}.npy")
    assert expected.shape == (STEPS + 1, len(result.names))
    assert (np.ptp(expected, axis=0) > 0).sum() >= 5  # something moves
    assert result.rows.tobytes() == expected.tobytes()


def test_fig2_is_in_contact_here(systems: dict[str, System]) -> None:
    result = simulate(systems["fig2"], STEPS * systems["fig2"].run_step())
    assert np.abs(result["plant.F_ext[1]"]).max() > 1.0  # N; without contact the test above would see free motion only


@pytest.fixture(scope="module")
def general(fig2: System, small: dict[str, Path]) -> dict[str, tuple[System, Options]]:
    """Return two masses with feedback, all types of signals with a crossing, Fig. 2 in contact, and a time series."""
    pair = PROBLEMS["force-displacement"].system(5e-3, 1.0)
    return {
        "pair": (pair, Options()),
        "falling": (falling(small, steps=SHORT), at_zero()),
        "fig2": (fig2.set(IN_CONTACT), Options()),
        "driven": (
            make_system(small, {"a": "Integrator", "b": "Integrator"}, "a.x -> b.u", steps=SHORT),
            Options(inputs={"a.u": ([0.3 * k for k in range(11)], [(-1.0) ** k * k for k in range(11)])}),
        ),
    }


@pytest.fixture(scope="module")
def general_oracle(general: dict[str, tuple[System, Options]], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder with times and rows that the general loop recorded without compilation."""
    folder = tmp_path_factory.mktemp("general")
    for name, (system, _) in general.items():
        system.write(folder / f"{name}.ssp")
    jobs = [(name, ALGORITHMS[a], options) for name, (_, options) in general.items() for a in GENERAL]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "ADAPTIMP_CACHE": str(folder / "cache")}
    command = [sys.executable, "-c", GENERAL_ORACLE, str(folder), str(SHORT)]
    run = subprocess.run(
        command, cwd=ROOT, env=environment, input=repr(jobs), capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    return folder


@pytest.mark.parametrize("algorithm", GENERAL)
@pytest.mark.parametrize("name", ["pair", "falling", "fig2", "driven"])
def test_compiled_general_loop_equals_its_source_bitwise(
    general: dict[str, tuple[System, Options]], general_oracle: Path, name: str, algorithm: str
) -> None:
    system, options = general[name]
    result = simulate(system, SHORT * system.run_step(), algorithm=ALGORITHMS[algorithm], options=options)
    expected = np.load(general_oracle / f"{name}-{algorithm}.npz")
    assert len(expected["time"]) > SHORT / 4
    assert result.time.tobytes() == expected["time"].tobytes()
    assert result.rows.tobytes() == expected["rows"].tobytes()
