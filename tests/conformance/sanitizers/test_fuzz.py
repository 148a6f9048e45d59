"""A short run of the fuzzer on one FMU of each kind, and inputs with which its harness must notice planted faults.

The run is counted in executions, so that it is the same on a slow machine; ``ADAPTIMP_FUZZ_RUNS=500000``
makes it a long one. Executions and libFuzzer's coverage are printed (``pytest -rP``). Where a search leads depends
on the addresses at which the program is loaded, so a planted fault is not searched for: libFuzzer has found and
shortened an input for each. The search begins with these inputs, too.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conformance.container import CONTAINER
from tests.conformance.sanitizers.compiling import SANITIZERS, STRICT, Fault, compile_driver, require_clang, unpack

RUNS = int(os.environ.get("ADAPTIMP_FUZZ_RUNS", "10000"))  # executions; some 2,000 in a second
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


FINDINGS = {
    "checksum ignored": "61f9e8f9fafbfeff00feff",
    "one variable too many": "f6f7f8f9fafbfc",
    "missing array used": "00151cd0b17fb17f",
    "values set before all are checked": "01b8b8b85db1b8",
    "NaN outputs pass": "f55b315d78f5745b315d78787878789f000000706572696f000000000000006572696f",
    "leaked state": "00b1",
    "state keeps no tick": "f5010000000064715bb1a3aaa3aab164715b",
}
"""Inputs, in hexadecimal digits, whose calls of a ForceSensor meet the fault of that name in `FAULTS`."""


def fuzz(sources: Path, *inputs: bytes, runs: int = 0) -> subprocess.CompletedProcess[str]:
    """Compile the harness, and run it on each input or, if `runs` are given, so often from there on."""
    program = compile_driver("fuzz.c", sources, f"-fsanitize=fuzzer,{SANITIZERS}", *STRICT)
    corpus = sources / "corpus"
    corpus.mkdir()
    files = [corpus / f"input{number}" for number in range(len(inputs))]
    for file, content in zip(files, inputs, strict=True):
        file.write_bytes(content)
    search = ("-seed=1", f"-runs={runs}", f"-max_len={MAX_LENGTH}", corpus)
    command = [str(program), f"-timeout={HANG}", *map(str, search if runs else files)]
    return subprocess.run(command, cwd=sources, capture_output=True, text=True, check=False, errors="replace")


@pytest.mark.parametrize("identifier", ["Plant", "CraigAdaptiveImpedance", CONTAINER])
def test_no_finding(fmu: Path, tmp_path: Path, identifier: str) -> None:
    require_clang()
    inputs = (*SEEDS, *map(bytes.fromhex, FINDINGS.values()))
    run = fuzz(unpack(fmu, tmp_path / identifier), *inputs, runs=RUNS)
    assert run.returncode == 0, run.stderr[-6000:]
    done = re.findall(r"^#(\d+).*cov: (\d+) ft: (\d+)", run.stderr, re.MULTILINE)
    executions, coverage, features = map(int, done[-1])
    sys.stdout.write(f"{identifier}: {executions} executions, cov {coverage}, ft {features}\n")
    # The harness does fuzz: 5,000 executions of the plant reach cov 1012.
    assert executions >= RUNS
    assert coverage > 800


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_noticed(fmu_folder: Path, tmp_path: Path, name: str) -> None:
    require_clang()
    faulty = unpack(fmu_folder / "ForceSensor.fmu", tmp_path / "faulty", FAULTS[name])
    run = fuzz(faulty, bytes.fromhex(FINDINGS[name]))
    assert run.returncode != 0, f"not noticed: {name}\n{run.stderr[-1000:]}"
    assert re.search(r"violated: |ERROR: AddressSanitizer|ERROR: LeakSanitizer|runtime error", run.stderr), run.stderr
