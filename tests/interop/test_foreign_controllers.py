"""Evidence that controllers of other people's making close the loop of Fig. 5, and that `check` finds no fault.

Two of them are the conventional law in other forms than ours: eq. (5) in C, compiled by gcc and by clang, with
angles in deg and torques in N.mm; eq. (4) in Python, exported by PythonFMU. Ours is eqs. (6), (7). The third, a
container of fmu_manipulation_toolbox, holds our own trajectory and controller.

How far forms of one law may differ (EPS = 2.2e-16; |q| <= 5.6 rad, |dq| <= 4.9 rad/s, |tau| <= 577 N.m):

- Angles go to deg and back, three roundings: 17 EPS, and 34 EPS = 8e-15 m at the tip; rates likewise 30 EPS.
- K/M and B/M make that 7e4 EPS m/s2, and H J^-1 (at most 9 kg.m2 times 2.7 1/m) 2e6 EPS = 4e-10 N.m.
- The loop answers a wrong acceleration with M/K of it at the tip: 34 EPS once more.
- In contact K_f = 1e5 N/m makes twice 34 EPS a force of 2e-9 N, and J' a torque of 4e-9 N.m.

The limits below are twice that. 2e-11 of the largest torque; a mass wrong in its tenth digit is seen.
"""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from orchestration import FmuWarning, Options, Result, System, simulate
from orchestration.check import Report, Severity
from orchestration.check.findings import ROLE
from orchestration.paper.closed_loop import LOOP, paper_loop
from tests.interop.foreign.builders import (
    MAPPING,
    OUTPUTS,
    compilers,
    container,
    hand_written,
    python_slave,
    without_pythonfmu,
)
from tests.unit.orchestration.checked import check
from tests.untested import needs

LONG_ENOUGH = 20.0  # s for a call; the container never returns from one of them
LIMITS = {"q": 1e-14, "dq": 1e-12, "x": 2e-14, "F_ext": 4e-9, "tau_cmd": 8e-9}  # rad, rad/s, m, N, N.m
N_MM = 1e-3  # N.m
LATE = ["sensor", "controller", "trajectory", "actuator", "plant"]  # the order of fig5, but for the trajectory
GAINS = {"Psi[1]", "Psi[2]", "Gamma[2]", "noise_bound", "gamma_margin", "gamma_eps", "sample_time"}
FRICTION = {f"p_start[{i}]" for i in range(3, 7)}
UNUSED = {f"{name}[{i}]" for name in ("ddq", "saturated") for i in (1, 2)}
OPTIONAL = (
    r"The output (x_t|dx_t|e|p_hat)\[1\].* is missing; figures and claims that read it cannot",
    r"The input ddq\[1\], ddq\[2\] in rad/s2 of the controller is missing; its connection is dropped",
)
# What tools do to every FMU, and `check` is right to say.
PYTHONFMU = {
    ("9", "fmi2Instantiate accepts a wrong GUID"),
    ("18", r"asks the system for a socket \(socket\); a check denies it"),  # a module of Python asks for IPv6
}
TOOLBOX = {
    ("4", "Outputs: .* without dependencies"),
    (ROLE, "declares no unit; .* cannot be compared"),
    (ROLE, "There are [0-9]+ more findings like these"),
    ("9", "fmi2Instantiate accepts a wrong GUID"),
    ("10", "fmi2GetReal (dies of SIG[A-Z]+ during the experiment 'unknown reference'|of the unknown value reference)"),
    ("11", "fmi2DoStep with h = (-2e-05|nan) s returns fmi2OK; an error is due"),
    ("11", "fmi2DoStep does not return within .* during the experiment 'step of NaN'"),
    (LOOP, r"tau_cmd\[[12]\] reaches [0-9.]+ N.m, beyond the limit"),  # it keeps the noisy gains of Fig. 5
}
needs_pythonfmu = pytest.mark.skipif(bool(without_pythonfmu()), reason=str(without_pythonfmu()))


@pytest.fixture
def slave(tmp_path: Path) -> Iterator[Path]:
    """The FMU of the Python class; what PythonFMU leaves behind in this interpreter is taken back."""
    path, modules = list(sys.path), set(sys.modules)
    yield python_slave(tmp_path)
    sys.path[:] = path
    for name in set(sys.modules) - modules:
        if name == "impedance_slave" or name.startswith("pythonfmu"):
            del sys.modules[name]


def assert_same_loop(result: Result, expected: Result, torque_unit: float = 1.0) -> None:
    """Within `LIMITS` at every communication point."""
    assert result.names == expected.names
    assert np.abs(expected["plant.F_ext[1]"]).max() > 400, "N: the tip has been at the wall"
    for name in expected.names:
        base = name.partition(".")[2].partition("[")[0]
        found = result[name] * (torque_unit if base == "tau_cmd" else 1.0)
        assert np.abs(found - expected[name]).max() <= LIMITS[base], name


def dropped(system: System) -> set[str]:
    """Variables of the controller that the new one has no use for, from the notices."""
    pattern = r"controller: (?:start values|connections) dropped, \S+ has no (?:input )?(.+)\."
    found = [re.fullmatch(pattern, notice) for notice in system.notices]
    assert all(found), system.notices
    return {name for match in found if match for name in match[1].split(", ")}


def assert_only(report: Report, known: set[tuple[str, str]], notes: tuple[str, ...]) -> None:
    """No error, no other warning than known ones, no other note on the role."""
    assert report.role == "controller"
    assert report.facts[-4].startswith("Closed loop of 1.2 s: max |x - x_v| = ")
    for finding in report.findings:
        said = f"{finding.rule} {finding.severity} {finding.message}"
        assert finding.severity != Severity.ERROR, said
        if finding.severity == Severity.WARNING:
            assert any(finding.rule == rule and re.search(text, finding.message) for rule, text in known), said
        elif finding.rule == ROLE:
            assert any(re.search(text, finding.message) for text in notes), said


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_a_c_file_with_units_of_its_own(fig5: System, conventional: Result, tmp_path: Path, compiler: str) -> None:
    if compiler not in compilers():
        pytest.skip(needs(f"{compiler} is not installed", compiler))
    system = fig5.replace("controller", hand_written(tmp_path, compiler=compiler), MAPPING)
    assert dropped(system) == GAINS | FRICTION | UNUSED
    assert system.component("controller").start["K[1]"] == 4.0, "N/mm"
    result = simulate(system, options=Options(strict=True, record=conventional.names))
    assert result.units["controller.tau_cmd[1]"] == "N.mm"
    assert_same_loop(result, conventional, N_MM)


def test_a_mass_wrong_in_its_tenth_digit_is_seen(fig5: System, conventional: Result, right: Path) -> None:
    """What `LIMITS` are worth."""
    system = fig5.replace("controller", right, MAPPING).set({"controller.p_start[2]": 2.5 * (1 + 1e-10)})
    result = simulate(system, options=Options(strict=True, record=conventional.names))
    with pytest.raises(AssertionError, match=r"controller\.tau_cmd|plant\."):
        assert_same_loop(result, conventional, N_MM)


def test_check_has_no_objection_to_the_c_file(right: Path) -> None:
    report = check(right, mapping=MAPPING, loop=paper_loop)
    converted = r"(tau_cmd|q|dq)\[[12]\] of the controller is in (N\.mm|deg|deg/s) \(.*\), not .*; adaptimp converts it"
    more = "There are [0-9]+ more findings like these"
    assert_only(report, set(), (*OPTIONAL, converted, more))
    assert check(right).findings == (), "without the mapping there is no role"


@needs_pythonfmu
def test_a_python_class(fig5: System, conventional: Result, slave: Path) -> None:
    system = fig5.replace("controller", slave)
    assert dropped(system) == GAINS | FRICTION | UNUSED | {"gravity"}
    assert_same_loop(simulate(system, options=Options(strict=True, record=conventional.names)), conventional)


@needs_pythonfmu
def test_an_exception_in_a_python_class(slave: Path) -> None:
    """It comes out as an error with the component, the call, and what Python said; the process ends in order."""
    entry = [sys.executable, "-c", "from orchestration.cli import main; main()"]
    command = [*entry, "run", "fig5", "--stop", "0.001", "--controller", str(slave), "--set", "controller.M[1]=0"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    said = r"Error: controller: fmi2\w+ returned fmi2Fatal during initialization; its last message: .*division by zero"
    assert re.search(said, ended.stderr, re.DOTALL), ended.stderr
    assert ended.returncode == 2, "start values are part of the request"


@needs_pythonfmu
def test_check_has_no_objection_to_the_python_class(slave: Path) -> None:
    report = check(slave, loop=paper_loop)
    assert_only(report, PYTHONFMU, OPTIONAL)
    notes = [f.message for f in report.findings if f.rule == "8"]
    assert any("of a Python interpreter that the importing process must have" in note for note in notes)


@pytest.mark.parametrize("sequential", [True, False])
def test_a_container_of_our_fmus(fig5: System, tmp_path: Path, sequential: bool) -> None:
    """Bitwise the loop of its parts.

    In sequence, the controller sees the trajectory of this tick, as in the order of Fig. 5. Else it sees what
    the trajectory showed before the step: one step late, as in a system in which it comes before the trajectory.
    """
    packed = fig5.replace("controller", container(fig5, tmp_path / "packed.fmu", sequential=sequential))
    assert dropped(packed) >= {f"{name}[{i}]" for name in ("x_v", "dx_v", "ddx_v") for i in (1, 2)}
    parts = fig5 if sequential else fig5.ordered(LATE)
    controllers = [f"controller.{name}[{i + 1}]" for name, size in OUTPUTS.items() for i in range(size)]
    columns = [f"plant.{name}[{i}]" for name in ("x", "F_ext") for i in (1, 2)] + controllers
    with pytest.warns(FmuWarning, match="FMUContainer"):  # it logs its version as a warning
        result = simulate(packed, options=Options(strict=True, record=columns))
    expected = simulate(parts, options=Options(strict=True, record=columns))
    assert np.abs(expected["plant.F_ext[1]"]).max() > 400, "N: the tip has been at the wall"
    np.testing.assert_array_equal(result.rows, expected.rows)
    other = fig5.ordered(LATE) if sequential else fig5
    short = simulate(other, stop_time=0.01, options=Options(strict=True, record=columns))
    assert not np.array_equal(result.rows[: len(short.time)], short.rows), "the step of delay shows"


def test_check_has_no_error_for_the_container(fig5: System, tmp_path: Path) -> None:
    """The toolbox drops units and dependencies, and its runtime trusts its host: `check` says both."""
    report = check(container(fig5, tmp_path / "packed.fmu", sequential=True), loop=paper_loop, timeout=LONG_ENOUGH)
    virtual = r"The input (x_v|dx_v|ddx_v)\[1\].* of the controller is missing; its connection is dropped"
    assert_only(report, TOOLBOX, (*OPTIONAL, virtual))
