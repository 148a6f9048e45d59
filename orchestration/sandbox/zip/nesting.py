"""Looks into the archives that lie in an archive, and into those that lie in them.

FMUs and packages in an archive must keep all rules. Of other archives, such as one of Java in an FMU's resources,
only the sizes and the nesting count: nothing here opens them.
"""

import tempfile
from pathlib import PurePosixPath

from orchestration.sandbox.zip.content import Content
from orchestration.sandbox.zip.directory import Entry, read_directory
from orchestration.sandbox.zip.layout import HEADER
from orchestration.sandbox.zip.rules import MAX_NESTING, Budget, RuleError, shown

_OPENED_HERE = (".fmu", ".ssp")
_IN_MEMORY = 16 * 1024**2  # bytes of an inner archive that need no file


def look_inside(content: Content, budget: Budget, depth: int = 1) -> None:
    """Refuse an archive that holds an unsafe one, or archives that are nested too deep.

    Parameters
    ----------
    content
        Archive whose own entries were counted.
    budget
        Sum of all sizes until now.
    depth
        Number of archives around the entries of `content`, itself included.

    Raises
    ------
    RuleError
        Naming the inner archive and its fault.
    """
    for entry in content.entries:
        opened_here = PurePosixPath(entry.name).suffix.lower() in _OPENED_HERE
        if entry.is_folder or not (opened_here or content.read(entry, len(HEADER)) == HEADER):
            continue
        if depth == MAX_NESTING:
            msg = f"entry {shown(entry.name)} lies in {depth} archives and is one itself; {MAX_NESTING} are allowed"
            raise RuleError(msg)
        try:
            _look_into(content, entry, (budget, depth), opened_here=opened_here)
        except RuleError as error:
            inner = str(error).removeprefix(_WITHIN)
            msg = f"{_WITHIN}{shown(entry.name)}: {inner}"
            raise RuleError(msg) from error


_WITHIN = "its archive "


def _look_into(content: Content, entry: Entry, spent: tuple[Budget, int], *, opened_here: bool) -> None:
    """Count an archive that is an entry, and look inside."""
    budget, depth = spent
    with tempfile.SpooledTemporaryFile(_IN_MEMORY) as file:
        file.writelines(content.pieces(entry))
        file.seek(0)
        try:
            entries = read_directory(file).entries
        except RuleError:
            if opened_here:
                raise
            return  # a file that only begins like an archive is no more than data
        budget.spend(len(entries), sum(e.size for e in entries))
        try:
            inner = Content(file)
        except RuleError:
            if opened_here:
                raise
            return
        look_inside(inner, budget, depth + 1)
