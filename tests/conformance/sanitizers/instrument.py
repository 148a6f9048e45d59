"""A pytest plugin: FMUs are built by clang with counters of LLVM's source-based coverage.

``pytest -p tests.conformance.sanitizers.instrument``, with ``$ADAPTIMP_CACHE`` set to an empty folder
(the cache does not know of counters) and ``$LLVM_PROFILE_FILE`` saying where they are written.
"""

import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

import adaptimp_fmu.binary
from adaptimp_fmu.errors import ToolchainError
from adaptimp_fmu.toolchain import Platform, fmi_headers
from tests.conformance.sanitizers.compiling import FLAGS

COUNTERS = ("-fprofile-instr-generate", "-fcoverage-mapping")


def compile_instrumented(
    sources: Sequence[Path], output: Path, _target: Platform, _libraries: Sequence[str] = ()
) -> None:
    """As `adaptimp_fmu.toolchain.compile_library`, for this machine only."""
    command = [
        *("clang", *FLAGS, *COUNTERS, "-shared", "-fPIC", "-fvisibility=hidden", "-I", str(fmi_headers())),
        *(*(str(source) for source in sources), "-o", str(output)),
    ]
    run = subprocess.run(command, cwd=sources[0].parent, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise ToolchainError(f"{sources[0].name} does not compile with counters:\n{run.stderr}")


def pytest_configure(config: pytest.Config) -> None:  # noqa: ARG001
    """Replace the compiler before anything is built."""
    adaptimp_fmu.binary.compile_library = compile_instrumented
