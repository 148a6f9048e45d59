"""The content of an archive that keeps the rules for its directory, its layout and its names."""

from collections.abc import Iterator
from typing import IO

from orchestration.sandbox.zip.data import pieces
from orchestration.sandbox.zip.directory import Entry, read_directory
from orchestration.sandbox.zip.layout import places_of_data
from orchestration.sandbox.zip.names import require_safe


class Content:
    """The entries of an open archive, whose data can be unpacked.

    Parameters
    ----------
    file
        Open file, from its beginning.

    Attributes
    ----------
    entries
        All entries, in the order of the directory.
    formalities
        Sentences on rules of form that the archive breaks, and that make it no less safe.

    Raises
    ------
    RuleError
        If the archive breaks a rule that makes it unsafe.
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        directory = read_directory(file)
        self.entries = directory.entries
        self.formalities = tuple(require_safe(directory.entries))
        places = places_of_data(file, directory)
        self._places = {id(entry): place for entry, place in zip(directory.entries, places, strict=True)}

    @property
    def size(self) -> int:
        """Bytes of all entries after unpacking."""
        return sum(entry.size for entry in self.entries)

    def pieces(self, entry: Entry) -> Iterator[bytes]:
        """Iterate over the data of an entry.

        Raises
        ------
        RuleError
            If the data are damaged.
        """
        return pieces(self._file, entry, self._places[id(entry)])

    def read(self, entry: Entry, most: int) -> bytes:
        """Return the data of an entry, or their first bytes.

        Raises
        ------
        RuleError
            If the data are damaged, as far as they are read.
        """
        found = bytearray()
        for piece in self.pieces(entry):
            found += piece
            if len(found) >= most:
                break
        return bytes(found[:most])
