"""What to say of a path at which there is no file."""

from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path

from orchestration.errors import ArchiveError

LONGEST_PATH = 200
"""Characters of a path that a message shows if the file system refuses the path."""
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
    try:
        found = path.is_file()
    except OSError as error:
        msg = f"{_shortened(path)}: this {kind} cannot be looked up: {error.strerror}."
        raise ArchiveError(msg) from error
    if not found:
        raise ArchiveError(no_file(path, kind))


def _shortened(path: Path) -> str:
    """The path for a message, without the middle of a name that is too long for a file system."""
    text = str(path)
    return text if len(text) <= LONGEST_PATH else f"{text[: LONGEST_PATH // 2]}...{text[-LONGEST_PATH // 2 :]}"


def no_file(path: Path, kind: str) -> str:
    """A sentence on a path at which there is no file; see `require_file`."""
    if path.is_symlink():
        return f"{path} is a link that leads to no {kind}; give the path of the {kind} itself."
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
