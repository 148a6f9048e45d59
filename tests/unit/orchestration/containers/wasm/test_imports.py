"""The imports of a module are read from its bytes."""

from pathlib import Path

import pytest

from orchestration.containers.wasm.imports import imported_names
from tests.unit.examples import failures, has_example

MAGIC = b"\0asm\1\0\0\0"
TYPES = b"\1\4\1\x60\0\0"
LONG = b"f" * 300


def section(content: bytes) -> bytes:
    """Section 2 with its content; its size takes two bytes."""
    return bytes([2, len(content) & 0x7F | 0x80, len(content) >> 7]) + content


@pytest.mark.parametrize(
    ("module", "names"),
    [
        (MAGIC, []),
        (MAGIC + TYPES, []),
        (MAGIC + TYPES + section(b"\0"), []),
        (MAGIC + TYPES + section(b"\2\1a\1f\0\0\1b\2gh\0\0"), ["f", "gh"]),
        (MAGIC + section(b"\1\1a\xac\2" + LONG + b"\0\0"), [LONG.decode()]),
        (MAGIC + section(b"\2\3env\6memory\2\0\1\1b\1f\0\0"), ["memory"]),
    ],
)
def test_imports(module: bytes, names: list[str]) -> None:
    assert imported_names(module) == names


@pytest.mark.parametrize("content", [b"", b"\0asm", b"\x7fELF\0\0\0\0"])
def test_other_bytes_are_refused(content: bytes) -> None:
    with pytest.raises(ValueError, match="not the bytes of a module"):
        imported_names(content)


def test_the_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert has_example(imported_names)
    assert failures("imported_names", imported_names, tmp_path, monkeypatch) == ""
