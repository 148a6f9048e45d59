"""What the wheel of adaptimp carries, so that running needs no toolchain: FMUs for all platforms, and programs.

    fmus/carried/manifest.json    hash of the definitions, and the hash of each file
    fmus/carried/Plant.fmu
    fmus/carried/IDENTITY.wasm    a system as a module of WebAssembly, which the page of the paper runs
    fmus/carried/scenarios.tar.xz the scenarios as SSP packages, which hold the same FMUs, for other tools

A carried FMU stands for the model of its name as long as the definitions are those that the FMU was built from: all
files of the packages `fmus` and `adaptimp_fmu`. A carried module stands for the C sources that its identity is a hash
of. A checkout carries nothing, and builds. `orchestration.paper.carry` says which FMUs the wheel carries.
"""

import hashlib
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import adaptimp_fmu
from adaptimp_fmu.files.standards import CARRIED as STANDARDS

FOLDER = Path(__file__).parent / "carried"
MANIFEST, SCENARIOS = "manifest.json", "scenarios.tar.xz"
_PACKAGES = (Path(__file__).parent, Path(adaptimp_fmu.__file__).parent)
_NOT_DEFINITIONS = (FOLDER, STANDARDS)


class ChangedFileError(RuntimeError):
    """A file that the wheel carries is not the one that was built; the message has both hashes."""


def carried_fmu(identifier: str) -> Path | None:
    """Return the carried FMU of a model identifier.

    Returns
    -------
    Path or None
        None if no FMU of the name is carried, or the definitions are others than those that it was built from.

    Raises
    ------
    ChangedFileError
        If the file is not the one that was built.
    """
    return None if why_not_carried(identifier) else _unchanged(f"{identifier}.fmu")


def why_not_carried(identifier: str) -> str:
    """Return why an FMU must be built, in a sentence; empty if the wheel carries it."""
    known = manifest()
    if known is None:
        return f"Without a wheel, {identifier}.fmu is built."
    if f"{identifier}.fmu" not in known["files"]:
        return f"The wheel does not carry {identifier}.fmu."
    if known["definitions"] != definitions_hash():
        return f"The definitions of the FMUs are not those of the wheel's {identifier}.fmu, so it is outdated."
    return ""


def carried_module(identity: str) -> bytes | None:
    """Return the carried module of WebAssembly of an identity, None if there is none; errors as of `carried_fmu`."""
    known = manifest()
    name = f"{identity}.wasm"
    return None if known is None or name not in known["files"] else _unchanged(name).read_bytes()


def carried_scenarios() -> Path | None:
    """Return the carried archive of the scenarios' SSP packages, None if there is none; errors as of `carried_fmu`."""
    return None if manifest() is None else _unchanged(SCENARIOS)


def description(identifier: str) -> str | None:
    """Return what the FMU of a model identifier is, in a line; None in a checkout, which declares the model."""
    known = manifest()
    return None if known is None else known["fmus"].get(identifier)


@cache
def manifest() -> dict[str, Any] | None:
    """Return the list of what is carried: ``definitions`` and ``files`` are SHA-256, ``fmus`` describes all models."""
    path = FOLDER / MANIFEST
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


@cache
def definitions_hash() -> str:
    """Return the SHA-256 of all files that decide what the FMUs are: equations, toolchain, runtime, references."""
    digest = hashlib.sha256()
    for package in _PACKAGES:
        for path in sorted(_definitions(package), key=lambda p: p.relative_to(package).as_posix()):
            digest.update(f"{package.name}/{path.relative_to(package).as_posix()}\0".encode())
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _definitions(package: Path) -> Iterator[Path]:
    for path in package.rglob("*"):
        known = path.suffix != ".pyc" and not any(path.is_relative_to(folder) for folder in _NOT_DEFINITIONS)
        if known and path.is_file():
            yield path


def _unchanged(name: str) -> Path:
    """The path of a carried file, whose hash is checked."""
    path, known = FOLDER / name, manifest()
    stated = known["files"][name] if known else ""
    found = hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else "none, as the file is missing"
    if found != stated:
        msg = (
            f"{path} is not the file that the wheel of adaptimp brought: its SHA-256 is {found}, that of the wheel's"
            f" file {stated}; install adaptimp again: pip install --force-reinstall --no-deps adaptimp"
        )
        raise ChangedFileError(msg)
    return path
