"""Changes packages like a stranger's tool would, and compares systems."""

import re
import zipfile
from collections.abc import Callable
from dataclasses import replace
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
    """Whether two systems are equal; their FMUs may lie in different places."""
    return placeless(a) == placeless(b)


def placeless(system: System) -> System:
    """The system with its FMUs nowhere."""
    components = [replace(c, description=replace(c.description, path=Path())) for c in system.components]
    return replace(system, components=tuple(components))
