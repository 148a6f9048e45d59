"""Figures are drawn without a trace: a notebook that draws them keeps its backend and its settings."""

import json
import subprocess
import sys
from pathlib import Path
from typing import IO

import numpy as np
import pytest
from matplotlib.figure import Figure

from orchestration import Result
from orchestration.paper.figures.draw import draw
from orchestration.paper.figures.style import FigureCanvasAgg, new_figure

# Another backend than Agg that needs no screen, and a setting of the caller's own.
SCRIPT = """
import json, sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["lines.linewidth"] = 3.25
before = dict(matplotlib.rcParams)

from orchestration.paper.built_fmus import fmus
from orchestration.paper.figures.draw import draw
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.scenarios import SCENARIOS

files = draw({"fig2": Laboratory(fmus(SCENARIOS["fig2"].models.values())).run(Job("fig2"))}, Path(sys.argv[1]))
changed = [name for name, value in before.items() if matplotlib.rcParams[name] != value]
print(json.dumps({
    "backend": matplotlib.get_backend(),
    "changed": changed,
    "pyplot": "matplotlib.pyplot" in sys.modules,
    "files": [file.name for file in files],
}))
"""


def test_importing_and_drawing_leaves_matplotlib_as_it_was(tmp_path: Path) -> None:
    command = [sys.executable, "-W", "error", "-c", SCRIPT, str(tmp_path)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert ended.returncode == 0, ended.stderr
    assert json.loads(ended.stdout) == {
        "backend": "svg",
        "changed": [],
        "pyplot": False,
        "files": ["fig1.png", "fig2.png"],
    }
    assert (tmp_path / "fig2.png").stat().st_size > 10_000


def test_a_figure_that_cannot_be_finished_leaves_the_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kill in the middle of drawing left half a picture in the place of a good one."""

    def half_drawn(_: object, file: IO[bytes], **__: object) -> None:
        file.write(b"half a picture")
        raise KeyboardInterrupt

    monkeypatch.setattr("orchestration.paper.figures.draw._figures", lambda _: {"fig2": Figure()})
    monkeypatch.setattr(Figure, "savefig", half_drawn)
    (tmp_path / "fig2.png").write_bytes(b"the old one")
    with pytest.raises(KeyboardInterrupt):
        draw({"fig2": Result(np.zeros(1), (), np.zeros((1, 0)))}, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"fig2.png": b"the old one"}


def test_every_figure_has_an_agg_canvas() -> None:
    assert isinstance(new_figure(2, 2, "")[0].canvas, FigureCanvasAgg)
