"""Evidence for the compiled loop: the same source, not compiled, gives the same bits.

Without compilation (NUMBA_DISABLE_JIT=1) every FMI call goes through ctypes, which knows the C
types; a wrong type, address or count in the compiled calls would change numbers here.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from orchestration import System, simulate
from tests.unit.orchestration.units import mixed

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
from orchestration import System, loop, simulate
assert not hasattr(loop.run, "signatures"), "the loop is compiled"
for name in sys.argv[3:]:
    system = System.read(f"{sys.argv[1]}/{name}.ssp")
    for algorithm in ("gauss-seidel", "jacobi"):
        result = simulate(system, int(sys.argv[2]) * system.step, algorithm=algorithm)
        np.save(f"{sys.argv[1]}/{name}-{algorithm}.npy", result.rows)
"""


@pytest.fixture(scope="module")
def systems(fig2: System, small: dict[str, Path]) -> dict[str, System]:
    """Fig. 2 in contact from the start, and all types of signals."""
    return {"fig2": fig2.set(IN_CONTACT), "mixed": mixed(small)}


@pytest.fixture(scope="module")
def oracle(systems: dict[str, System], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the rows that the plain Python loop recorded."""
    folder = tmp_path_factory.mktemp("oracle")
    for name, system in systems.items():
        system.write(folder / f"{name}.ssp")
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "ADAPTIMP_CACHE": str(folder / "cache")}
    command = [sys.executable, "-c", ORACLE, str(folder), str(STEPS), *systems]
    run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return folder


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
@pytest.mark.parametrize("name", ["fig2", "mixed"])
def test_compiled_loop_equals_its_source_bitwise(
    systems: dict[str, System], oracle: Path, name: str, algorithm: str
) -> None:
    system = systems[name]
    result = simulate(system, STEPS * system.step, algorithm=algorithm)
    expected = np.load(oracle / f"{name}-{algorithm}.npy")
    assert expected.shape == (STEPS + 1, len(result.names))
    assert (np.ptp(expected, axis=0) > 0).sum() >= 5  # something moves
    assert result.rows.tobytes() == expected.tobytes()


def test_fig2_is_in_contact_here(systems: dict[str, System]) -> None:
    result = simulate(systems["fig2"], STEPS * systems["fig2"].step)
    assert np.abs(result["plant.F_ext[1]"]).max() > 1.0  # N; else the test above sees free motion only
