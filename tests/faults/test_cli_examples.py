"""Evidence that every command line in the help, in README.md and in docs/command-line.md does what it says."""

import re
import shlex
import zipfile
from pathlib import Path

import pytest

from orchestration import System, scenario
from orchestration.cli.app import app
from orchestration.paper import report, spatial_report
from orchestration.paper.report import Report
from orchestration.paper.spatial_report import SpatialReport
from tests.faults.cli import Command
from tests.scenarios.tutorial import blocks

ROOT = Path(__file__).parents[2]
COMMANDS = [command.name or command.callback.__name__ for command in app.registered_commands if command.callback]
PAGES_OF_COMMANDS = {
    "README.md": 20,
    "docs/caches.md": 3,
    "docs/claims.md": 1,
    "docs/command-line.md": 9,
    "docs/components.md": 1,
    "docs/doctor.md": 4,
    "docs/install.md": 1,
    "docs/live-page.md": 4,
    "docs/puma.md": 6,
    "docs/same-bits.md": 1,
    "docs/wrist-sensor.md": 2,
}
"""Pages whose command lines are typed, with the least number of lines that each has."""
MINE = '''"""A controller that holds the arm by springs, with names of its own."""

from adaptimp_fmu import SampledModel

mine = SampledModel("mine", "Springs at the joints")
q = mine.input("JointAngle", [-0.72, 1.45], unit="rad", description="Joint angle")
k = mine.parameter("k", 5.0, unit="N.m/rad", description="Stiffness")
mine.output("Torque", -k * q, unit="N.m", description="Commanded torque")
'''


def lines_of_help(text: str) -> list[str]:
    """Command lines in the section of examples of a help text."""
    section = re.search(r"^Examples:\n((?:  .*\n)+)", text, re.MULTILINE)
    assert section, text
    return [line.strip() for line in re.sub(r"\\\n\s*", "", section[1]).splitlines()]


def lines_of_page(page: str) -> list[str]:
    """Command lines of a page: indented after ``uv run``, or in a fence of ``sh``."""
    text = (ROOT / page).read_text(encoding="utf-8")
    fences = "".join(re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL))
    return re.findall(r"^    (?:uv run )?(adaptimp .*)$", text, re.MULTILINE) or re.findall(
        r"(?m)^adaptimp .*$", fences
    )


@pytest.fixture
def prepared(adaptimp: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Command:
    """The command line in a folder with a model and results of the user's own; the paper is not measured."""

    def reproduce(folder: Path, *_: object, **__: object) -> Report:
        (folder / "claims.json").write_text("[]")
        return Report([], folder / "claims.json", folder / "report.html", [], {}, kept=False)

    def reproduce_in_space(folder: Path, *_: object, **__: object) -> SpatialReport:
        (folder / "puma-claims.json").write_text("[]")
        return SpatialReport([], folder / "puma-claims.json", [], kept=False)

    monkeypatch.setattr(report, "reproduce", reproduce)
    monkeypatch.setattr(spatial_report, "reproduce_in_space", reproduce_in_space)
    (tmp_path / "mine.py").write_text(MINE, encoding="utf-8")
    (arm,) = [block for block in blocks(ROOT / "docs" / "your-robot.md") if block.kind == "xml"]
    (tmp_path / "arm.urdf").write_text(arm.text, encoding="utf-8")
    assert adaptimp("build", "mine.py", "--out", ".").code == 0
    assert adaptimp("new", "controller", "Mine", "--from", "craig", "--out", "mine").code == 0
    assert adaptimp("build", "mine/Mine.py", "--out", "mine").code == 0
    for name in ("fig2", "fig5"):  # results that examples take for granted
        assert adaptimp("run", name, "--stop", 0.01, "-o", f"{name}.parquet").code == 0
    return adaptimp


def write_structure(system: System, path: Path) -> None:
    """Write the system as the live page does: its description alone, which refers to FMUs in ``resources``."""
    package = system.write(path.with_suffix(".ssp"))
    with zipfile.ZipFile(package) as archive:
        path.write_bytes(archive.read("SystemStructure.ssd"))
        for name in archive.namelist():
            if name.endswith(".ssv"):
                archive.extract(name, path.parent)
    package.unlink()


def type_in(adaptimp: Command, line: str) -> None:
    """Run a command line of which a shell would take the comment and the redirection away."""
    command, _, _ = line.partition(" >")
    outcome = adaptimp(*shlex.split(command, comments=True)[1:])
    examines = command.startswith(("adaptimp check", "adaptimp doctor", "adaptimp compare"))
    found_something = examines and outcome.code == 1 and outcome.err == ""
    assert outcome.code == 0 or found_something, f"{line}\n{outcome.out}{outcome.err}"


@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_examples_of_the_help(
    prepared: Command, command: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if command == "cache":  # other processes of this machine are not to lose theirs
        monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    lines = lines_of_help(prepared(*([command] if command else []), "--help").out)
    assert len(lines) == 2
    for line in lines:
        assert line.startswith(f"adaptimp {command or ''}".rstrip())
        type_in(prepared, line)


@pytest.mark.parametrize(("page", "number"), PAGES_OF_COMMANDS.items())
def test_command_lines_of_pages(
    prepared: Command, page: str, number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if page == "docs/caches.md":  # other processes of this machine are not to lose theirs
        monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    if page == "docs/doctor.md":  # files of the reader's own
        assert prepared("export", "fig2", "--out", "mine.ssp").code == 0
        (tmp_path / "mine.fmu").rename(tmp_path / "theirs.fmu")
    if page == "docs/live-page.md":  # the reader has downloaded it
        write_structure(scenario("fig5"), tmp_path / "fig5.ssd")
    lines = lines_of_page(page)
    assert len(lines) >= number, lines
    for line in lines:
        type_in(prepared, line)
