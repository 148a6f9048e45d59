"""README.md leads from a clone to the picture of a run with a re-tuned controller, in six commands typed here."""

import re
import subprocess
import sysconfig
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from orchestration import Result, scenario, simulate

ROOT = Path(__file__).parents[2]
MOST = 6  # commands
HOURS = 3600.0  # s, far beyond what the commands take on a busy machine
SHELL = f"""set -e
export PATH="{sysconfig.get_path("scripts")}:$PATH"
git() {{ test "$1" = clone; mkdir "$3"; }}
pip() {{ test "$*" = "install uv"; }}
uv() {{ test "$1" = run; shift; "$@"; }}
"""
"""What is different from a reader's machine: nothing is fetched or installed, and the clone is an empty folder."""


def commands() -> list[str]:
    """The commands of the page."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```sh\n(git clone .*?)^```$", text, re.MULTILINE | re.DOTALL)
    return block.splitlines()


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The reader's clone after the commands."""
    folder = tmp_path_factory.mktemp("reader")
    done = subprocess.run(
        ["sh", "-c", SHELL + "\n".join(commands())],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=HOURS,
    )
    assert done.returncode == 0, done.stderr
    return folder / "adaptimp"


def test_there_are_at_most_six() -> None:
    assert len(commands()) <= MOST
    assert not any(re.search(r"&&|;|\\$", line) for line in commands())


def test_the_run_is_that_of_the_shipped_law_with_other_gains(clone: Path) -> None:
    """Bit for bit over the first rows, since nobody has edited the law; the shipped gains give other rows."""
    found = Result.read(clone / "mine" / "fig5.parquet")
    assert found.status == "complete"
    softer = simulate(scenario("fig5"), 0.01)
    stiffer = simulate(scenario("fig5").set({"controller.K": [8000.0, 8000.0]}), 0.01)
    n = len(stiffer.time)
    assert np.array_equal(found["plant.x"][:n], stiffer["plant.x"])
    assert not np.array_equal(found["plant.x"][:n], softer["plant.x"])


def test_the_picture_shows_more_than_an_empty_panel(clone: Path) -> None:
    picture = imread(clone / "mine" / "fig5.png")
    assert min(picture.shape[:2]) > 500  # pixels
    assert len(np.unique(picture.reshape(-1, picture.shape[2]), axis=0)) > 50  # colours
