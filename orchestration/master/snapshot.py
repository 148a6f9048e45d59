"""A snapshot holds the state of a whole run: every component, the values exchanged, and the rows so far.

The state of a component is serialized if its FMU can do that. If all states are serialized, the snapshot
outlives the run and can be written to a file. A state that is not serialized stays in the instance.
"""

import hashlib
import json
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from adaptimp_fmu.files.whole_file import whole_file
from orchestration.errors import OrchestrationError
from orchestration.fmi.codes import SERIALIZES_STATE
from orchestration.sandbox.missing import no_file
from orchestration.system.system import System

FORMAT = 3
# Exceptions of numpy, zipfile and json for bytes that are not an archive of arrays, or that are a damaged archive.
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
    """State of a run at one communication point, made by `Simulation.save`.

    Attributes
    ----------
    time
        Time of the communication point, s.
    identity
        Hash of the components, connections, algorithm, communication points and columns of the run. Only
        a run with the same hash can continue from the snapshot.
    arrays
        Buffers of the master and the rows so far, by name.
    states
        State of each component in the order of the system: bytes if serialized, else an fmi2FMUstate.

    Examples
    --------
    A file takes the state to another process or another day:

    >>> from orchestration import Snapshot, prepare, scenario
    >>> with prepare(scenario("fig2")) as run:
    ...     run.run(until=0.5)
    ...     path = run.save().write("half.snapshot")
    >>> with prepare(scenario("fig2")) as run:
    ...     run.restore(Snapshot.read(path))
    ...     print(run.time)
    0.5
    """

    time: float
    identity: str
    arrays: dict[str, np.ndarray] = field(repr=False)
    states: tuple[Any, ...] = field(repr=False)

    def write(self, path: str | Path) -> Path:
        """Write the snapshot to a file, which `read` can read in any process.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        OrchestrationError
            If an FMU cannot serialize its state, or the file cannot be written.
        """
        path = Path(path)
        if not all(isinstance(state, bytes) for state in self.states):
            msg = f"{path}: an FMU does not declare {SERIALIZES_STATE}; this snapshot lives in its run only."
            raise OrchestrationError(msg)
        header = json.dumps({"format": FORMAT, "time": self.time, "identity": self.identity})
        states = {f"state_{i}": np.frombuffer(state, np.uint8) for i, state in enumerate(self.states)}
        try:
            with whole_file(path) as file:
                np.savez(file, allow_pickle=False, header=np.array(header), **states, **self.arrays)
        except OSError as error:
            msg = f"{path}: the snapshot cannot be written: {error.strerror}."
            raise OrchestrationError(msg) from error
        return path

    @classmethod
    def read(cls, path: str | Path) -> "Snapshot":
        """Read a file that `write` wrote.

        Raises
        ------
        OrchestrationError
            If the file is missing, damaged or not a snapshot.
        """
        if not Path(path).is_file():
            raise OrchestrationError(no_file(Path(path), "snapshot"))
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
            reason = str(error).splitlines()[0].partition(". ")[0].rstrip(".") if str(error) else type(error).__name__
            msg = f"{path} is not a snapshot: {reason}; give a file that Snapshot.write wrote."
            raise OrchestrationError(msg) from error


def _is_state(name: str) -> bool:
    """Whether an array of a file is the serialized state of a component."""
    return name.startswith("state_")


def identity(system: System, columns: Sequence[str], times: np.ndarray, chosen: Sequence[object]) -> str:
    """Return a hash of everything that a run must share with the run of a snapshot to continue from there.

    Parameters
    ----------
    system
        System with its FMUs and connections.
    columns
        Names of the recorded outputs.
    times
        Communication points, s, shape (n + 1,).
    chosen
        Further choices of the run, such as its algorithm; the hash takes the ``repr`` of each.
    """
    members = [(c.name, c.description.identifier, c.description.guid) for c in system.components]
    said = (members, [str(connection) for connection in system.connections], tuple(columns), *chosen)
    return hashlib.sha256(repr(said).encode() + times.tobytes()).hexdigest()
