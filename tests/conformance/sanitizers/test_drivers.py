"""Plain runs of all FMUs under the sanitizers, in threads, and under valgrind."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.conformance.container import CONTAINER
from tests.conformance.sanitizers.compiling import SANITIZERS, STRICT, Fault, compile_driver, require_clang, unpack
from tests.untested import needs

VALGRIND = ("valgrind", "--quiet", "--leak-check=full", "--show-leak-kinds=all", "--error-exitcode=99")
# What the tests below must notice.
STATIC = Fault(
    "sampled.c", "    double y[AT_LEAST_ONE(MODEL_N_OUTPUTS)]", "    static double y[AT_LEAST_ONE(MODEL_N_OUTPUTS)]"
)
LEAK = Fault("snapshot.c", "    free(*FMUstate);\n", "")
OVERRUN = Fault(
    "snapshot.c", "memcpy(serializedState, snapshot, sizeof *snapshot)", "memcpy(serializedState, snapshot, 1 + size)"
)


def require_clean(*command: str) -> None:
    """Run a program that must end with 0, and show what it said if it does not."""
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, f"{run.stdout}{run.stderr}"


def require_valgrind() -> None:
    """Skip the test unless valgrind is there."""
    if shutil.which("valgrind") is None:
        pytest.skip(needs("valgrind is not installed", "valgrind"))


def test_plain_run_is_clean_under_sanitizers(fmu: Path, tmp_path: Path) -> None:
    """Address, leak and undefined behaviour: 2,000 steps and more, resets, all 34 functions."""
    require_clang()
    program = compile_driver("scenario.c", unpack(fmu, tmp_path), f"-fsanitize={SANITIZERS}", *STRICT)
    require_clean(str(program), "2000")


@pytest.mark.parametrize("identifier", ["Plant", "CraigAdaptiveImpedance", CONTAINER])
def test_plain_run_is_clean_under_valgrind(fmu: Path, tmp_path: Path) -> None:
    require_clang()
    require_valgrind()
    program = compile_driver("scenario.c", unpack(fmu, tmp_path))
    require_clean(*VALGRIND, str(program), "1000")


@pytest.mark.parametrize("sanitizer", ["", "thread"])
@pytest.mark.parametrize("identifier", ["Plant", "ForceSensor", "CraigAdaptiveImpedance", CONTAINER])
def test_14_threads_of_instances_give_the_lone_bits(fmu: Path, tmp_path: Path, sanitizer: str) -> None:
    """8 threads x 8 instances at once; ThreadSanitizer sees data races that the bits happen not to show."""
    require_clang()
    flags = (f"-fsanitize={sanitizer}",) if sanitizer else ()
    require_clean(str(compile_driver("threads.c", unpack(fmu, tmp_path), "-pthread", *flags)))


@pytest.mark.parametrize(
    ("tool", "fault"),
    [
        pytest.param("thread", STATIC, id="memory shared by instances, in threads"),
        pytest.param(SANITIZERS, LEAK, id="leak, under sanitizers"),
        pytest.param(SANITIZERS, OVERRUN, id="overrun, under sanitizers"),
        pytest.param("valgrind", LEAK, id="leak, under valgrind"),
        pytest.param("valgrind", OVERRUN, id="overrun, under valgrind"),
    ],
)
def test_planted_faults_are_found(fmu_folder: Path, tmp_path: Path, tool: str, fault: Fault) -> None:
    require_clang()
    sources = unpack(fmu_folder / "ForceSensor.fmu", tmp_path, fault)
    if tool == "valgrind":
        require_valgrind()
        command = (*VALGRIND, str(compile_driver("scenario.c", sources)), "100")
    elif tool == "thread":
        command = (str(compile_driver("threads.c", sources, "-pthread", "-fsanitize=thread")),)
    else:
        command = (str(compile_driver("scenario.c", sources, f"-fsanitize={tool}", *STRICT)), "100")
    with pytest.raises(AssertionError, match=r"ERROR: |WARNING: ThreadSanitizer|definitely lost|Invalid "):
        require_clean(*command)
