"""Versions of the Python packages that the checks used last: a record, not a lock.

    uv run python .ci/versions.py            says which installed versions differ from the record
    uv run python .ci/versions.py --write    writes the record, .ci/versions.txt, from what is installed

The record has one line ``name==version`` for each package and names no package index. A difference is
a notice: the ranges in pyproject.toml decide what may be installed.
"""

import importlib.metadata
import sys
from collections.abc import Mapping
from pathlib import Path

RECORD = Path(__file__).with_name("versions.txt")
OURS = "adaptimp"


def installed() -> dict[str, str]:
    """Versions of all installed packages but our own, by name in lower case, in the order of the names."""
    found = {}
    for distribution in importlib.metadata.distributions():
        name = distribution.metadata["Name"].lower().replace("_", "-")
        if name != OURS:
            found[name] = distribution.version
    return dict(sorted(found.items()))


def text_of(versions: Mapping[str, str]) -> str:
    """The record as text."""
    return "".join(f"{name}=={version}\n" for name, version in versions.items())


def read(text: str) -> dict[str, str]:
    """Versions by name from the record's text.

    Raises
    ------
    ValueError
        If a line is not of the form ``name==version``.
    """
    found = {}
    for line in text.splitlines():
        name, mark, version = line.partition("==")
        if not (name and mark and version):
            msg = f"{RECORD.name}: {line!r} is not of the form name==version; write the file again with --write."
            raise ValueError(msg)
        found[name] = version
    return found


def differences(recorded: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    """One phrase for each package whose version differs, which is new, or which is gone."""
    found = []
    for name in sorted({*recorded, *now}):
        before, after = recorded.get(name), now.get(name)
        if before is None:
            found.append(f"{name} {after} is new")
        elif after is None:
            found.append(f"{name} {before} is not installed")
        elif before != after:
            found.append(f"{name} is {after}, was {before}")
    return found


def main() -> None:
    """Write the record with ``--write``; else say what differs from it."""
    if sys.argv[1:] == ["--write"]:
        RECORD.write_text(text_of(installed()), encoding="utf-8")
        return
    found = differences(read(RECORD.read_text(encoding="utf-8")), installed())
    if found:
        sys.stdout.write(f"Notice: versions differ from .ci/{RECORD.name}: {'; '.join(found)}.\n")


if __name__ == "__main__":
    main()
