"""Files that exist only when they are complete, whatever ends the process that writes them.

A file is written as a draft, ``NAME.<random>.part``, in the same folder. At the end the draft moves to the path of the
file in one step of the file system. So two processes that write one file do not meet: the later one wins as a whole.
The draft of a process that was killed is removed when the same file is written next.
"""

import errno
import os
import secrets
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from adaptimp_fmu.files.locks import lock_of_dead_owner, locked_new_file

SUFFIX = ".part"
LONGEST_NAME = 255  # bytes of a file name on most file systems
_RANDOM = 6  # bytes in the name of a draft


class Draft:
    """The draft of a file, open for writing.

    Parameters
    ----------
    path
        Path of the file. Its folder is made if need be.
    rescue
        Called with the path of each draft of the same file that a dead process left, before the draft is removed.

    Attributes
    ----------
    file
        The open draft, in binary mode.
    place
        Path of the draft.

    Raises
    ------
    OSError
        If the draft cannot be made.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.whole_file import Draft
    >>> draft = Draft(Path("letter.txt"))
    >>> draft.file.write(b"Dear reader")
    11
    >>> Path("letter.txt").exists()
    False
    >>> draft.publish()
    >>> Path("letter.txt").read_text()
    'Dear reader'
    """

    def __init__(self, path: Path, rescue: Callable[[Path], object] | None = None) -> None:
        if len(os.fsencode(path.name)) > LONGEST_NAME:  # better now than when all is written
            raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG), str(path))
        path.parent.mkdir(parents=True, exist_ok=True)
        for left in _of_dead_processes(path):
            if rescue is not None:
                rescue(left)
        self.path = path
        self.place, self.file = _opened(path)

    def publish(self, path: Path | None = None) -> None:
        """Move the complete draft to the path of the file, or to another path in the same folder.

        Raises
        ------
        OSError
            If the last bytes cannot be written, or something other than a file stands at the path.
        """
        self.file.flush()
        if os.name == "nt":  # there an open file cannot be moved; elsewhere its lock lasts until it has moved
            self.file.close()
        self.place.replace(path or self.path)
        self.file.close()

    def abandon(self) -> None:
        """Close and remove the draft; the file at the path stays as it is. A second call does nothing."""
        with suppress(OSError):  # the bytes are not wanted, so it does not matter that they do not fit
            self.file.close()
        with suppress(OSError):
            self.place.unlink(missing_ok=True)


@contextmanager
def whole_file(path: Path) -> Iterator[IO[bytes]]:
    """Write a file that appears when the context ends without an exception.

    Yields
    ------
    file
        A file to write bytes to.

    Raises
    ------
    OSError
        If the file cannot be written. Then an existing file at the path stays as it is.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.whole_file import whole_file
    >>> with whole_file(Path("numbers.txt")) as file:
    ...     written = file.write(b"1 2 3")
    >>> Path("numbers.txt").read_bytes()
    b'1 2 3'
    """
    draft = Draft(path)
    try:
        yield draft.file
        draft.publish()
    except BaseException:
        draft.abandon()
        raise


def write_whole(path: Path, content: bytes) -> None:
    """Write a file in one go; errors as of `whole_file`.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.whole_file import write_whole
    >>> write_whole(Path("claims.json"), b"[]")
    >>> Path("claims.json").read_bytes()
    b'[]'
    """
    with whole_file(path) as file:
        file.write(content)


def write_together(contents: Mapping[Path, bytes]) -> None:
    """Write several files that belong together: all of them, or none if one of them cannot be written.

    Raises
    ------
    OSError
        If a file cannot be written. Then existing files at the paths stay as they are.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.whole_file import write_together
    >>> write_together({Path("fig5.wasm"): b"code", Path("fig5.json"): b"{}"})
    >>> Path("fig5.json").read_bytes()
    b'{}'
    """
    for path in contents:
        if path.is_dir():  # better now than when some files are there
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    drafts: list[Draft] = []
    try:
        for path, content in contents.items():
            drafts.append(Draft(path))
            drafts[-1].file.write(content)
            drafts[-1].file.flush()
        for draft in drafts:
            draft.publish()
    except BaseException:
        for draft in drafts:
            draft.abandon()
        raise


def _opened(path: Path) -> tuple[Path, IO[bytes]]:
    """A new draft of a file."""
    while True:
        place = path.with_name(f"{_stem(path)}.{secrets.token_hex(_RANDOM)}{SUFFIX}")
        with suppress(FileExistsError):
            descriptor = locked_new_file(place)
            if descriptor is not None:
                return place, os.fdopen(descriptor, "wb")


def _of_dead_processes(path: Path) -> Iterator[Path]:
    """Drafts of a file whose processes have ended; each is removed after it was yielded."""
    start, length = f"{_stem(path)}.", len(_stem(path)) + 1 + 2 * _RANDOM + len(SUFFIX)
    with os.scandir(path.parent) as entries:
        found = [e.name for e in entries if e.name.startswith(start) and e.name.endswith(SUFFIX)]
    for place in [path.with_name(name) for name in found if len(name) == length]:
        descriptor = lock_of_dead_owner(place)
        if descriptor is not None:
            try:
                yield place
                place.unlink(missing_ok=True)
            finally:
                os.close(descriptor)


def _stem(path: Path) -> str:
    """The beginning of the names of all drafts of a file, shortened so that they are no longer than names may be."""
    return shortened(path.name, LONGEST_NAME - 1 - 2 * _RANDOM - len(SUFFIX))


def shortened(name: str, most: int) -> str:
    """Return the beginning of a file name that takes at most a number of bytes.

    Examples
    --------
    >>> from adaptimp_fmu.files.whole_file import shortened
    >>> shortened("torques", 3)
    'tor'
    """
    while len(os.fsencode(name)) > most:
        name = name[:-1]
    return name
