"""Evidence for ``adaptimp build FILE.py``: models of a file of the user's own, and what is wrong with one."""

import re
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

from adaptimp_fmu import build
from orchestration import Fmu
from tests.faults.cli import Command

GAIN = '''"""Gain: y = 2 u."""

from adaptimp_fmu import SampledModel

model = SampledModel("Gain", "Multiplies")
model.output("y", 2 * model.input("u", 1.0, description="In"), description="Out", scalar=True)
alias = model
'''
INCOMPLETE = """from adaptimp_fmu import SampledModel
model = SampledModel("Lost", "Forgets")
state = model.state("z", 1.0)
"""
WRONG = {
    "none.py": (None, r"none\.py: there is no such Python file; build takes files that declare models"),
    "model.txt": (GAIN, r"model\.txt: there is no such Python file"),
    "FailingForceSensr": (
        None,
        r"FailingForceSensr: there is no such shipped model, .*; did you mean FailingForceSensor",
    ),
    "empty.py": ("x = 1\n", r"empty\.py names no model at its top level; declare one, such as model = "),
    "typo.py": ("x = 1\n\ny = z\n", r"typo\.py, line 3: NameError: name 'z' is not defined"),
    "syntax.py": ("x = 1\ny = (\n", r"syntax\.py, line 2: SyntaxError: '\(' was never closed$"),
    "deep.py": ("import typo_beside\n", r"typo_beside\.py, line 1: SyntaxError: '\(' was never closed$"),
    "lost.py": (INCOMPLETE, r"Lost\.fmu cannot be built: Lost has no outputs; declare one with model\.output"),
    "raises.py": ('def f():\n    raise OSError("no")\n\n\nf()\n', r"raises\.py, line 2: OSError: no"),
}


def test_a_shipped_model_and_a_variant_are_built_by_name(adaptimp: Command) -> None:
    outcome = adaptimp("build", "ForceSensor", "FailingForceSensor", "--out", "built")
    assert (outcome.code, outcome.err) == (0, "")
    assert re.fullmatch(r"built.ForceSensor\.fmu  \d+ kB\nbuilt.FailingForceSensor\.fmu  \d+ kB\n", outcome.out)
    by_name = adaptimp("info", "FailingForceSensor")
    assert by_name.out.startswith("FailingForceSensor: FMI 2.0 FMU for co-simulation\n")


def test_a_model_of_a_file_is_built_with_its_docstring(adaptimp: Command, tmp_path: Path) -> None:
    (tmp_path / "gain.py").write_text(GAIN, encoding="utf-8")
    path, before = sys.path[:], set(sys.modules)
    outcome = adaptimp("build", "gain.py", "--out", "built")
    assert (outcome.code, outcome.err) == (0, "")
    assert re.fullmatch(r"built.Gain\.fmu  \d+ kB\n", outcome.out)
    assert sys.path == path
    assert "gain" not in set(sys.modules) - before
    assert [file.name for file in (tmp_path / "built").iterdir()] == ["Gain.fmu"]
    with zipfile.ZipFile(tmp_path / "built" / "Gain.fmu") as archive:
        assert ">Gain: y = 2 u.</pre>" in archive.read("documentation/index.html").decode()
    with Fmu(tmp_path / "built" / "Gain.fmu", u=4.0) as unit:
        assert unit.outputs()["y"] == 8.0


def test_all_models_of_all_files_are_built_and_may_import_each_other(adaptimp: Command, tmp_path: Path) -> None:
    (tmp_path / "gain_beside.py").write_text(GAIN, encoding="utf-8")
    other = "import gain_beside\nfrom adaptimp_fmu import SampledModel\n"
    for name in ("One", "Two"):
        other += f'{name} = SampledModel("{name}", "One")\n'
        other += f'{name}.output("y", {name}.parameter("p", 1.0, description="P"), description="Y")\n'
    (tmp_path / "other.py").write_text(other, encoding="utf-8")
    assert adaptimp("build", "gain_beside.py", "other.py", "--out", "built").code == 0
    assert sorted(file.name for file in (tmp_path / "built").iterdir()) == ["Gain.fmu", "One.fmu", "Two.fmu"]


def test_without_a_docstring_there_is_no_documentation_of_the_equations(adaptimp: Command, tmp_path: Path) -> None:
    (tmp_path / "gain.py").write_text(GAIN.partition("\n")[2], encoding="utf-8")
    assert adaptimp("build", "gain.py", "--out", ".").code == 0
    with zipfile.ZipFile(tmp_path / "Gain.fmu") as archive:
        assert "<h3>gain</h3>" not in archive.read("documentation/index.html").decode()


def test_the_same_model_in_python_is_the_same_file(adaptimp: Command, tmp_path: Path) -> None:
    (tmp_path / "gain.py").write_text(GAIN.partition("\n")[2], encoding="utf-8")
    assert adaptimp("build", "gain.py", "--out", ".").code == 0
    names: dict[str, Any] = {}
    exec(GAIN, names)
    assert build(names["model"], tmp_path / "python").read_bytes() == (tmp_path / "Gain.fmu").read_bytes()


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_one_sentence(adaptimp: Command, tmp_path: Path, name: str) -> None:
    text, expected = WRONG[name]
    (tmp_path / "typo_beside.py").write_text("(\n", encoding="utf-8")
    if text is not None:
        (tmp_path / name).write_text(text, encoding="utf-8")
    outcome = adaptimp("build", name, "--out", "built")
    assert outcome.code == 2
    assert re.search(expected, outcome.sentence), outcome.sentence
    assert not list(tmp_path.rglob("*.fmu"))


def test_two_models_of_one_name_are_refused(adaptimp: Command, tmp_path: Path) -> None:
    for name in ("a.py", "b.py"):
        (tmp_path / name).write_text(GAIN, encoding="utf-8")
    outcome = adaptimp("build", "a.py", "b.py", "--out", "built")
    assert outcome.code == 2
    assert outcome.sentence == "Two models are called Gain, in a.py and in b.py; rename one."


SWITCH = """from adaptimp_fmu import SampledModel, Type

model = SampledModel("Switch", "Shows a switch")
model.output("y", model.input("on", 1, type=Type.BOOLEAN, description="In"), description="Out", scalar=True)
"""


def test_reals_take_the_place_of_booleans_in_a_folder_of_their_own(adaptimp: Command, tmp_path: Path) -> None:
    (tmp_path / "switch.py").write_text(SWITCH, encoding="utf-8")
    for options, folder, type in (((), "fmus", "Boolean"), (("--reals",), "reals", "Real")):
        outcome = adaptimp("build", "switch.py", *options)
        assert (outcome.code, outcome.err) == (0, "")
        with Fmu(tmp_path / "build" / folder / "Switch.fmu", on=0) as unit:
            assert unit.variables["on"].type == type
            assert unit.outputs()["y"] == 0.0
    assert adaptimp("build", "switch.py", "--reals", "-o", "build/fmus").out.endswith("kB, replaced\n")
