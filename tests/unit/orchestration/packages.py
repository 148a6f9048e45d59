"""Changes packages like a stranger's tool would, and compares systems."""

import re
import zipfile
from collections.abc import Callable
from pathlib import Path

from orchestration import System

SSD_FILE = "SystemStructure.ssd"
Edit = Callable[[str], str]


def edited(package: Path, name: str, edit: Edit) -> Path:
    """A copy of a package with one text file changed."""
    copy = package.with_name("edited.ssp")
    with zipfile.ZipFile(package) as old, zipfile.ZipFile(copy, "w") as new:
        for entry in old.namelist():
            content = old.read(entry)
            if entry == name:
                changed = edit(content.decode()).encode()
                assert changed != content
                content = changed
            new.writestr(entry, content)
    return copy


def substitute(pattern: str, replacement: str) -> Edit:
    """An edit of the first match."""
    return lambda text: re.sub(pattern, replacement, text, count=1, flags=re.DOTALL)


def same(a: System, b: System) -> bool:
    """Whether two systems run alike; their FMUs may lie in different places."""
    units = [[(c.name, c.description.guid, c.start) for c in s.components] for s in (a, b)]
    return units[0] == units[1] and (a.name, a.connections, a.step, a.stop_time) == (
        b.name,
        b.connections,
        b.step,
        b.stop_time,
    )
