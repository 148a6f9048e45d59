"""Records of studies in a store, so that a study is continued with nothing but its store."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from adaptimp_fmu.files.temporary_folder import temporary_folder
from adaptimp_fmu.files.whole_file import write_whole
from orchestration.campaigns.store.row_files import store_errors
from orchestration.errors import StoreError
from orchestration.master.provenance import versions
from orchestration.sandbox.archive import file_hash
from orchestration.system.system import System

FORMAT = 1
"""Version of the records."""
UNFINISHED = "unfinished"
"""Folder in a store for drafts and locks."""
RECORD, SYSTEM = ".json", ".ssp"
_NAME = 16  # hexadecimal digits of an identity


@dataclass(frozen=True)
class StoredStudy:
    """A study as a store has it.

    Attributes
    ----------
    identity
        Hash of the record, the systems and the versions, as hexadecimal digits.
    record
        What the study said of itself, of values that JSON has.
    systems
        SSP package of each system, by name.
    versions
        Versions of the packages that decided the numbers when the record was written.
    """

    identity: str
    record: Mapping[str, Any]
    systems: Mapping[str, Path]
    versions: Mapping[str, str]

    def system(self, name: str) -> System:
        """Read a system of the study.

        Raises
        ------
        ArchiveError
            If its package is missing or damaged.
        """
        return System.read(self.systems[name])


def write_study(folder: Path, record: Mapping[str, Any], systems: Mapping[str, System]) -> str:
    """Write the record of a study and the packages of its systems; returns the identity of the study.

    Raises
    ------
    StoreError
        If the record holds something that JSON has not, or a file cannot be written.
    """
    with store_errors(folder):
        packages = {name: _write_package(folder / "systems", system) for name, system in systems.items()}
        content = {"format": FORMAT, "study": record, "systems": packages, "versions": versions()}
        try:
            text = json.dumps(content, indent=2, sort_keys=True, ensure_ascii=False, allow_nan=False)
        except (TypeError, ValueError) as error:
            msg = f"{folder}: the record of the study cannot be written: {error}; use numbers, texts, lists and dicts."
            raise StoreError(msg) from error
        identity = hashlib.sha256(text.encode()).hexdigest()[:_NAME]
        write_whole(folder / "studies" / f"{identity}{RECORD}", text.encode())
    return identity


def read_studies(folder: Path) -> tuple[StoredStudy, ...]:
    """Read the records of all studies, that which was written last at the end.

    Raises
    ------
    StoreError
        If a record is damaged, or was written by a newer version.
    """
    paths = sorted((folder / "studies").glob(f"*{RECORD}"), key=lambda path: (path.stat().st_mtime_ns, path.name))
    return tuple(_read(folder, path) for path in paths)


def _write_package(folder: Path, system: System) -> str:
    """Write a system as a package that is named by its content; returns the name without suffix."""
    folder.mkdir(exist_ok=True)
    with temporary_folder(folder.parent / UNFINISHED) as place:
        package = system.write(place / f"system{SYSTEM}")
        name = file_hash(package)[:_NAME]
        if not (folder / f"{name}{SYSTEM}").exists():
            package.replace(folder / f"{name}{SYSTEM}")
    return name


def _read(folder: Path, path: Path) -> StoredStudy:
    """A study of a record."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        version = int(content["format"])
        packages = {name: folder / "systems" / f"{digest}{SYSTEM}" for name, digest in content["systems"].items()}
        study = StoredStudy(path.stem, content["study"], packages, content["versions"])
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        msg = f"{path}: the record of a study cannot be read ({error!r}); restore it, or move it elsewhere."
        raise StoreError(msg) from error
    if version > FORMAT:
        msg = f"{path}: the record has format {version}, but {FORMAT} is known; use a newer adaptimp."
        raise StoreError(msg)
    return study
