"""The longer notebooks of the documentation: their cells run in IPython, and find what their texts say."""

import json
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest
from IPython.core.interactiveshell import InteractiveShell
from IPython.terminal.ipapp import load_default_config

DOCS = Path(__file__).parents[2] / "docs"


class Shell(InteractiveShell):
    """An IPython for which ``%matplotlib inline`` needs no windows."""

    def enable_gui(self, gui: str | None = None) -> None:
        """Do nothing."""


def shown(name: str, folder: Path) -> list[Any]:
    """What the cells of a notebook evaluate to, in their order; a cell that fails is raised."""
    saved = json.loads((DOCS / name).read_text(encoding="utf-8"))
    assert not any(cell.get("outputs") for cell in saved["cells"]), "the site executes it; save it without outputs"
    config = load_default_config(str(folder))
    config.HistoryManager.enabled = False
    shell, found = Shell(config=config, ipython_dir=str(folder)), []
    for cell in saved["cells"]:
        if cell["cell_type"] == "code":
            run = shell.run_cell("".join(cell["source"]))
            run.raise_error()
            found.append(run.result)
    plt.close("all")
    return found


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty folder, and pictures without windows."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")


def test_a_leak_costs_what_the_notebook_says(tmp_path: Path) -> None:
    name, same, estimates, _, errors = shown("change-an-adaptation-law.ipynb", tmp_path)
    assert name == "Leaky.fmu"
    assert same, "without a leak it is algorithm 2"
    assert list(estimates) == sorted(estimates)
    assert list(estimates.values()) == sorted(estimates.values()), "the larger the leak, the farther from 1 kg"
    assert abs(estimates[0.0] - 1.0) < 2e-3  # kg; rounded to 1e-3 kg in the notebook
    assert list(errors.values()) == sorted(errors.values()), "and the larger the error"
    assert errors[1.0] > errors[0.0]


def test_the_peak_does_not_depend_on_the_stiffness(tmp_path: Path) -> None:
    _, peaks, figure, allowed, repeated = shown("which-stiffness.ipynb", tmp_path)
    assert (peaks.max() - peaks.min()).max() < 10, "rows differ by a few newtons"
    assert peaks.max(axis="columns").min() > 1000  # N, of the hardest wall
    assert figure.axes[0].get_xlabel() == "K (N/m)" or figure.axes[0].get_ylabel() == "K (N/m)"
    assert list(allowed) == [500, 794, 1260, 2000]
    assert max(allowed.values()) < 12.0  # N.s
    assert repeated
