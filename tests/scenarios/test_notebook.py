"""The notebook in the documentation runs in IPython, and what it shows is short, valid and needs no other file."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import pytest
from IPython.core.completer import provisionalcompleter
from IPython.core.interactiveshell import InteractiveShell
from IPython.terminal.ipapp import load_default_config
from lxml import etree, html

from orchestration import Connection, Fmu, Options, PowerBond, ledger, prepare, scenario, simulate

NOTEBOOK = Path(__file__).parents[2] / "docs" / "twelve-lines.ipynb"
MOST_LINES = 12
MOST_CHARACTERS = 1500
OUTSIDE = re.compile(r"<(script|link|img|iframe)\b|\b(src|href)=|url\((?!#)|@import")


class Shown(NamedTuple):
    """What a cell shows: an object, and its representations by media type."""

    object: Any
    data: dict[str, str]


@pytest.fixture(scope="module")
def shell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[InteractiveShell]:
    """An IPython of its own, without history."""
    folder = str(tmp_path_factory.mktemp("ipython"))
    config = load_default_config(folder)
    config.HistoryManager.enabled = config.Completer.use_jedi = False
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("IPYTHONDIR", folder)
        patch.setenv("MPLBACKEND", "Agg")
        yield InteractiveShell(config=config, ipython_dir=folder)
        plt.close("all")


def cells() -> list[str]:
    """Code of the notebook, cell by cell."""
    found = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in found if cell["cell_type"] == "code"]


def shown(shell: InteractiveShell, found: Any) -> Shown:
    """An object as a notebook shows it."""
    formatter: Any = shell.display_formatter
    return Shown(found, formatter.format(found)[0])


@pytest.fixture(scope="module")
def outputs(shell: InteractiveShell) -> list[Shown]:
    """What the cells show when they are run in their order."""
    found = []
    for cell in cells():
        run = shell.run_cell(cell)
        run.raise_error()
        found.append(shown(shell, run.result))
    return found


def assert_readable(output: Shown) -> None:
    """Require a short text, and HTML that is well-formed and loads nothing."""
    assert 0 < len(output.data["text/plain"]) <= MOST_CHARACTERS
    assert " object at 0x" not in output.data["text/plain"]
    if not type(output.object).__module__.startswith("orchestration"):
        return
    assert "text/html" in output.data
    page = output.data["text/html"]
    etree.fromstring(f"<div>{page}</div>")
    assert html.fromstring(page).text_content().strip()
    assert not OUTSIDE.search(page)


def test_the_notebook_has_twelve_lines_at_most() -> None:
    assert sum(bool(line.strip()) for cell in cells() for line in cell.splitlines()) <= MOST_LINES
    saved = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    assert saved["nbformat"] == 4
    assert not any(cell.get("outputs") for cell in saved["cells"])


def test_every_cell_shows_something_readable(outputs: list[Shown]) -> None:
    for output in outputs:
        assert_readable(output)


def test_the_cells_do_what_they_say(outputs: list[Shown]) -> None:
    system, result, panels, tip, driven, comparison = (output.object for output in outputs)
    assert not system.unconnected_inputs()
    assert result["plant.F_ext"].min() < -100  # N; the arm meets the wall
    assert [panel.get_ylabel() for panel in panels] == ["plant.x (m)", "plant.F_ext (N)"]
    assert tip.attrs == {"units": "m"}
    np.testing.assert_array_equal(driven["plant.x"], result["plant.x"][: len(driven.time)])
    assert "controller.s[1]" in comparison.only_in_second  # the sliding variable of the other controller


def test_nothing_else_is_long_or_unreadable(shell: InteractiveShell) -> None:
    system = scenario("fig5")
    bonded = scenario("fig2")
    direct = type(bonded).of({name: bonded[name] for name in ("trajectory", "sensor", "controller", "plant")})
    direct = direct.connect().connect("controller.tau_cmd -> plant.tau")
    result = simulate(direct, stop_time=0.2, step=1e-4)
    with Fmu(system["plant"].path) as plant, prepare(bonded, 0.01) as run:
        for found in (system, system["controller"], result, bonded.stability(), plant, plant.variables):
            assert_readable(shown(shell, found))
        snapshot = run.save()
        texts = (
            *(run, snapshot, Options(), run.algorithm, system.connections, system.components, plant.description),
            *(plant.variables["x[1]"], Connection("a", "x", "b", "y"), plant.outputs()),
            ledger(result, PowerBond("controller.tau_cmd[1]", "plant.dq[1]"), direct),
            *(result.to_pandas(), result.to_xarray()["plant.x"]),
        )
        for found in texts:
            assert 0 < len(shown(shell, found).data["text/plain"]) <= MOST_CHARACTERS


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ('system["con', {"controller"}),
        ('plant["m', {"m", "m[1]", "m[2]", "mu"}),
        ('result["plant.d', {"plant.dq", "plant.dq[1]", "plant.dx", "plant.ddq[2]"}),
        ('result["ti', {"time"}),
    ],
)
@pytest.mark.usefixtures("outputs")
def test_keys_are_completed(shell: InteractiveShell, typed: str, expected: set[str]) -> None:
    shell.run_cell('plant = system["plant"]').raise_error()
    with provisionalcompleter():
        completed = {completion.text for completion in shell.Completer.completions(typed, len(typed))}
    assert expected <= completed
