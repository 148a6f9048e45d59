"""Evidence for ``adaptimp build --robot``: what is refused, in sentences with the options that help."""

import re
from pathlib import Path

import pytest

from tests.faults.cli import Command
from tests.scenarios.pages import ROOT
from tests.scenarios.tutorial import blocks

URDF = next(block.text for block in blocks(ROOT / "docs" / "your-robot.md") if block.file == "arm6.urdf")
START = "0,0.25,1.56,0,1.33,0"
REFUSED = {
    "no tip": (
        (),
        r"--robot arm\.urdf needs --tip, the link at the end of the arm; links that carry no other one: tool",
    ),
    "unknown tip": (
        ("--tip", "tol"),
        r"--robot: arm\.urdf: there is no tip link tol; the file has base, turret, .*tool",
    ),
    "no number": (
        ("--tip", "tool", "--start", "0,a,1,0,1,0"),
        r"--start 0,a,1,0,1,0: 'a' is not a finite number; give numbers in rad or m\.",
    ),
    "too few": (("--tip", "tool", "--start", "0,1"), r"2 joint coordinates are given for the start, but the arm has 6"),
    "stretched": (
        ("--tip", "tool", "--start", "0,0,0,0,0,0"),
        r"no ellipse fits: .* the arm is nearly singular .*\. Give other joint coordinates: --start Q1,Q2",
    ),
    "held badly": (
        ("--tip", "tool", "--hold", "elbow"),
        r"--hold elbow: a joint and where it is held are needed: JO",
    ),
    "five joints": (
        ("--tip", "tool", "--hold", "elbow=1.5"),
        r"--robot: arm\.urdf: 5 joints move between base and tool .*, but position and orientation of the tip need 6",
    ),
    "branch": (
        ("--tip", "wrist"),
        r"joint flange_roll \(continuous\) branches off the chain at link wrist; hold it, --hold flange_roll=0\.0, so",
    ),
    "rotor": (
        ("--tip", "tool", "--rotor", "wrist=1"),
        r"there is no joint wrist that moves; the arm has waist, shoulder",
    ),
    "negative": (
        ("--tip", "tool", "--payload", "-1"),
        r"--payload -1: the mass at the tip must be finite and at least 0 kg\.",
    ),
    "payload that is no number": (("--tip", "tool", "--payload", "nan"), r"--payload nan: the mass at the tip must be"),
    "start without commas": (
        ("--tip", "tool", "--start", "0 0.25 1.56 0 1.33 0"),
        r"the numbers need commas between them: 0,0\.25,1\.56,0,1\.33,0\.",
    ),
    "rotor that is no number": (
        ("--tip", "tool", "--rotor", "elbow=nan"),
        r"--rotor elbow=nan: 'nan' is not a finite number; give numbers in kg m2 or kg\.",
    ),
    "platform": (("--tip", "tool", "--platform", "amiga"), r"There is no platform amiga; "),
    "model, too": (("--tip", "tool", "Plant"), r"--robot builds the models of an arm, and Plant is another one; build"),
}


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """The arm of docs/your-robot.md."""
    path = tmp_path / "arm.urdf"
    path.write_text(URDF, encoding="utf-8")
    return path


@pytest.mark.parametrize("case", REFUSED)
def test_a_request_that_cannot_be_carried_out_is_refused(adaptimp: Command, arm: Path, case: str) -> None:
    options, sentence = REFUSED[case]
    outcome = adaptimp("build", "--robot", arm.name, *options, "--out", "built")
    assert outcome.code == 2
    assert re.search(sentence, outcome.sentence), outcome.sentence
    assert not (arm.parent / "built").exists()


def test_names_of_joints_may_have_blanks(adaptimp: Command, arm: Path) -> None:
    """URDF allows them, and so the answer is that five joints are left, not that the option cannot be read."""
    arm.write_text(URDF.replace('joint name="elbow"', 'joint name="left elbow = 2"'), encoding="utf-8")
    outcome = adaptimp("build", "--robot", arm.name, "--tip", "tool", "--hold", "left elbow = 2=1.5")
    assert outcome.sentence.startswith("--robot: arm.urdf: 5 joints move between base and tool (waist, shoulder, fore")


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        ('type="Revolute"', 'joint waist has the type "Revolute", which URDF does not know; a joint of the chain is'),
        ("", "joint waist has no type; a joint of the chain is fixed, revolute, continuous, prismatic, in small"),
    ],
)
def test_a_joint_of_an_unknown_type_is_not_said_to_be_of_several(
    adaptimp: Command, arm: Path, kind: str, sentence: str
) -> None:
    arm.write_text(URDF.replace('name="waist" type="revolute"', f'name="waist" {kind}'), encoding="utf-8")
    outcome = adaptimp("build", "--robot", arm.name, "--tip", "tool")
    assert outcome.code == 2
    assert sentence in outcome.sentence


def test_a_file_without_links_has_no_tip(adaptimp: Command, arm: Path) -> None:
    arm.write_text('<robot name="empty"/>', encoding="utf-8")
    outcome = adaptimp("build", "--robot", arm.name)
    assert outcome.sentence == (
        "--robot arm.urdf needs --tip, the link at the end of the arm; the file has no such link."
    )


def test_options_of_a_robot_need_a_robot(adaptimp: Command) -> None:
    outcome = adaptimp("build", "Actuator", "--tip", "tool")
    assert (outcome.code, outcome.sentence) == (
        2,
        "--tip is of a robot, and no robot is given; give its file: --robot arm.urdf.",
    )


def test_a_missing_file_is_named(adaptimp: Command) -> None:
    outcome = adaptimp("build", "--robot", "none.urdf", "--tip", "tool")
    assert outcome.code == 1
    assert outcome.sentence == "none.urdf: No such file or directory."


def test_stiff_friction_is_answered_with_the_option_that_helps(adaptimp: Command, arm: Path) -> None:
    arm.write_text(URDF.replace('damping="0.1"', 'damping="1" friction="2"'), encoding="utf-8")
    outcome = adaptimp("build", "--robot", arm.name, "--tip", "tool", "--start", START)
    assert outcome.code == 2
    assert "such as --rotor flange_roll=0.05, or correct <dynamics>." in outcome.sentence


def test_a_robot_with_the_name_of_a_shipped_one_is_refused(adaptimp: Command, arm: Path) -> None:
    arm.write_text(URDF.replace('name="arm6"', 'name="puma560"'), encoding="utf-8")
    outcome = adaptimp("build", "--robot", arm.name, "--tip", "tool", "--start", START)
    assert outcome.code == 2
    assert outcome.sentence.startswith(
        "--robot arm.urdf: the robot puma560 would give a model the name of VirtualTrajectoryPuma560, which is shipped;"
    )


def test_without_the_part_that_builds_the_command_names_it(
    adaptimp: Command, arm: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from orchestration.cli import robot_build

    def missing(_: str) -> None:
        from adaptimp_fmu.files.parts import MissingPartError

        raise MissingPartError("casadi", "build")

    monkeypatch.setattr(robot_build, "imported", missing)
    outcome = adaptimp("build", "--robot", arm.name, "--tip", "tool")
    assert outcome.code == 2
    assert 'pip install "adaptimp[build]"' in outcome.sentence
