"""Compiles an FMU's C code for every platform with ``python -m ziglang cc``, the same compiler on every machine."""

import importlib.metadata
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from adaptimp_fmu.errors import ToolchainError
from adaptimp_fmu.files.cache_folder import cache_folder, tagged_cache
from adaptimp_fmu.files.cache_use import use
from adaptimp_fmu.files.parts import PARTS, MissingPartError
from adaptimp_fmu.files.standards import standard_file

FLAGS = (
    "-std=c11",
    "-O2",
    # Numbers go from FMU to FMU one by one; the code fits the processor's caches (docs/decisions/009).
    *("-fno-slp-vectorize", "-fno-vectorize", "-falign-functions=64"),
    "-ffp-contract=off",
    "-fvisibility=hidden",
    "-fno-sanitize=all",
    "-g0",
    "-s",
)
_COMPILER_CACHE = "ZIG_GLOBAL_CACHE_DIR"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wvla", "-Werror")


@dataclass(frozen=True)
class Platform:
    """A platform that binaries of FMUs run on.

    Attributes
    ----------
    name
        Folder under ``binaries/`` in the FMU.
    target
        Target of the compiler; Linux with glibc 2.17, macOS 11.
    flags
        Flags of the compiler besides `FLAGS`; ``{library}`` stands for the library's file name.
    form
        Flags that make the binary a shared library, or whatever else the platform loads.

    Examples
    --------
    >>> from adaptimp_fmu import PLATFORMS
    >>> sorted(PLATFORMS)
    ['aarch64-darwin', 'aarch64-linux', 'darwin64', 'linux64', 'win64']
    >>> PLATFORMS["win64"].extension
    '.dll'
    """

    name: str
    target: str
    extension: str
    flags: tuple[str, ...] = ()
    form: tuple[str, ...] = ("-shared",)


# Without a name the linker writes the output's path, here of a temporary folder, into the library.
_DARWIN = ("-fPIC", "-Wl,-install_name,@rpath/{library}")

PLATFORMS = {
    platform.name: platform
    for platform in (
        Platform("linux64", "x86_64-linux-gnu.2.17", ".so", ("-fPIC",)),
        Platform("win64", "x86_64-windows-gnu", ".dll"),
        Platform("darwin64", "x86_64-macos.11.0", ".dylib", _DARWIN),
        Platform("aarch64-linux", "aarch64-linux-gnu.2.17", ".so", ("-fPIC",)),
        Platform("aarch64-darwin", "aarch64-macos.11.0", ".dylib", _DARWIN),
    )
}

# Functions are called from outside, in any order; the stack has 1 MiB.
_REACTOR = ("-mexec-model=reactor", "-Wl,--no-entry", "-Wl,-z,stack-size=1048576")

WASM = Platform("wasm", "wasm32-wasi", ".wasm", form=(*_REACTOR, "-nostdlib"))
"""WebAssembly without a C library; not a platform of FMUs."""

WASM_WITH_LIBRARY = Platform("wasm-libc", "wasm32-wasi", ".wasm", form=_REACTOR)
"""WebAssembly with a C library, whose files and clocks a module imports; not a platform of FMUs."""


def host_platform() -> Platform:
    """Return the platform that this Python runs on.

    Raises
    ------
    ToolchainError
        If FMUs cannot be built for it.

    Examples
    --------
    >>> from adaptimp_fmu import PLATFORMS, host_platform
    >>> host_platform() in PLATFORMS.values()
    True
    """
    machine = platform.machine().lower()
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)
    names = {
        ("linux", "x86_64"): "linux64",
        ("linux", "aarch64"): "aarch64-linux",
        ("darwin", "x86_64"): "darwin64",
        ("darwin", "aarch64"): "aarch64-darwin",
        ("win32", "x86_64"): "win64",
    }
    name = names.get((sys.platform, machine))
    if name is None:
        msg = f"No FMU platform for {sys.platform} on {machine}; known: {', '.join(PLATFORMS)}."
        raise ToolchainError(msg)
    return PLATFORMS[name]


def fmi_headers() -> Path:
    """Return the folder of FMI's header files in the installed fmpy."""
    return standard_file("c-code")


def identity() -> str:
    """Return a text that changes whenever something besides the sources changes a binary: compiler, flags, headers.

    Raises
    ------
    MissingPartError
        If the compiler or the headers are not installed.
    """
    try:
        versions = [f"{name} {importlib.metadata.version(name)}" for name in ("ziglang", "fmpy")]
    except importlib.metadata.PackageNotFoundError as error:
        raise MissingPartError(error.name, PARTS[error.name]) from error
    return " ".join((*versions, *FLAGS))


def _compiler_cache() -> dict[str, str]:
    """Environment with a cache folder for the compiler, if it cannot write to its own.

    The compiler ends, or never ends, without a folder that it can write to: zig 0.13 with HOME=/proc/none.
    """
    if _COMPILER_CACHE in os.environ or sys.platform == "win32":
        return {}
    home = os.environ.get("XDG_CACHE_HOME") or (os.environ.get("HOME") and f"{os.environ['HOME']}/.cache")
    if home:
        with suppress(OSError):
            own = Path(home) / "zig"
            own.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=own).close()
            return {}
    own = tagged_cache("zig")
    use(cache_folder(), own.name)
    return {_COMPILER_CACHE: str(own)}


def compile_library(
    sources: Path | Sequence[Path], output: Path, target: Platform, libraries: Sequence[str] = ()
) -> None:
    """Compile C files of one folder, and of folders below, into a shared library.

    Parameters
    ----------
    sources
        Translation units; the first one stands in the folder in which the compiler runs.
    target
        Platform of the library. `WASM` and `WASM_WITH_LIBRARY` make a module of WebAssembly.
    libraries
        Names of libraries that the files need besides the C library.

    Raises
    ------
    ToolchainError
        If the compiler refuses a file; the message has the compiler's output.
    """
    units = [sources] if isinstance(sources, Path) else list(sources)
    folder = units[0].parent
    command = [
        *(sys.executable, "-m", "ziglang", "cc", *target.form, "-target", target.target),
        *FLAGS,
        *WARNINGS,
        *(flag.format(library=output.name) for flag in target.flags),
        *("-I", str(fmi_headers()), *(str(unit.relative_to(folder)) for unit in units)),
        *("-o", str(output.resolve()), *(f"-l{name}" for name in libraries)),
    ]
    environment = {**os.environ, **_compiler_cache()}
    run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if run.returncode != 0 or not output.exists():
        msg = f"{units[0].name} does not compile for {target.name}:\n{run.stderr.strip()}"
        raise ToolchainError(msg)
