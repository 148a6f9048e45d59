"""A store of runs: a folder of Parquet files, of records of studies and of packages of their systems.

    runs/
      store.json                 what the folder is, and the version of its format
      studies/IDENTITY.json      what a study said of itself
      systems/HASH.ssp           its systems, with the FMUs
      rows/study=IDENTITY/       its finished runs, as Parquet files that any tool reads
      unfinished/                drafts, and locks

Any number of processes may use a store at once.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from adaptimp_fmu.files.whole_file import SUFFIX as DRAFT
from adaptimp_fmu.files.whole_file import write_whole
from orchestration.campaigns.engines.engine import Points
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.store.keys import RunKeys
from orchestration.campaigns.store.row_files import (
    Place,
    read_rows,
    read_study,
    remove_drafts_of_dead_processes,
    store_errors,
)
from orchestration.campaigns.store.row_table import Found, RowColumns, Search, without_duplicates
from orchestration.campaigns.store.studies import UNFINISHED, StoredStudy, read_studies, write_study
from orchestration.campaigns.store.writer import RowWriter
from orchestration.errors import StoreError
from orchestration.fmi.given import a_path
from orchestration.system.system import System

if TYPE_CHECKING:
    import pyarrow as pa

FORMAT = 1
"""Version of the folder's layout."""
_KIND = "store of runs"  # what the mark says that the folder is
_MARK, _ROWS, _STUDY = "store.json", "rows", "study="


class Store:
    """A folder in which finished runs are found again by their content.

    Parameters
    ----------
    folder
        An existing store; `open` makes one.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._keys: dict[int, RunKeys] = {}  # by the id of their task, which they keep

    @classmethod
    def open(cls, folder: str | Path, *, new: bool = True) -> "Store":
        """Open a store.

        Parameters
        ----------
        folder
            Folder of a store; or one that is empty or does not exist, which becomes a store.
        new
            Whether a folder may become a store.

        Raises
        ------
        StoreError
            If the folder has files of something else, is a store of a newer version, is not a store though it should
            be one, or cannot be written to.
        """
        place = a_path("A store's folder", folder)
        if new:
            with store_errors(place):
                _make(place)
        _require_store(place)
        if (place / UNFINISHED).is_dir():
            remove_drafts_of_dead_processes(place / UNFINISHED)
        return cls(place)

    def keys(self, task: Task, points: Points) -> np.ndarray:
        """Return the keys of runs, shape (n,); see `orchestration.campaigns.store.keys`."""
        if id(task) not in self._keys:
            self._keys[id(task)] = RunKeys(task)
        return self._keys[id(task)].of(points)

    def find(self, keys: np.ndarray, measures: tuple[str, ...], study: str = "") -> Found:
        """Find runs by their keys among the runs of all studies.

        Parameters
        ----------
        keys
            Keys of the runs, shape (n,).
        measures
            Names of the measures.
        study
            Identity of the study that asks, for `Found.own`.
        """
        search = Search(keys, measures)
        for folder in sorted((self.folder / _ROWS).glob(f"{_STUDY}*")):
            for _, table in read_rows(folder, search.columns):
                search.look_in(table, own=folder.name == f"{_STUDY}{study}")
        return search.found

    def writer(self, study: str, columns: RowColumns) -> RowWriter:
        """Return a writer of the finished runs of a study, which is a context manager.

        Raises
        ------
        StoreError
            If the folder cannot be written to.
        """
        place = self._place(study)
        with store_errors(place.rows):
            place.rows.mkdir(parents=True, exist_ok=True)
            place.drafts.mkdir(exist_ok=True)
        return RowWriter(place, columns)

    def table(self, study: str) -> "pa.Table":
        """Return the finished runs of a study in the order of their numbers, each once.

        Raises
        ------
        StoreError
            If the store has no runs of the study.
        """
        tables = list(read_study(self._place(study).rows).values())
        if not tables:
            known = ", ".join(found.identity for found in self.studies()) or "none"
            msg = f"{self.folder}: there are no runs of study {study}; the studies in the store are: {known}."
            raise StoreError(msg)
        return without_duplicates(tables)

    def save_study(self, record: Mapping[str, Any], systems: Mapping[str, System]) -> str:
        """Keep what a study says of itself, so that it can be continued from the store alone.

        Parameters
        ----------
        record
            Values that JSON has.
        systems
            Systems of the study by name.

        Returns
        -------
        str
            Identity of the study: equal for equal records, systems and versions of packages.

        Raises
        ------
        StoreError
            If the record holds something else, or cannot be written.
        """
        with store_errors(self.folder):
            (self.folder / UNFINISHED).mkdir(exist_ok=True)
        return write_study(self.folder, record, systems)

    def studies(self) -> tuple[StoredStudy, ...]:
        """Return the studies in the store, that which was saved last at the end.

        Raises
        ------
        StoreError
            If a record is damaged, or was written by a newer version.
        """
        return read_studies(self.folder)

    def _place(self, study: str) -> Place:
        return Place(self.folder / _ROWS / f"{_STUDY}{study}", self.folder / UNFINISHED)


def _make(folder: Path) -> None:
    """Make a store of a folder that is empty or missing; an existing store stays as it is."""
    folder.mkdir(parents=True, exist_ok=True)
    if (folder / _MARK).exists():
        return
    strange = sorted(path.name for path in folder.iterdir() if not _is_draft_of_mark(path.name))
    if strange and not (folder / _MARK).exists():  # another process may have made the store meanwhile
        msg = f"{folder}: the folder is no store and has other files, such as {strange[0]}; name a new folder."
        raise StoreError(msg)
    write_whole(folder / _MARK, json.dumps({"adaptimp": _KIND, "format": FORMAT}).encode())


def _is_draft_of_mark(name: str) -> bool:
    """Whether a file is the draft with which another process makes the folder a store."""
    return name.startswith(f"{_MARK}.") and name.endswith(DRAFT)


def _require_store(folder: Path) -> None:
    """Refuse a folder that is not a store of this version."""
    try:
        content = json.loads((folder / _MARK).read_text(encoding="utf-8"))
        kind, version = content["adaptimp"], int(content["format"])
    except FileNotFoundError:
        msg = f"{folder}: there is no store of runs; name the folder that a study was run with."
        raise StoreError(msg) from None
    except (OSError, ValueError, TypeError, KeyError) as error:
        msg = f"{folder / _MARK}: the store's mark cannot be read: {error}; restore the file."
        raise StoreError(msg) from error
    if kind != _KIND or version < 1:
        msg = f"{folder / _MARK}: this is {kind!r} of format {version}, not {_KIND!r} of format 1 or later;"
        msg = f"{msg} restore the file, or name the folder of a store."
        raise StoreError(msg)
    if version > FORMAT:
        msg = f"{folder}: the store has format {version}, but {FORMAT} is known; use a newer adaptimp."
        raise StoreError(msg)
