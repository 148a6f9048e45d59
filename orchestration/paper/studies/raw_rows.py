"""Keeps what was measured at each setting of the open values: a row of numbers, and why runs failed.

The rows are in a store of runs (`orchestration.campaigns.store`) in the user's cache. A row is found again by its
content: the numbers of the setting, the seed of its noise, and the code that measures it. So an interrupted study goes
on where it ended, and a study whose code has changed begins anew.
"""

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from adaptimp_fmu.files.cache_folder import cache_folder, writable_cache
from adaptimp_fmu.files.cache_use import use
from orchestration.campaigns.engines.engine import Outcomes
from orchestration.campaigns.store.keys import KEY_LENGTH
from orchestration.campaigns.store.row_table import KEY, MESSAGE, NUMBER, RowColumns
from orchestration.campaigns.store.store import Store

AT = "at "  # begins the columns of a setting's numbers
CHUNK = 64  # settings after which rows are written
Tell = Callable[[str], None]
Numbers = Mapping[str, float]


@dataclass(frozen=True)
class Row:
    """What was measured at a setting.

    Attributes
    ----------
    numbers
        What was measured, by name; NaN or missing where a run failed or was not made.
    failures
        The sentence of each run that failed, by the name of the run.
    """

    numbers: Numbers
    failures: Mapping[str, str]


@dataclass(frozen=True)
class Survey:
    """What is measured at each setting.

    Attributes
    ----------
    identity
        Text that tells the code that measures from any other.
    units
        Unit of each number of a row, by name; empty for a plain number.
    measure
        Measures one setting with the noise of a seed.
    """

    identity: str
    units: Mapping[str, str]
    measure: Callable[[Numbers, int], Row]

    @property
    def study(self) -> str:
        """Name of the rows of this survey in a store."""
        return hashlib.sha256(self.identity.encode()).hexdigest()[:KEY_LENGTH]

    def key(self, setting: Numbers, seed: int) -> bytes:
        """The key of a row."""
        content = [self.identity, sorted((name, float(value).hex()) for name, value in setting.items()), seed]
        digest = hashlib.blake2b(json.dumps(content).encode(), digest_size=KEY_LENGTH // 2)
        return digest.hexdigest().encode()


def kept_store() -> Store:
    """The store of rows in the user's cache."""
    folder = writable_cache() / "robustness"
    use(cache_folder(), folder.name)
    return Store.open(folder)


def make_rows(survey: Survey, settings: Sequence[Numbers], store: Store, workers: int, tell: Tell) -> list[Row]:
    """Measure settings, and keep the rows; the seed of the noise of a setting is its number plus 1.

    Parameters
    ----------
    settings
        The settings, in the order of their numbers from 0 on.
    workers
        Number of threads.
    tell
        Called with a sentence after every `CHUNK` settings.

    Returns
    -------
    list
        The rows, in the order of the settings.
    """
    names, study = tuple(survey.units), survey.study
    keys = np.array([survey.key(setting, i + 1) for i, setting in enumerate(settings)], f"S{KEY_LENGTH}")
    found = store.find(keys, names, study)
    missing = np.flatnonzero(~found.present)
    columns = RowColumns({f"{AT}{name}": "" for name in settings[0]}, survey.units)
    measured, messages = found.measured, found.messages
    with store.writer(study, columns) as writer, ThreadPoolExecutor(workers) as pool:
        for numbers in _parts(missing):
            rows = pool.map(lambda i: survey.measure(settings[i], int(i) + 1), numbers)
            for i, row in zip(numbers, rows, strict=True):
                measured[i] = [row.numbers.get(name, np.nan) for name in names]
                messages[i] = json.dumps(dict(row.failures)) if row.failures else ""
            factors = {f"{AT}{name}": np.array([settings[i][name] for i in numbers]) for name in settings[0]}
            writer.append(keys[numbers], factors, Outcomes(numbers, measured[numbers], tuple(messages[numbers])))
            done = len(settings) - len(missing) + int(np.searchsorted(missing, numbers[-1])) + 1
            tell(f"{done} of {len(settings)} settings")
    return [_row(names, *pair) for pair in zip(measured, messages, strict=True)]


def kept_rows(store: Store, study: str) -> list[Row]:
    """The rows that a store has of a study, from number 0 up to the first one that is missing.

    Raises
    ------
    StoreError
        If the store has no rows of the study.
    """
    table = store.table(study)
    others = (NUMBER, KEY, MESSAGE)
    names = [name for name in table.column_names if name not in others and not name.startswith(AT)]
    numbers = table[NUMBER].to_numpy()
    n = int((numbers == np.arange(len(numbers))).cumprod().sum())
    measured = np.array([table[name].to_numpy()[:n] for name in names]).T
    return [_row(names, *pair) for pair in zip(measured, table[MESSAGE].to_pylist()[:n], strict=True)]


def identity_of_files(files: Iterable[Path], more: Sequence[str]) -> str:
    """A text that tells the content of files, and further texts, from any other."""
    digest = hashlib.sha256(json.dumps(list(more)).encode())
    for path in files:
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


def _parts(numbers: np.ndarray) -> list[np.ndarray]:
    return [numbers[first : first + CHUNK] for first in range(0, len(numbers), CHUNK)]


def _row(names: Sequence[str], measured: np.ndarray, message: str) -> Row:
    return Row(dict(zip(names, measured.tolist(), strict=True)), json.loads(message) if message else {})
