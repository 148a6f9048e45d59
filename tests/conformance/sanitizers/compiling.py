"""An FMU's own sources compiled into a C driver under clang, with its scene as a table."""

import functools
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZipFile

import pytest

from adaptimp_fmu.toolchain import WARNINGS, fmi_headers
from orchestration.containers.fmu.write import LAYER
from tests.conformance.scenes import SCENES
from tests.untested import needs

DRIVERS = Path(__file__).parent
# Without inlining into one flat function, and with the rounding of the shipped binary.
# valgrind 3.19 cannot read what clang 14 writes of several units in the fifth version of DWARF.
FLAGS = ("-std=c11", "-O1", "-gdwarf-4", "-ffp-contract=off", *WARNINGS)
# float-cast-overflow is not part of `undefined`: a double that no int can hold.
SANITIZERS = "address,undefined,float-cast-overflow"
STRICT = ("-fno-sanitize-recover=all",)
UNLINKED = "clang's sanitizers do not link"


@dataclass(frozen=True)
class Fault:
    """A text of the runtime and what replaces it, to see that a check notices."""

    file: str
    text: str
    replacement: str


@functools.cache
def missing() -> str | None:
    """What keeps clang's sanitizers from linking here, or None."""
    if shutil.which("clang") is None:
        return needs("clang is not installed", "clang", "libclang-rt-14-dev")
    command = ["clang", f"-fsanitize=fuzzer,{SANITIZERS}", "-x", "c", "-", "-o", "/dev/null"]
    source = "#include <stddef.h>\nint LLVMFuzzerTestOneInput(const unsigned char *d, size_t n) { return !d && n; }\n"
    run = subprocess.run(command, input=source, capture_output=True, text=True, check=False)
    return None if run.returncode == 0 else f"{needs(UNLINKED, 'libclang-rt-14-dev')}: {run.stderr}"


def require_clang() -> None:
    """Skip the test unless clang and its sanitizers are there."""
    reason = missing()
    if reason:
        pytest.skip(reason)


def unpack(fmu: Path, folder: Path, fault: Fault | None = None) -> Path:
    """Write the FMU's sources, perhaps with a fault, and ``scene.h``; returns the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with ZipFile(fmu) as archive:
        for name in archive.namelist():
            if name.startswith("sources/"):
                file = folder / name.removeprefix("sources/")
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(archive.read(name))
    if fault is not None:
        text = (folder / fault.file).read_text()
        assert text.count(fault.text) == 1, f"{fault.file} has changed: {fault.text}"
        (folder / fault.file).write_text(text.replace(fault.text, fault.replacement))
    (folder / "scene.h").write_text(scene_header(fmu.stem))
    return folder


def scene_header(identifier: str) -> str:
    """Start values of an FMU's scene as a C table that ends with a name NULL."""
    rows = [f'    {{"{name}", {float(value)!r}}},' for name, value in SCENES.get(identifier, {}).items()]
    head = "typedef struct {\n    const char *name;\n    double value;\n} SceneValue;"
    return "\n".join([head, "static const SceneValue scene_values[] = {", *rows, "    {NULL, 0},", "};", ""])


def compile_driver(driver: str, sources: Path, *flags: str) -> Path:
    """Compile ``driver`` of this folder with all sources of an FMU or of a container; returns the program.

    Raises
    ------
    RuntimeError
        With the compiler's messages.
    """
    program = sources / Path(driver).stem
    layer = sources / LAYER
    parts = [sources / "step.c", *sorted((sources / "fmus").glob("*.c"))] if layer.is_dir() else []
    command = [
        *("clang", *FLAGS, *flags, "-I", str(sources), "-I", str(layer), "-isystem", str(fmi_headers())),
        *(str(DRIVERS / driver), *map(str, parts), "-o", str(program)),
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(f"{driver} does not compile with {sources.name}:\n{run.stderr}")
    return program
