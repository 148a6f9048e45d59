"""The state of a whole run: of every unit, of the exchange between them, and the rows so far.

A unit's state is serialized where the unit can do that, so a snapshot outlives the run and can be
written to a file; else it stays with the instance.
"""

import hashlib
import json
import struct
import zlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.fmi.codes import SERIALIZES_STATE
from orchestration.system.system import System

FORMAT = 1
# What numpy, zipfile and json raise on bytes that are no archive of arrays, or a broken one.
_DAMAGED = (
    ValueError,
    KeyError,
    TypeError,
    EOFError,
    RuntimeError,
    ArithmeticError,
    MemoryError,
    BadZipFile,
    struct.error,
    zlib.error,
)


@dataclass(frozen=True)
class Snapshot:
    """Made by `Simulation.save`.

    Attributes
    ----------
    time
        s.
    identity
        What a run must be to continue from here: its units, connections, algorithm, points, columns.
    """

    time: float
    identity: str
    arrays: dict[str, np.ndarray] = field(repr=False)
    states: tuple[Any, ...] = field(repr=False)

    def write(self, path: str | Path) -> Path:
        """Write to a file; `read` it in any process.

        Raises
        ------
        OrchestrationError
            If a unit cannot serialize its state, or the file cannot be written.
        """
        path = Path(path)
        if not all(isinstance(state, bytes) for state in self.states):
            msg = f"{path}: a unit does not declare {SERIALIZES_STATE}; this snapshot lives in its run only."
            raise OrchestrationError(msg)
        header = json.dumps({"format": FORMAT, "time": self.time, "identity": self.identity})
        states = {f"state_{i}": np.frombuffer(state, np.uint8) for i, state in enumerate(self.states)}
        draft = path.with_name(path.name + ".part")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with draft.open("wb") as file:
                np.savez(file, allow_pickle=False, header=np.array(header), **states, **self.arrays)
            draft.replace(path)
        except OSError as error:
            msg = f"{path}: the snapshot cannot be written: {error.strerror}."
            raise OrchestrationError(msg) from error
        finally:
            with suppress(OSError):
                draft.unlink(missing_ok=True)
        return path

    @classmethod
    def read(cls, path: str | Path) -> "Snapshot":
        """Read what `write` wrote.

        Raises
        ------
        OrchestrationError
            If the file is missing or no snapshot.
        """
        try:
            with Path(path).open("rb") as raw, np.load(raw, allow_pickle=False) as file:
                content = {name: file[name] for name in file.files}
            header = json.loads(str(content.pop("header")))
            states = [content.pop(f"state_{i}").tobytes() for i in range(len([n for n in content if _is_state(n)]))]
            if header["format"] != FORMAT:
                msg = f"{path}: the snapshot has format {header['format']}, this version reads {FORMAT}."
                raise OrchestrationError(msg)
            return cls(float(header["time"]), str(header["identity"]), content, tuple(states))
        except OSError as error:
            msg = f"{path}: the snapshot cannot be read: {error.strerror or error}."
            raise OrchestrationError(msg) from error
        except _DAMAGED as error:
            msg = f"{path} is no snapshot: {error}."
            raise OrchestrationError(msg) from error


def _is_state(name: str) -> bool:
    return name.startswith("state_")


def identity(system: System, columns: Sequence[str], times: np.ndarray, chosen: Sequence[object]) -> str:
    """A hash of units, connections, columns, points, and what else was chosen for a run."""
    units = [(c.name, c.description.identifier, c.description.guid) for c in system.components]
    said = (units, [repr(connection) for connection in system.connections], tuple(columns), *chosen)
    return hashlib.sha256(repr(said).encode() + times.tobytes()).hexdigest()
