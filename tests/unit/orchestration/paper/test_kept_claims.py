"""Tests that claims in the cache are measured again if they are damaged."""

from pathlib import Path

import pytest

from orchestration.paper.claims import cache
from orchestration.paper.claims.cache import claims_of
from orchestration.paper.claims.claim import Claim

CLAIM = {"id": "C1", "claim": "text", "measured": "1", "verdict": "holds", "margins": ("worst 1 of <= 2 m",)}


@pytest.mark.parametrize("damage", [b"", b"[]", b"[{"])
@pytest.mark.usefixtures("own_cache")
def test_damaged_claims_are_measured_again(monkeypatch: pytest.MonkeyPatch, own_cache: Path, damage: bytes) -> None:
    monkeypatch.setattr(cache, "_key", lambda _: "key")
    found = [Claim(**{**dict.fromkeys(Claim.__dataclass_fields__, ""), **CLAIM})]
    assert claims_of({}, lambda: found, fresh=False) == (found, False)
    assert claims_of({}, list, fresh=False) == (found, True)
    (own_cache / "claims" / "key.json").write_bytes(damage)
    assert claims_of({}, lambda: found, fresh=False) == (found, False)
    assert claims_of({}, list, fresh=False) == (found, True)
