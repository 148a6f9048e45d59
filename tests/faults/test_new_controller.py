"""Evidence that ``adaptimp new controller`` gives what it promises, and refuses what cannot be."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fmus.catalog import MODELS
from orchestration import scenario, simulate
from orchestration.cli.new_controller import BEGINNINGS
from tests.faults.cli import Command

HOURS = 3600.0  # s, far beyond what a process of these tests takes on a busy machine


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, in which commands work."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def new(adaptimp: Command, *arguments: object) -> str:
    """What is said about a controller that was begun."""
    outcome = adaptimp("new", "controller", *arguments)
    assert (outcome.code, outcome.err) == (0, "")
    return outcome.out


@pytest.mark.parametrize("law", [None, *BEGINNINGS])
def test_its_own_test_passes_at_once(adaptimp: Command, here: Path, law: str | None) -> None:
    new(adaptimp, "Mine", *(("--from", law) if law else ()))
    command = [sys.executable, "-m", "pytest", "-q", "-W", "error", "-p", "no:cacheprovider", "test_Mine.py"]
    done = subprocess.run(command, cwd=here, capture_output=True, text=True, check=False, timeout=HOURS)
    assert done.returncode == 0, done.stdout
    assert f"{4 if law else 3} passed" in done.stdout


@pytest.mark.parametrize("law", BEGINNINGS)
def test_it_is_the_shipped_controller_until_it_is_edited(adaptimp: Command, here: Path, law: str) -> None:
    """Bit for bit, in the scenario of the law, and no longer once a line has changed."""
    new(adaptimp, "Mine", "--from", law)
    assert adaptimp("build", "Mine.py", "-o", ".").code == 0
    shipped = scenario(BEGINNINGS[law].scenario)
    assert shipped["controller"].description.model_name == BEGINNINGS[law].shipped
    mine = shipped.replace("controller", here / "Mine.fmu")
    assert mine.notices == shipped.notices
    expected, found = simulate(shipped, 0.02), simulate(mine, 0.02)
    assert found.names == expected.names
    assert all(np.array_equal(found[name], expected[name]) for name in expected.names)

    text = (here / "Mine.py").read_text(encoding="utf-8")
    assert "\ntau_cmd = " in text
    (here / "Mine.py").write_text(text.replace("\ntau_cmd = ", "\ntau_cmd = 0.99 * ", 1), encoding="utf-8")
    assert adaptimp("build", "Mine.py", "-o", ".").code == 0
    changed = simulate(shipped.replace("controller", here / "Mine.fmu"), 0.02)
    assert not np.array_equal(changed["plant.x"], expected["plant.x"])


@pytest.mark.parametrize("law", [None, *BEGINNINGS])
def test_files_are_short_and_formatted(adaptimp: Command, here: Path, law: str | None) -> None:
    new(adaptimp, "Mine", *(("--from", law) if law else ()))
    for name in ("Mine.py", "test_Mine.py"):
        text = (here / name).read_text(encoding="utf-8")
        assert len(text.splitlines()) < 70
        assert max(map(len, text.splitlines())) <= 120
    own = ["--line-length", "120"]
    for command in (
        ["format", "--diff", *own],
        ["check", "--isolated", "--select", "E,F,W,B", "--ignore", "E741", *own],
    ):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *command, "."], cwd=here, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout


def test_the_commands_that_it_names_work(adaptimp: Command, here: Path) -> None:
    """All but the test, which has a test of its own above."""
    said = new(adaptimp, "Mine", "-o", "my folder").splitlines()
    assert said[:4] == [
        "wrote my folder/Mine.py",
        "wrote my folder/test_Mine.py",
        "Next:",
        "  pytest 'my folder/test_Mine.py'",
    ]
    assert said[4:] == [
        "  adaptimp build 'my folder/Mine.py' -o 'my folder'",
        "  adaptimp run fig5 --controller 'my folder/Mine.fmu'",
    ]
    assert adaptimp("build", "my folder/Mine.py", "-o", "my folder").code == 0
    assert (here / "my folder" / "Mine.fmu").is_file()
    outcome = adaptimp("run", "fig5", "--controller", "my folder/Mine.fmu", "--stop", "0.01")
    assert outcome.code == 0
    assert "Mine has no M[1], M[2]" in outcome.err


def test_files_are_replaced_only_by_force(adaptimp: Command, here: Path) -> None:
    (here / "Mine.py").write_text("my work", encoding="utf-8")
    outcome = adaptimp("new", "controller", "Mine")
    assert outcome.code == 2
    assert outcome.sentence == "Mine.py: there already; choose another name, or replace with --force."
    assert [path.name for path in here.iterdir()] == ["Mine.py"]
    assert (here / "Mine.py").read_text(encoding="utf-8") == "my work"
    assert new(adaptimp, "Mine", "--force").startswith("replaced Mine.py\nwrote test_Mine.py\n")
    assert adaptimp("new", "controller", "Mine").sentence.startswith("Mine.py and test_Mine.py: there already; ")


@pytest.mark.parametrize(
    ("name", "usable"),
    [
        ("2nd", "Mine_2nd"),
        ("a b", "a_b"),
        ("lambda", "lambda_1"),
        ("double", "double_1"),
        ("con", "con_1"),
        ("../x", "x"),
    ],
)
def test_a_name_that_cannot_be_is_refused(adaptimp: Command, here: Path, name: str, usable: str) -> None:
    outcome = adaptimp("new", "controller", name)
    assert outcome.code == 2
    assert outcome.sentence == (
        f"{name!r} cannot be the name of a model, which is an identifier in Python and in C, and names a file;"
        f" {usable} could."
    )
    assert list(here.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("controller", "Plant"), "Plant: a shipped model is called Plant, so choose another name, such as Plant_1."),
        (("controller", "plant"), "plant: a shipped model is called Plant, so choose another name, such as plant_1."),
        (("controller", "numpy"), "numpy is the name of a module of Python, which numpy.py would hide; choose"),
        (("controller", "Mine", "--from", "crag"), "--from: there is no law crag; did you mean craig?"),
        (("plant", "Mine"), "There is no plant to begin with; 'adaptimp new controller NAME' begins a controller."),
    ],
)
def test_what_cannot_be_begun_is_refused(
    adaptimp: Command, here: Path, arguments: tuple[str, ...], sentence: str
) -> None:
    outcome = adaptimp("new", *arguments)
    assert outcome.code == 2
    assert outcome.sentence.startswith(sentence)
    assert list(here.iterdir()) == []


def test_every_shipped_controller_of_two_joints_can_be_begun_from() -> None:
    controllers = {name for name in MODELS if name.endswith("Impedance")}
    assert {beginning.shipped for beginning in BEGINNINGS.values()} == controllers
