"""A small loop to vary, and an engine that makes each run by `simulate`."""

from pathlib import Path

import pytest

from orchestration import System
from orchestration.campaigns import evaluator, running
from tests.unit.orchestration.campaigns.plain import PlainEngine
from tests.unit.orchestration.small_models import mixed


@pytest.fixture
def loop(small: dict[str, Path]) -> System:
    """Real, Integer and Boolean signals, sampled and continuous FMUs, one feedback; 4 steps.

    Without an offset, x is doubled and held over each step: x(4) = x_start (1 + 2 H)^4.
    """
    return mixed(small, steps=4)


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes all runs of studies one by one by `simulate`, so that nothing is compiled."""
    monkeypatch.setattr(running, "engine_for", PlainEngine)
    monkeypatch.setattr(evaluator, "engine_for", PlainEngine)
