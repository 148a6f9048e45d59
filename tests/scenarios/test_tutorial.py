"""docs/write-your-own-controller.md, followed literally, ends where it says: with two controllers that agree."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import host_platform
from orchestration import Crossings, Fmu, Options, OrchestrationError, Result, prepare, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.roles import ROLES
from orchestration.paper.scenarios import SCENARIOS
from tests.scenarios.tutorial import Printed, blocks, follow

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "write-your-own-controller.md"
SHOWN = [block.line for block in blocks(PAGE) if block.kind == "text"]
NAMES = {"tau_cmd": "Torque", "q": "Angle", "dq": "Rate", "x_v": "Target", "dx_v": "TargetRate"}
on_linux = pytest.mark.skipif(host_platform().name != "linux64", reason="the page's commands name the folder linux64")


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[int, Printed]]:
    """The reader's folder when all is done, and what was printed, by line of the page."""
    folder = tmp_path_factory.mktemp("reader")
    return folder / "mine", {p.line: p for p in follow(PAGE, folder, () if shutil.which("gcc") else ("gcc",))}


@on_linux
@pytest.mark.parametrize("line", SHOWN)
def test_commands_print_what_the_page_shows(followed: tuple[Path, dict[int, Printed]], line: int) -> None:
    printed = followed[1][line]
    assert printed.agree, f"{PAGE.name}, line {line}, shows\n{printed.shown}\nand the commands print\n{printed.real}"


@on_linux
def test_both_controllers_do_the_same(followed: tuple[Path, dict[int, Printed]]) -> None:
    """Rounding apart: on the way to the end of a stable loop, 1e-16 m at 4 kN/m is 1e-12 N.m, times some hundreds."""
    python, c = (Result.read(followed[0] / f"{name}.parquet") for name in ("mine", "in_c"))
    for name, tolerance in (("plant.x", 1e-12), ("controller.tau_cmd", 1e-9)):
        assert np.abs(python[name]).max() > 1
        np.testing.assert_allclose(c[name], python[name], rtol=0, atol=tolerance)
    shipped = Result.read(followed[0] / "shipped.parquet")
    assert np.abs(shipped["plant.x"] - python["plant.x"]).max() > 1e-3


@on_linux
def test_both_laws_agree_wherever_the_arm_is(followed: tuple[Path, dict[int, Printed]]) -> None:
    """With weight, which the loop does not have; sums of ten products of up to 1e4 N.m round to 1e-11 N.m."""
    random = np.random.default_rng(1)
    rows = {name: random.uniform(-2, 2, (50, 2)) for name in ("q", "dq", "x_v", "dx_v")}
    with (
        Fmu(followed[0] / "CartesianImpedance.fmu", gravity=9.81, l=[1.0, 0.7], m=[2.0, 1.5]) as python,
        Fmu(followed[0] / "CartesianC.fmu", Gravity=9.81, Length=[1.0, 0.7], Mass=[2.0, 1.5]) as c,
    ):
        expected = python.drive(1e-4, rows)["tau_cmd"]
        found = c.drive(1e-4, {NAMES[name]: values for name, values in rows.items()})["Torque"]
    assert np.abs(expected).max() > 1e3
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)


@on_linux
def test_what_is_lost_without_saving_state(followed: tuple[Path, dict[int, Printed]]) -> None:
    """Adaptive steps, located crossings and snapshots, as the page says; the one in Python has them."""
    fig5 = SCENARIOS["fig5"].system(fmus(SCENARIOS["fig5"].models.values()))
    c = fig5.replace("controller", followed[0] / "CartesianC.fmu", NAMES)
    crossings = Options(crossings=Crossings(["plant.gap"]))
    for options, algorithm in ((Options(), "adaptive"), (crossings, "gauss-seidel")):
        with pytest.raises(OrchestrationError, match=r"controller: .*canGetAndSetFMUstate"):
            simulate(c, 1e-3, algorithm=algorithm, options=options)
    with prepare(c, 1e-3) as run, pytest.raises(OrchestrationError, match="canGetAndSetFMUstate"):
        run.save()
    with prepare(fig5.replace("controller", followed[0] / "CartesianImpedance.fmu"), 1e-3) as run:
        run.save()


def test_nothing_on_the_page_is_left_out() -> None:
    """Each fence is typed, compared or written to a named file; indented code is only the law."""
    text = PAGE.read_text(encoding="utf-8")
    assert text.count("```") == 2 * len(blocks(PAGE))
    assert {b.kind for b in blocks(PAGE)} == {"sh", "text", "python", "c", "xml"}
    files = [block.file for block in blocks(PAGE) if block.kind in ("python", "c", "xml")]
    assert all(files)
    assert len(set(files)) == len(files) == 5
    prose = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    assert len(re.findall(r"^    \S", prose, re.MULTILINE)) == 1
    assert "mine/" in (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()


def test_the_table_is_the_interface() -> None:
    """Names and units of the signals as the check knows them."""
    rows = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    signals = {m[1]: m[2] for row in rows for m in re.finditer(r"`(\w+)\[\d\]` ([\w./]+)", row.rpartition("|")[0])}
    role = ROLES["controller"]
    known = {**role.inputs, **role.required, **role.expected}
    for name, signal in known.items():
        assert any(f"`{name}[" in row for row in rows), name
        assert signals.get(name, "") == ("Boolean" if signal.type == "Boolean" else signal.unit or ""), name


def example(shown: str, real: str) -> bool:
    return Printed(0, shown, real).agree


def test_comparison_notices_what_differs() -> None:
    assert example("a ... kB\n", "a  42 kB\n")
    assert example("...\nends here\n", "a\n│ b │\nends\nhere\n")
    assert not example("a 1.5 mm\n", "a 1.6 mm\n")
    assert not example("a\n", "a\nb\n")
    assert not example("a\nb\n", "a\n")
    assert not example("a ... kB\n", "a 42 MB\n")


def test_a_command_that_fails_ends_the_tour(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("```sh\necho before\nfalse\necho after\n```\n", encoding="utf-8")
    with pytest.raises(AssertionError, match=r"line_1\.sh fails:(.|\n)*\nbefore\n$"):
        follow(page, tmp_path)
