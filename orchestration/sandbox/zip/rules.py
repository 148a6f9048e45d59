"""The error of an archive that breaks a rule, how messages show names of strangers, and the limits of size."""

from orchestration.errors import ArchiveError

MAX_ENTRIES = 20_000  # of one archive
MAX_ALL_ENTRIES = 100_000  # of an archive and all archives in it
MAX_DIRECTORY = 32 * 1024**2  # bytes of the directory
MAX_BYTES = 2 * 1024**3  # of all entries after unpacking, those of archives in the archive included
MAX_RATIO = 1000  # unpacked over packed size of an entry; source code and tables reach 30, a zip bomb 1000
RATIO_FREE_BYTES = 1024**2  # the ratio of smaller entries is not limited
MAX_TOTAL_RATIO = 300  # unpacked size of all entries over the size of the file
TOTAL_RATIO_FREE_BYTES = 256 * 1024**2  # the total ratio of smaller archives is not limited
MAX_NESTING = 4  # archives in archives: a package, a package in it, an FMU, an archive in its resources
MAX_NAME = 255  # bytes of the name of a file or folder
MAX_PATH = 1024  # bytes of the path of an entry
MAX_DEPTH = 64  # folders of a path
_LONGEST_SHOWN = 80


class RuleError(ArchiveError):
    """An archive breaks a rule; the message is the end of a sentence whose subject is the archive's file."""


def shown(name: str) -> str:
    """Quote a name of an archive for a message: printable, and short."""
    kept = name if len(name) <= _LONGEST_SHOWN else f"{name[: _LONGEST_SHOWN // 2]}...{name[-_LONGEST_SHOWN // 2 :]}"
    quoted = ascii(kept) if not kept.isprintable() else repr(kept)
    return quoted if len(quoted) <= 2 * _LONGEST_SHOWN else f"{quoted[:_LONGEST_SHOWN]}...'"


class Budget:
    """Sums the sizes of an archive and of all archives in it, and refuses what would fill the disk.

    Parameters
    ----------
    file_size
        Bytes of the outermost archive's file.
    """

    def __init__(self, file_size: int) -> None:
        self._file_size, self._entries, self._bytes = file_size, 0, 0

    def spend(self, entries: int, size: int) -> None:
        """Count the entries of one archive, and their bytes after unpacking.

        Raises
        ------
        RuleError
            If a sum is more than its limit.
        """
        self._entries += entries
        self._bytes += size
        if self._entries > MAX_ALL_ENTRIES:
            msg = f"has, with the archives in it, {self._entries} entries, more than {MAX_ALL_ENTRIES}"
            raise RuleError(msg)
        if self._bytes > MAX_BYTES:
            msg = f"would unpack to {self._bytes} bytes, more than {MAX_BYTES}"
            raise RuleError(msg)
        if self._bytes > max(TOTAL_RATIO_FREE_BYTES, MAX_TOTAL_RATIO * self._file_size):
            msg = (
                f"would unpack from {self._file_size} to {self._bytes} bytes, more than {MAX_TOTAL_RATIO} times its"
                " size: a zip bomb"
            )
            raise RuleError(msg)
