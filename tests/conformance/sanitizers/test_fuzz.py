"""A short run of the fuzzer on one FMU of each kind, and faults that it must find.

The run is counted in executions, so that it is the same on a slow machine; ``ADAPTIMP_FUZZ_RUNS=500000``
makes it a long one. Executions and libFuzzer's coverage are printed (``pytest -rP``).
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conformance.sanitizers.compiling import SANITIZERS, STRICT, Fault, compile_driver, require_clang, unpack

RUNS = int(os.environ.get("ADAPTIMP_FUZZ_RUNS", "10000"))  # executions; some 2,000 in a second
MOST = 100_000  # executions in which a planted fault must be found; the last one of them takes 2,021
MAX_LENGTH = 1024  # bytes of one input, about 100 calls
HANG = 1200  # s of one input; the slowest in 10 CPU minutes, an arm at 1e308 rad that chatters, took 7 s of CPU time
# Where to start: zeros lead on (setup, enter, exit, steps); the others touch all groups of calls.
SEEDS = (bytes(200), bytes([1, *(0, 0) * 20, *range(256)]), bytes(i * 7 % 251 for i in range(600)))

FAULTS = {
    "checksum ignored": Fault("snapshot.c", "snapshot->checksum != checksum_of(snapshot)", "0"),
    "one variable too many": Fault(
        "access.c",
        "reference < MODEL_N_VARIABLES && model_variables",
        "reference <= MODEL_N_VARIABLES && model_variables",
    ),
    "missing array used": Fault(
        "access.c", "if (n == 0 || (references && values))", "if (n == 0 || references || values)"
    ),
    "values set before all are checked": Fault(
        "access.c",
        "parameter_changed |= vr[i] < MODEL_FIRST_INPUT;",
        "parameter_changed |= vr[i] < MODEL_FIRST_INPUT; instance->state.values[vr[i]] = CONVERT(value[i]);",
    ),
    "NaN outputs pass": Fault("validate.c", "!all_finite(y, MODEL_N_OUTPUTS)", "0"),
    "leaked state": Fault("snapshot.c", "    free(*FMUstate);\n", ""),
    "state keeps no tick": Fault(
        "snapshot.c",
        "    instance->state = ((const Snapshot *)FMUstate)->state;",
        "    const int64_t tick = instance->state.tick + (instance->state.tick > 2);\n"
        "    instance->state = ((const Snapshot *)FMUstate)->state;\n"
        "    instance->state.tick = tick;",
    ),
}


def fuzz(sources: Path, runs: int) -> subprocess.CompletedProcess[str]:
    """Compile the harness and run it so often, or until a finding."""
    program = compile_driver("fuzz.c", sources, f"-fsanitize=fuzzer,{SANITIZERS}", *STRICT)
    corpus = sources / "corpus"
    corpus.mkdir()
    for number, seed in enumerate(SEEDS):
        (corpus / f"seed{number}").write_bytes(seed)
    command = [
        str(program),
        "-seed=1",
        f"-runs={runs}",
        f"-max_len={MAX_LENGTH}",
        f"-timeout={HANG}",
        str(corpus),
    ]
    return subprocess.run(command, cwd=sources, capture_output=True, text=True, check=False, errors="replace")


@pytest.mark.parametrize("identifier", ["Plant", "CraigAdaptiveImpedance"])
def test_no_finding(fmu_folder: Path, tmp_path: Path, identifier: str) -> None:
    require_clang()
    run = fuzz(unpack(fmu_folder / f"{identifier}.fmu", tmp_path / identifier), RUNS)
    assert run.returncode == 0, run.stderr[-6000:]
    done = re.findall(r"^#(\d+).*cov: (\d+) ft: (\d+)", run.stderr, re.MULTILINE)
    executions, coverage, features = map(int, done[-1])
    sys.stdout.write(f"{identifier}: {executions} executions, cov {coverage}, ft {features}\n")
    # The harness does fuzz: 5,000 executions of the plant reach cov 1012.
    assert executions >= RUNS
    assert coverage > 800


@pytest.mark.parametrize("name", FAULTS)
def test_planted_faults_are_found(fmu_folder: Path, tmp_path: Path, name: str) -> None:
    require_clang()
    run = fuzz(unpack(fmu_folder / "CraigAdaptiveImpedance.fmu", tmp_path / "faulty", FAULTS[name]), MOST)
    assert run.returncode != 0, f"not found: {name}\n{run.stderr[-1000:]}"
    assert re.search(r"violated: |ERROR: AddressSanitizer|ERROR: LeakSanitizer|runtime error", run.stderr), run.stderr
