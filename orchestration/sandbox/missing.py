"""What to say of a path at which there is no file."""

from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path

from orchestration.errors import ArchiveError

MOST_SHOWN = 3
"""How many files of a folder a message shows."""


def require_file(path: Path, kind: str) -> None:
    """Refuse a path at which there is no file.

    Parameters
    ----------
    kind
        What the file should be, such as ``FMU``.

    Raises
    ------
    ArchiveError
        Saying whether the folder is missing, and which files with a near name or the same suffix are there.
    """
    if not path.is_file():
        raise ArchiveError(no_file(path, kind))


def no_file(path: Path, kind: str) -> str:
    """A sentence on a path at which there is no file; see `require_file`."""
    if path.is_dir():
        return f"{path} is a folder; give the path of a {path.suffix or 'file'} file.".replace("file file", "file")
    if not path.parent.is_dir():
        return f"{path}: there is no such {kind}; there is no folder {path.parent.name}."
    others: list[str] = []
    with suppress(OSError):
        others = sorted(p.name for p in path.parent.iterdir() if p.suffix.lower() == path.suffix.lower())
    if close := get_close_matches(path.name, others, MOST_SHOWN):
        return f"{path}: there is no such {kind}; did you mean {' or '.join(close)}?"
    suffix = path.suffix or "such"
    if not others or not path.suffix:
        return f"{path}: there is no such {kind}; its folder has no {suffix} file."
    more = len(others) - MOST_SHOWN
    listed = ", ".join(others[:MOST_SHOWN]) + (f" and {more} more" if more > 0 else "")
    return f"{path}: there is no such {kind}; its folder has {listed}."
