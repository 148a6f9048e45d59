"""A campaign that is killed and taken up again ends as an undisturbed one: a few of `tests.faults.campaign_kills`."""

import sys
from pathlib import Path

import pytest

from tests.faults.campaign_kills import kill

KILLS = 5


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_a_killed_campaign_is_continued_without_loss_and_without_repetition(tmp_path: Path) -> None:
    trial = kill(KILLS, 7, tmp_path)
    assert trial.faults == []
    assert trial.kills == KILLS
    assert trial.met > 0
