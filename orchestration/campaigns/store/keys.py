"""Keys of runs: two runs have the same key if they are made of the same content.

A key is a hash of

* the structure of the task: content of the FMUs, names and order of components, connections, start and stop time,
  algorithm, versions of the packages that decide the numbers, adaptimp's sources if they can change without a new
  version, and the kind of machine (`Task.structure`);
* all start values in force, those of the FMUs included, whether rows vary them or not;
* the communication step;
* names and identities of the measures, in any order, as they are when the keys are made first.

Numbers count by their bits. What a run is not made of does not count: files' names and places, the number of the run
in its study, and which start values the study varies. So a run of another study is found again.
"""

import hashlib
import json

import numpy as np

from orchestration.campaigns.engines.engine import Points
from orchestration.campaigns.engines.task import Task

KEY_LENGTH = 32
"""Number of hexadecimal digits of a key, which are 128 bits."""
FORMAT = "1"
"""Version of what a key is made of. Runs whose keys are of another version are made anew."""
_AT_ONCE = 4096  # runs whose start values are written out at the same time; 100 values of each take 3 MB


class RunKeys:
    """Makes the keys of a task's runs.

    Parameters
    ----------
    task
        What the runs have in common.

    Raises
    ------
    ArchiveError, OSError
        If an FMU cannot be read.
    StudyError
        If the content of a measure's function cannot be told.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        numbers = {path: float(value) for path, value in task.start_values.items() if not isinstance(value, str)}
        names = sorted(numbers.keys() | set(task.varied))
        self._places = [names.index(path) for path in task.varied]
        self._shared = np.array([numbers.get(path, np.nan) for path in names] + [np.nan], "<f8")
        self._common = _common(task, names)

    def of(self, points: Points) -> np.ndarray:
        """Return the key of each run: hexadecimal digits, bytes of length `KEY_LENGTH`, shape (n,).

        Parameters
        ----------
        points
            Start values and communication steps of the runs.
        """
        keys = np.empty(len(points), f"S{KEY_LENGTH}")
        for begin in range(0, len(points), _AT_ONCE):
            part = points[begin : begin + _AT_ONCE]
            content = np.tile(self._shared, (len(part), 1))
            content[:, self._places], content[:, -1] = part.values, part.steps
            keys[begin : begin + len(part)] = [self._key(row) for row in content]
        return keys

    def _key(self, numbers: np.ndarray) -> str:
        """Key of one run, from what is common and its own numbers."""
        digest = self._common.copy()
        digest.update(numbers.tobytes())
        return digest.hexdigest()


def _common(task: Task, names: list[str]) -> "hashlib.blake2b":
    """Hash of what all runs of a task share, which the numbers of a run are added to."""
    texts = sorted((path, value) for path, value in task.start_values.items() if isinstance(value, str))
    measures = sorted((measure.names, measure.identity) for measure in task.measures)
    content = json.dumps([FORMAT, task.structure, names, texts, measures])
    return hashlib.blake2b(content.encode(), digest_size=KEY_LENGTH // 2)
