"""Lets numba keep machine code in files, of which a process loads only those that are as they were written."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

from numba.core import caching

from adaptimp_fmu.files.sealed_file import read_sealed, write_sealed


def keep_machine_code(compiled: Any, function: Callable[..., Any], folder: Path | None) -> Any:
    """Let numba keep the machine code of a function in a folder.

    Parameters
    ----------
    compiled
        numba's object for `function`: from ``njit``, or a ``CFunc`` that is not compiled yet.
    folder
        A folder from `orchestration.fmi.machine_code.code_folder`; nothing is kept if it is None.

    Returns
    -------
    object
        `compiled`.
    """
    if folder is not None and compiled is not function:  # it is with NUMBA_DISABLE_JIT=1
        compiled._cache = _cache_in(folder, function)
    return compiled


class _SealedFiles(caching.IndexDataCacheFile):
    """Files of machine code, of which numba sees only those that are as they were written."""

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[Any]:
        written = BytesIO()
        yield written
        write_sealed(Path(filepath), written.getvalue())

    def _load_index(self) -> Any:
        return {} if read_sealed(Path(self._index_path)) is None else super()._load_index()

    def _load_data(self, name: str) -> Any:
        path = Path(self._data_path(name))
        if read_sealed(path) is None:
            raise FileNotFoundError(path)  # numba compiles the function again
        return super()._load_data(name)  # pickle reads no further than the seal


def _cache_in(folder: Path, function: Callable[..., Any]) -> caching.FunctionCache:
    """Return numba's cache in a folder whose name stands for the sources."""

    class Locator(caching._CacheLocator):
        _py_file = function.__code__.co_filename  # numba's warnings name it

        def get_cache_path(self) -> Any:
            return str(folder)

        def get_source_stamp(self) -> Any:
            return folder.name

        def get_disambiguator(self) -> Any:
            return str(function.__code__.co_firstlineno)

        @classmethod
        def from_function(cls, py_func: Any, py_file: str) -> Any:  # noqa: ARG003 - numba gives both
            return cls()

    class Results(caching.CompileResultCacheImpl):
        _locator_classes = (Locator,)

    class Cache(caching.FunctionCache):
        _impl_class = Results

        def __init__(self, py_func: Any) -> None:
            super().__init__(py_func)
            self._cache_file = _SealedFiles(str(folder), self._impl.filename_base, folder.name)

        def load_overload(self, sig: Any, target_context: Any) -> Any:
            try:
                return super().load_overload(sig, target_context)
            except OSError:
                self.disable()
            return None

        def save_overload(self, sig: Any, data: Any) -> None:
            try:
                super().save_overload(sig, data)
            except OSError:
                self.disable()  # a full or locked disk: the next process compiles again

    return Cache(function)
