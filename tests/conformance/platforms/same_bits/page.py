"""Reads and writes the hashes in docs/same-bits.md."""

import re
from collections.abc import Iterable
from pathlib import Path

from tests.conformance.platforms.same_bits.proof import Proof

PAGE = Path(__file__).parents[4] / "docs" / "same-bits.md"
_ROW = re.compile(r"^\| (fig\d) \| ([\d ]+) \| (\d+) \| `([0-9a-f]{64})` \|\n", re.MULTILINE)


def hashes() -> dict[str, str]:
    """SHA-256 of all rows of each figure, as the page has them."""
    return {figure: found for figure, _, _, found in _ROW.findall(PAGE.read_text(encoding="utf-8"))}


def with_hashes(text: str, proofs: Iterable[Proof]) -> str:
    """The page with the hashes of other proofs in its table."""
    rows = {p.figure: f"| {p.figure} | {p.rows} | {p.columns} | `{next(iter(p.hashes.values()))}` |\n" for p in proofs}
    return _ROW.sub(lambda row: rows.get(row[1], row[0]), text)


def write(proofs: Iterable[Proof]) -> None:
    """Write the hashes into the table of the page."""
    PAGE.write_text(with_hashes(PAGE.read_text(encoding="utf-8"), proofs), encoding="utf-8")
