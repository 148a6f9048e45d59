"""Tests of the interface of each role: controller, plant, sensor, actuator and trajectory."""

import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from orchestration.check import Candidate, Report, Severity
from orchestration.check.findings import ROLE
from orchestration.check.interface import UNITS, interface_is_kept
from orchestration.check.static.archive_rules import open_package
from orchestration.paper.built_fmus import built
from orchestration.paper.closed_loop import LOOP, Loop, in_loop, judge, paper_loop
from orchestration.paper.ride import Ride
from orchestration.paper.roles import ROLES
from orchestration.system.system import System
from tests.unit.orchestration.checked import Edit, assert_found, check, edited, swap

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE
TORQUE = r'<Unit name="N.m">\s*<BaseUnit kg="1" m="2" s="-2"/>'


def base(exponents: str) -> Edit:
    """An edit of what a newton metre is."""
    return swap(TORQUE, f'<Unit name="N.m"><BaseUnit {exponents}/>')


def renamed(old: str, new: str) -> Edit:
    """An edit of a variable's name."""
    return lambda xml: xml.replace(f'name="{old}"', f'name="{new}"')


CONTROLLER: dict[str, tuple[Edit, Severity, str]] = {
    "a torque is missing": (
        renamed("tau_cmd[2]", "torque"),
        *(ERROR, r"The output tau_cmd\[2\] in N.m of the controller is missing"),
    ),
    "factor": (
        base('kg="1" m="2" s="-2" factor="1000"'),
        *(ERROR, r"tau_cmd\[1\] of the controller has the unit N.m \(1000 kg m2 s-2\); N.m \(kg m2 s-2\) is needed\."),
    ),
    "convertible": (
        lambda xml: base('kg="1" m="2" s="-2" factor="1000"')(xml).replace('"N.m"', '"kN.m"'),
        *(NOTE, r"tau_cmd\[1\] of the controller is in kN.m \(1000 kg m2 s-2\), not N.m; adaptimp converts it"),
    ),
    "dimension": (
        base('kg="1" m="1" s="-2"'),
        *(ERROR, r"tau_cmd\[1\] of the controller has the unit N.m \(kg m s-2\); N.m \(kg m2 s-2\) is needed\."),
    ),
    "radian": (
        base('kg="1" m="2" s="-2" rad="-1"'),
        *(WARNING, r"tau_cmd\[1\] of the controller .*they differ in rad alone"),
    ),
    "no base unit": (
        swap(TORQUE, '<Unit name="N.m">'),
        *(WARNING, r"tau_cmd\[1\] of the controller has the unit N.m without a BaseUnit"),
    ),
    "no unit": (
        swap(r'(name="q\[1\]".*?<Real) declaredType="Angle" unit="rad"', r"\1"),
        *(WARNING, r"q\[1\] of the controller declares no unit; rad is needed"),
    ),
    "other unit": (
        swap(r'(name="q\[1\]".*?<Real) declaredType="Angle" unit="rad"', r'\1 unit="m"'),
        *(ERROR, r"q\[1\] of the controller has the unit m \(m\); rad \(rad\) is needed"),
    ),
    "causality": (
        swap(r'(name="q\[1\]".*?)causality="input"', r'\1causality="local"'),
        *(ERROR, r"q\[1\] of the controller has causality local; input is needed"),
    ),
    "type": (
        swap(
            r'(name="q\[1\]".*?)variability="continuous">\s*<Real[^>]*/>',
            r'\1variability="discrete"><Integer start="1"/>',
        ),
        *(ERROR, r"q\[1\] of the controller is of type Integer; Real is needed"),
    ),
    "element": (
        renamed("q[2]", "q2"),
        *(ERROR, r"q\[1\] is there, but q\[2\] of the controller's q is missing"),
    ),
    "stranger": (
        renamed("q[2]", "q2"),
        *(WARNING, r"The input q2 keeps its start value"),
    ),
    "unused input": (
        lambda xml: renamed("ddq[1]", "a[1]")(renamed("ddq[2]", "a[2]")(xml)),
        *(NOTE, r"The input ddq\[1\], ddq\[2\] in rad/s2 of the controller is missing; its connection is dropped"),
    ),
    "unread output": (
        lambda xml: renamed("e[1]", "err[1]")(renamed("e[2]", "err[2]")(xml)),
        *(NOTE, r"The output e\[1\], e\[2\] in m of the controller is missing"),
    ),
    "sampling period": (
        swap(r'(name="sample_time".*?) unit="s"', r'\1 unit="m"'),
        *(ERROR, r"sample_time of the controller has the unit m \(m\); s \(s\) is needed"),
    ),
}


def test_units_are_those_of_the_si() -> None:
    """A newton is one kg m/s2; a torque is a force times a length; rates are per second."""
    powers = {name: dict(unit.exponents) for name, unit in UNITS.items()}
    assert powers["N"] == {"kg": 1, "m": 1, "s": -2}
    assert powers["N.m"] == powers["N"] | {"m": 2}
    for of, name in (("m", "m/s"), ("rad", "rad/s"), ("m/s", "m/s2"), ("rad/s", "rad/s2")):
        assert powers[name] == powers[of] | {"s": powers[of].get("s", 0) - 1}


@pytest.mark.parametrize("fault", list(CONTROLLER))
def test_a_wrong_controller(fmu_folder: Path, tmp_path: Path, fault: str) -> None:
    edit, severity, message = CONTROLLER[fault]
    report = check(edited(fmu_folder / "HoganImpedance.fmu", tmp_path, edit))
    assert report.role == "controller"
    assert_found(report, ROLE, severity, message)


@pytest.mark.parametrize(
    ("unit", "role"),
    [
        ("Plant", "plant"),
        ("ForceSensor", "sensor"),
        ("Actuator", "actuator"),
        ("VirtualTrajectory", "trajectory"),
        ("HoganImpedance", "controller"),
    ],
)
def test_every_unit_in_every_role(fmu_folder: Path, unit: str, role: str) -> None:
    """An FMU keeps the interface of its own role, and that of no other."""
    for other in ROLES:
        report = check(fmu_folder / f"{unit}.fmu", other)
        assert report.role == other
        assert report.failed == (other != role), other
        assert other == role or any(other in f.message for f in report.findings if f.rule == ROLE)


POSES = {
    "sensor": ("ForceSensorPose", "F_ext[3]", "N.m"),
    "trajectory": ("VirtualTrajectoryPose", "dx_v[3]", "rad/s"),
    "controller": ("HoganImpedance3RPose", "x_v[3]", "rad"),
    "plant": ("Plant3RPose", "x[3]", "rad"),
}
"""FMUs of a task with an angle by role; of each an element of the angle with its unit."""
IN_SPACE = {
    "sensor": ("ForceSensorPuma560", "F_ext[6]", "N.m"),
    "trajectory": ("VirtualTrajectoryPuma560", "dx_v[4]", "rad/s"),
    "controller": ("HoganImpedancePuma560", "x_v[3]", "m"),
    "plant": ("PlantPuma560", "x[5]", "rad"),
}
"""FMUs of a task in space by role; of each an element with its unit."""


@pytest.mark.parametrize("forms", [POSES, IN_SPACE], ids=["plane", "space"])
@pytest.mark.parametrize("role", POSES)
def test_an_fmu_has_the_angles_of_the_tip_in_all_its_signals_or_in_none(
    tmp_path: Path, role: str, forms: Mapping[str, tuple[str, str, str]]
) -> None:
    name, element, unit = forms[role]
    last = 3 if forms is POSES else 6

    def found(edit: Edit | None) -> list[str]:
        path = built(name) if edit is None else edited(built(name), tmp_path, edit)
        return [f"{f.severity}: {f.message}" for f in interface_is_kept(open_package(path).document, ROLES[role])]

    def in_another_unit(xml: str) -> str:
        before, after = xml[: xml.index(f'name="{element}"')], xml[xml.index(f'name="{element}"') :]
        return before + after.replace(f'unit="{unit}"', 'unit="1/s"', 1)

    assert found(None) == []
    wrong = re.compile(rf"{re.escape(element)} of the {role} has the unit 1/s")
    assert any(wrong.search(text) for text in found(in_another_unit))
    if role == "sensor":  # its other signal still has a moment
        renamed = found(lambda xml: xml.replace(f'name="F_hat[{last}]"', 'name="other"'))
        assert renamed == [f"{ERROR}: The output F_hat[{last}] in N.m of the sensor is missing."]


def sliding(xml: str, joint: int) -> str:
    """A description in which a joint slides: its coordinate is in m, its torque is a force."""
    for signal, turns, slides in (
        ("q", "rad", "m"), ("dq", "rad/s", "m/s"), ("ddq", "rad/s2", "m/s2"), ("tau_cmd", "N.m", "N"),
    ):  # fmt: skip
        head, tail = xml.split(f'name="{signal}[{joint}]"')
        declared = re.sub(r' declaredType="[^"]*"', "", tail[: tail.index("/>")])
        declared = re.sub(r' displayUnit="[^"]*"', "", declared).replace(f'unit="{turns}"', f'unit="{slides}"')
        xml = f'{head}name="{signal}[{joint}]"{declared}{tail[tail.index("/>") :]}'
    return xml


def test_a_joint_of_an_arm_in_space_may_slide(fmu_folder: Path, tmp_path: Path) -> None:
    """Arms of two or three joints, which are planar, turn about all of them."""

    def found(path: Path) -> list[str]:
        document = open_package(edited(path, tmp_path, lambda xml: sliding(xml, 2))).document
        return [f.message for f in interface_is_kept(document, ROLES["controller"])]

    assert found(built("HoganImpedancePuma560")) == []
    planar = found(fmu_folder / "HoganImpedance.fmu")
    assert any(re.search(r"q\[2\] of the controller has the unit m \(m\); rad \(rad\) is needed", m) for m in planar)
    assert any(re.search(r"tau_cmd\[2\] of the controller has the unit N ", m) for m in planar)


def test_a_controller_for_another_arm_of_six_joints(tmp_path: Path) -> None:
    """The loop is that of one arm, where a controller of another arm would be judged wrongly."""
    path = edited(built("HoganImpedancePuma560"), tmp_path, swap(r'(name="q\[2\]".*?start=")[^"]*"', r'\g<1>0.3"'))
    findings, facts = in_loop(paper_loop)(Candidate(path, ROLES["controller"], 6, 6, {}, failed=False))
    assert findings == []
    assert facts == ["The closed loop of the PUMA 560 was not tried: the controller is for another arm."]


def test_no_role_is_guessed_without_its_output(fmu_folder: Path, tmp_path: Path) -> None:
    def without(xml: str) -> str:
        return xml.replace('name="tau_cmd[', 'name="torque[')

    path = edited(fmu_folder / "HoganImpedance.fmu", tmp_path, without)
    assert check(path).role is None
    assert_found(check(path, "controller"), ROLE, ERROR, r"The output tau_cmd\[1\], tau_cmd\[2\] in N.m")


FOREIGN = {"tau_cmd": "Torque", "q": "JointAngle", "M[1]": "Inertia"}


def foreign(fmu_folder: Path, tmp_path: Path) -> Path:
    """Our controller under other names, with torques in N.mm."""

    def edit(xml: str) -> str:
        xml = xml.replace('"tau_cmd[', '"Torque[').replace('"q[', '"JointAngle[').replace('"M[1]"', '"Inertia"')
        return base('kg="1" m="2" s="-2" factor="0.001"')(xml).replace('"N.m"', '"N.mm"')

    return edited(fmu_folder / "HoganImpedance.fmu", tmp_path, edit)


def test_other_names_are_mapped(fmu_folder: Path, tmp_path: Path, fig2: System) -> None:
    """The torques are a thousandth of what the loop needs: the tip is left behind."""
    path = foreign(fmu_folder, tmp_path)
    assert check(path).role is None
    report = check(path, mapping={**FOREIGN, "Gamma": "q"}, loop=lambda *_: Loop(fig2, (500.0, 300.0)))
    assert report.role == "controller"
    assert_found(report, ROLE, ERROR, "There is no variable q, which should be the Gamma")
    report = check(path, mapping=FOREIGN, loop=lambda *_: Loop(fig2, (500.0, 300.0)))
    assert_found(report, ROLE, NOTE, r"tau_cmd\[2\] of the controller is in N.mm")
    assert_found(report, LOOP, ERROR, r"The tip misses the virtual trajectory by [\d.]+ m .*: the loop diverges")
    assert not [f for f in report.findings if "limit" in f.message], "limits are in N.m"
    assert re.search(r"max \|tau_cmd\| = \d\.\d+ and \d\.\d+ N.m \(yours\)", report.facts[-1])


def test_names_that_only_others_have_are_no_obstacle(fmu_folder: Path, fig2: System) -> None:
    """A mapping for Fig. 5 names gains that the controller of this loop lacks."""
    mapping = {"Gamma": "p_hat"}
    report = check(fmu_folder / "HoganImpedance.fmu", mapping=mapping, loop=lambda *_: Loop(fig2, (500.0, 300.0)))
    assert not report.failed
    assert_found(report, LOOP, NOTE, "Mapping Gamma=p_hat: the loop's own controller has no Gamma")
    assert report.facts[-1].startswith("Closed loop")


def looped(
    path: Path,
    system: System,
    limits: tuple[float, float] = (500.0, 300.0),
    mapping: Mapping[str, str] | None = None,
) -> Report:
    """A report with the closed loop."""
    return check(path, mapping=mapping, loop=lambda joints, _: Loop(system, limits) if joints == 2 else None)


def test_a_controller_in_the_loop(fmu_folder: Path, fig2: System) -> None:
    report = looped(fmu_folder / "HoganImpedance.fmu", fig2)
    assert report.findings == ()
    pairs = [
        re.search(r"(\S+) (?:m|N|N\.m) \(yours\), (.+?) (?:m|N|N\.m) \(shipped\)\.$", fact) for fact in report.facts
    ]
    assert all(found is not None and found[2].endswith(found[1]) for found in pairs), "it is the loop's own controller"
    largest, free, force, _ = (float(found[1]) for found in pairs if found is not None)
    assert 0 < free < 1e-4 < largest < 0.02, "m, of which the last is how deep the reference is in the wall, and more"
    assert 400 < force < 1000


def test_a_controller_with_names_of_its_own(fmu_folder: Path, fig2: System, tmp_path: Path) -> None:
    """Whole arrays, a single element and a scalar are mapped; the report is that of our names."""

    def foreign(xml: str) -> str:
        for our, their in (("tau_cmd[", "Torque["), ("K[", "Stiffness["), ("q[2]", "Elbow"), ("gravity", "g")):
            xml = xml.replace(f'name="{our}', f'name="{their}')
        return xml

    path = edited(fmu_folder / "HoganImpedance.fmu", tmp_path, foreign)
    mapping = {"tau_cmd": "Torque", "K": "Stiffness", "q[2]": "Elbow", "gravity": "g"}
    report, ours = looped(path, fig2, mapping=mapping), looped(fmu_folder / "HoganImpedance.fmu", fig2)
    assert (report.role, report.findings) == ("controller", ())
    assert report.facts == ours.facts
    less = {name: mapping[name] for name in ("tau_cmd", "K")}
    assert_found(looped(path, fig2, mapping=less), ROLE, ERROR, r"but q\[2\] of the controller's q is missing")


def test_a_mapping_of_what_is_not_there(fmu_folder: Path) -> None:
    for their in ("Torque", "tau"):
        report = check(fmu_folder / "HoganImpedance.fmu", mapping={"tau_cmd": their})
        assert_found(report, ROLE, ERROR, f"There is no variable {their}, which should be the tau_cmd")


def test_a_controller_that_fails_in_the_loop(fmu_folder: Path, fig2: System) -> None:
    """The adaptive one is not strictly positive real with the damping of Fig. 2, and says so."""
    report = looped(fmu_folder / "CraigAdaptiveImpedance.fmu", fig2)
    assert_found(report, LOOP, ERROR, r"The loop does not run: controller: .*strict positive realness")


def test_a_controller_for_another_arm(fmu_folder: Path, fig2: System) -> None:
    report = looped(fmu_folder / "HoganImpedance3R.fmu", fig2)
    assert report.findings == ()
    assert report.facts == ("The closed loop was not tried.",)


def test_a_controller_that_is_left_behind(fmu_folder: Path, fig2: System) -> None:
    """Without its reference it stays where it starts, and the virtual trajectory moves to the other side."""
    loose = tuple(c for c in fig2.connections if c.source != "trajectory")
    system = System("loose", fig2.components, loose, fig2.step, fig2.stop_time)
    report = looped(fmu_folder / "HoganImpedance.fmu", system)
    assert_found(report, LOOP, ERROR, r"The tip misses the virtual trajectory by [23]\.\d* m within 1\.2 s")


def test_verdicts_on_a_ride(fig2: System) -> None:
    loop, usual = Loop(fig2, (10.0, 10.0)), Ride(0.08, 0.001, 600.0, (9.0, 9.0))

    def verdict(miss: float, free: float = 0.001, torques: tuple[float, float] = (9.0, 9.0)) -> list[tuple[str, str]]:
        return [(f.severity, f.message) for f in judge(Ride(miss, free, 600.0, torques), loop, usual)]

    assert verdict(0.09) == []
    assert [severity for severity, _ in verdict(0.5)] == [WARNING]
    assert [severity for severity, _ in verdict(5.0)] == [ERROR]
    assert [severity for severity, _ in verdict(float("nan"))] == [ERROR]
    ((_, message),) = verdict(0.0, torques=(9.0, 11.0))
    assert message == "tau_cmd[2] reaches 11 N.m, beyond the limit 10 N.m."
    usual = Ride(0.01, 0.001, 600.0, (9.0, 9.0))
    ((severity, message),) = verdict(0.02)
    assert severity == WARNING
    assert message.endswith("at the wall, not before: look at what the controller makes of F_hat.")
    ((severity, message),) = verdict(0.02, free=0.01)
    assert severity == WARNING
    assert message.endswith("0.01 m with the loop's own controller; in free motion, too.")
