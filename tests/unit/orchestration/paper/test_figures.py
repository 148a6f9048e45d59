"""Figures are drawn without a trace: a notebook that draws them keeps its backend and its settings."""

import json
import subprocess
import sys
from pathlib import Path

from orchestration.paper.figures import FigureCanvasAgg, _panels

# Another backend than Agg that needs no screen, and a setting of the caller's own.
SCRIPT = """
import json, sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["lines.linewidth"] = 3.25
before = dict(matplotlib.rcParams)

from orchestration.paper.built_fmus import fmus
from orchestration.paper.figures import draw
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
    assert json.loads(ended.stdout) == {"backend": "svg", "changed": [], "pyplot": False, "files": ["fig2.png"]}
    assert (tmp_path / "fig2.png").stat().st_size > 10_000


def test_every_figure_has_an_agg_canvas() -> None:
    assert isinstance(_panels()[0].canvas, FigureCanvasAgg)
