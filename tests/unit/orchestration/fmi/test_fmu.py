"""Tests of an FMU that is driven with arrays: outputs, states, and the sentences of errors."""

import ctypes
import re
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.logging import addLoggerProxy

from adaptimp_fmu import SampledModel, Type, build
from fmus.mechanics.planar_arm import PlanarArm
from orchestration import ArchiveError, Fmu, InitializationError, SignalError, SimulationError, SystemDescriptionError
from orchestration.fmi import logging
from orchestration.fmi.testing import fmu
from tests.driver import Driver

Open = Callable[..., Fmu]
H = 1e-3  # s
Q, DQ = np.array([0.3, 1.0]), np.array([0.5, -1.0])  # rad, rad/s
REST = {"q_start": Q, "dq_start": [0.0, 0.0]}

_ = fmu  # the fixture: imported, so that it is this module's


@pytest.fixture(scope="module")
def counter(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU with every type: what it shows is what was set, and the number of ticks times `gain`."""
    model = SampledModel("Counter", "Counts ticks", sample_time=H)
    u = model.input("u", [0.0] * 11, description="A long array")
    whole = model.input("whole", 0, type=Type.INTEGER, description="An integer")
    flag = model.input("flag", [False, False], type=Type.BOOLEAN, description="Two flags")
    gain = model.parameter("gain", 1.0, tunable=True, description="A gain")
    count = model.state("count", ca.SX(0))
    model.update(count, count + 1)
    model.output("y", u, description="u")
    model.output("n", gain * count, description="Ticks", scalar=True)
    model.output("whole_y", whole, type=Type.INTEGER, description="whole", scalar=True)
    model.output("flag_y", flag, type=Type.BOOLEAN, description="flag")
    return build(model, tmp_path_factory.mktemp("counter"))


def with_description(source: Path, path: Path, before: str, after: str) -> Path:
    """A copy of an FMU with its description changed."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(path, "w") as new:
        for entry in old.namelist():
            content = old.read(entry)
            if entry == "modelDescription.xml":
                assert before in content.decode()
                content = content.decode().replace(before, after).encode()
            new.writestr(entry, content)
    return path


def test_drive_is_what_single_calls_give(fmu_folder: Path, fmu: Open) -> None:
    """Bit for bit, against the tests' own driver: same calls, same times k h."""
    tau = np.random.default_rng(1).normal(size=(50, 2))
    opened = fmu(fmu_folder / "Plant.fmu", q_start=Q, dq_start=DQ)
    rows = opened.drive(H, {"tau": tau})
    driver = Driver(fmu_folder / "Plant.fmu")
    driver.initialize({f"{name}_start[{i + 1}]": v[i] for name, v in (("q", Q), ("dq", DQ)) for i in (0, 1)})
    for k in range(50):
        driver.set({"tau[1]": tau[k, 0], "tau[2]": tau[k, 1]})
        driver.step(k * H, H)
        for name, value in driver.outputs().items():
            assert rows[name][k] == value
    names = set(driver.outputs())
    driver.close()
    assert {values.dtype for values in rows.values()} == {np.dtype(float)}
    assert set(rows) == {*names, "q", "dq", "ddq", "x", "dx", "F_ext"}
    np.testing.assert_array_equal(rows["q"], np.column_stack([rows["q[1]"], rows["q[2]"]]))
    assert (opened.steps, opened.time) == (50, 50 * H)


def test_a_plant_shows_the_acceleration_of_its_equations(fmu_folder: Path, fmu: Open) -> None:
    """At rest and without gravity ddq = H^-1 tau: both invert the same 2 x 2, condition about 10."""
    opened = fmu(fmu_folder / "Plant.fmu", **REST, tau=[3.0, -1.0])
    inertia = np.array(PlanarArm(2).inertia(Q, [2.0, 1.0], [1.0, 1.0]))
    np.testing.assert_allclose(opened.outputs()["ddq"], np.linalg.solve(inertia, [3.0, -1.0]), rtol=1e-13)


def test_times_elements_and_the_step_give_the_same(fmu_folder: Path, fmu: Open) -> None:
    """Steps of 2^-10 s: k h and differences of times are exact."""
    h, tau = 2.0**-10, np.random.default_rng(2).normal(size=(20, 2))
    path = fmu_folder / "Plant.fmu"
    by_step = fmu(path, **REST).drive(h, {"tau": tau})
    by_times = fmu(path, **REST).drive(h * np.arange(21), {"tau[2]": tau[:, 1], "tau[1]": tau[:, 0]})
    apart = fmu(path, **REST)
    parts = [apart.drive(h * np.arange(8), {"tau": tau[:7]}), apart.drive(h, {"tau": tau[7:]})]
    for name, values in by_step.items():
        np.testing.assert_array_equal(values, by_times[name])
        np.testing.assert_array_equal(values, np.concatenate([part[name] for part in parts]))


def test_a_controller_reads_the_row_of_its_tick(fmu_folder: Path, fmu: Open) -> None:
    """The torque is affine in the force, (4): half the force, half the change."""
    force = np.zeros((4, 2))
    force[1], force[2] = (20.0, -8.0), (10.0, -4.0)
    opened = fmu(fmu_folder / "HoganImpedance.fmu", sample_time=H, p_start=[2.0, 1.0, 0, 0, 0, 0])
    tau = opened.drive(H, {"F_hat": force})["tau_cmd"]
    np.testing.assert_allclose(tau[1] - tau[0], 2 * (tau[2] - tau[0]), rtol=1e-9)  # of 10 in 100 N.m: 1e-14
    assert np.abs(tau[1] - tau[0]).max() > 1
    np.testing.assert_array_equal(tau[3], tau[0])


def test_start_values_and_outputs_by_array_and_by_element(fmu_folder: Path, fmu: Open) -> None:
    opened = fmu(fmu_folder / "HoganImpedance.fmu", **{"p_start[2]": 2.5}, K=[1e3, 2e3])
    np.testing.assert_array_equal(opened.outputs()["p_hat"], [2.0, 2.5, 0, 0, 0, 0])
    assert opened.outputs()["p_hat[2]"].shape == ()


def test_types_long_arrays_and_tunable_parameters(counter: Path, fmu: Open) -> None:
    opened = fmu(counter, gain=2.0)
    u = np.arange(33.0).reshape(3, 11)  # u[10] comes after u[9], not after u[1]
    inputs = {
        "u": u,
        "whole": np.array([1, 5, -3]),
        "flag": np.eye(3, 2, dtype=bool),
        "gain": np.array([2.0, 2.0, 0.5]),
    }
    rows = opened.drive(H, inputs)
    np.testing.assert_array_equal(rows["y"], u)
    np.testing.assert_array_equal(rows["y[10]"], u[:, 9])
    np.testing.assert_array_equal(rows["whole_y"], [1.0, 5.0, -3.0])
    np.testing.assert_array_equal(rows["flag_y"], np.eye(3, 2))
    np.testing.assert_array_equal(rows["n"], [0.0, 2.0, 1.0])
    opened.set(whole=7)
    opened.step(H)
    assert opened.outputs()["whole_y"] == 7


def test_long_runs_miss_no_tick(counter: Path, fmu: Open) -> None:
    opened = fmu(counter)
    parts = [opened.drive(H, {"whole": np.zeros(1000)})["n"] for _ in range(3)]
    np.testing.assert_array_equal(np.concatenate(parts), np.arange(3000.0))
    assert opened.time == 3000 * H  # a sum of 1e-3 is not


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (
            lambda u: u.set(torque=1.0),
            "Plant has no variable torque; there are dt_max, q_start, dq_start",
        ),
        (lambda u: u.set(tau=1.0), "Plant: tau takes an array of shape (2,), not ()."),
        (lambda u: u.set(**{"tau[1]": [1.0]}), "Plant: tau[1] takes an array of shape (), not (1,)."),
        (lambda u: u.set(tau="much"), "Plant: tau takes numbers, not 'much'."),
        (lambda u: u.set(**{"tau[1]": "much"}), "Plant: tau[1] takes numbers, not 'much'."),
        (lambda u: u.set(tau=None), "Plant: tau takes"),
        (lambda u: u.set(tau=[1.0, [2.0]]), "Plant: tau takes numbers, not"),
        (lambda u: u.drive(H, {"torque": np.zeros(3)}), "Plant has no variable torque; there are dt_max"),
        (
            lambda u: u.drive(H, {"q": np.zeros((3, 2))}),
            "Plant has no input q, which is of causality output; its inputs and tunable parameters are tau (2).",
        ),
        (lambda u: u.drive(H, {"tau": np.zeros((3, 3))}), "Plant: tau takes an array of shape (n, 2), not (3, 3)."),
        (lambda u: u.drive(H, {"tau": np.zeros(2)}), "Plant: tau takes an array of shape (n, 2), not (2,)."),
        (lambda u: u.drive(H, {"tau[2]": np.zeros((3, 1))}), "tau[2] takes an array of shape (n,), not (3, 1)."),
        (
            lambda u: u.drive(H, {"tau[1]": np.zeros(3), "tau[2]": np.zeros(2)}),
            "Plant: 3 steps, but tau[2] has 2 rows; an input has one row per step.",
        ),
        (lambda u: u.drive([0.0, H], {"tau": np.zeros((2, 2))}), "Plant: 1 steps, but tau has 2 rows"),
        (lambda u: u.drive(H, {}), "without inputs, drive needs all communication points"),
        (lambda u: u.drive([H, 2 * H]), "Plant: times begin at 0.001 s, but the FMU is at t = 0 s."),
        (lambda u: u.drive([0.0, H, H]), "Plant: times must be n + 1 finite, increasing communication points"),
        (lambda u: u.drive([0.0]), "Plant: times must be n + 1 finite"),
        (lambda u: u.drive([0.0, np.inf]), "Plant: times must be n + 1 finite"),
        (lambda u: u.drive(0.0, {"tau": np.zeros((2, 2))}), "Plant: the step at t = 0 s is 0 s; it must be positive"),
        (lambda u: u.step(float("nan")), "Plant: the step at t = 0 s is nan; give a finite number, in s."),
        (
            lambda u: u.drive(H, {"tau": np.zeros((2, 2)), "tau[1]": np.ones(2)}),
            "Plant: tau[1] is given twice, also by tau.",
        ),
    ],
)
def test_what_does_not_fit_is_refused_and_nothing_is_done(
    fmu_folder: Path, fmu: Open, call: Callable[[Fmu], object], sentence: str
) -> None:
    opened = fmu(fmu_folder / "Plant.fmu", **REST, tau=[1.0, 2.0])
    before = opened.outputs()["ddq"]
    with pytest.raises(SignalError, match=re.escape(sentence)):
        call(opened)
    np.testing.assert_array_equal(opened.outputs()["ddq"], before)
    assert (opened.steps, opened.time) == (0, 0.0)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"whole": 1.5}, "Counter: whole is of type Integer; 1.5 is not."),
        ({"whole": np.nan}, "Counter: whole is of type Integer; nan is not."),
        ({"flag": [0, 2]}, "Counter: flag[2] is of type Boolean; 2.0 is not."),
    ],
)
def test_values_are_not_rounded(counter: Path, fmu: Open, values: dict[str, float], sentence: str) -> None:
    with pytest.raises(SignalError, match=re.escape(sentence)):
        fmu(counter).set(**values)


def test_a_failing_step_says_when_and_why(fmu_folder: Path, fmu: Open) -> None:
    opened = fmu(fmu_folder / "Plant.fmu", **REST)
    tau = np.zeros((10, 2))
    tau[7, 1] = np.nan
    sentence = (
        "Plant: fmi2DoStep returned fmi2Error at t = 0.007 s (step 7);"
        ' its last message: "Input tau[2] is nan; it must be finite.".'
    )
    with pytest.raises(SimulationError, match=re.escape(sentence)):
        opened.drive(H, {"tau": tau})
    assert opened.messages[-1] == "Input tau[2] is nan; it must be finite."


@pytest.mark.parametrize(
    ("start", "sentence"),
    [
        (
            {"m": [-1.0, 1.0]},
            r"Plant: fmi2SetReal returned fmi2Error at t = 0 s \(step 0\); .*m\[1\] = -1 must be",
        ),
        ({"wall_normal": [1.0, 1.0]}, "Plant: fmi2ExitInitializationMode returned fmi2Error .*must have length 1"),
    ],
)
def test_a_refused_start_says_why_and_leaves_nothing(
    fmu_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, start: dict[str, Any], sentence: str
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(InitializationError, match=sentence):
        Fmu(fmu_folder / "Plant.fmu", **start)
    assert list(tmp_path.iterdir()) == []


def test_what_was_unpacked_is_removed_and_a_closed_unit_says_so(
    fmu_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with Fmu(fmu_folder / "Plant.fmu") as opened:
        assert list(tmp_path.iterdir()) != []
    assert list(tmp_path.iterdir()) == []
    opened.close()
    with pytest.raises(SimulationError, match=r"Plant is closed; open it again"):
        opened.step(H)


def test_what_is_no_unit_of_this_machine(fmu_folder: Path, tmp_path: Path) -> None:
    plant, other = fmu_folder / "Plant.fmu", tmp_path / "other.fmu"
    with pytest.raises(ArchiveError, match=r"missing\.fmu: there is no such FMU"):
        Fmu(tmp_path / "missing.fmu")
    other.write_text("no archive")
    with pytest.raises(ArchiveError, match=r"other\.fmu is not a readable zip archive"):
        Fmu(other)
    identifier = 'modelIdentifier="Plant"'
    with pytest.raises(ArchiveError, match=r"other\.fmu has no binary for \S+, this machine; it has \S+"):
        Fmu(with_description(plant, other, identifier, 'modelIdentifier="Other"'))
    with pytest.raises(InitializationError, match='fmi2Instantiate failed; its last message: "'):
        Fmu(with_description(plant, other, 'guid="', 'guid="0'))
    exchange = with_description(plant, other, "CoSimulation", "ModelExchange")
    with pytest.raises(ArchiveError, match=r"other\.fmu is an FMI 2\.0 FMU for model exchange"):
        Fmu(exchange)


def test_messages_go_to_their_unit(fmu_folder: Path, fmu: Open) -> None:
    """The proxy of fmpy knows one logger at a time; here another tool takes it over."""
    first, second = fmu(fmu_folder / "Plant.fmu"), fmu(fmu_folder / "HoganImpedance.fmu")
    theirs = fmi2CallbackFunctions()
    theirs.logger = fmi2CallbackLoggerTYPE(lambda *_: None)
    addLoggerProxy(ctypes.byref(theirs))
    with pytest.raises(SimulationError):
        first.set(m=[1.0, 1.0])
    assert "m[1] is a fixed parameter" in first.messages[-1]
    assert list(second.messages) == []


def test_without_the_proxy_messages_stay_as_the_fmu_wrote_them(
    fmu_folder: Path, fmu: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Linux on ARM has none: the format is all that Python sees."""
    monkeypatch.setattr(logging, "_proxy", lambda: None)
    opened = fmu(fmu_folder / "Plant.fmu")
    with pytest.raises(SimulationError, match=r"m\[1\] is a fixed parameter"):
        opened.set(m=[1.0, 1.0])


def test_a_saved_state_brings_back_outputs_and_time(fmu_folder: Path, fmu: Open) -> None:
    """Bit for bit, in the same instance and in another one."""
    tau = np.random.default_rng(3).normal(size=(20, 2))
    opened = fmu(fmu_folder / "Plant.fmu", **REST)
    opened.drive(H, {"tau": tau})
    state = opened.save()
    assert isinstance(state, bytes)
    after = opened.drive(H, {"tau": tau})
    other = fmu(fmu_folder / "Plant.fmu")
    for restored in (opened, other):
        restored.restore(state)
        assert (restored.time, restored.steps) == (20 * H, 20)
        again = restored.drive(H, {"tau": tau})
        for name, values in after.items():
            np.testing.assert_array_equal(again[name], values)


def without(flag: str, source: Path, folder: Path) -> Path:
    """A copy of an FMU that does not declare a capability."""
    declared = f'{flag}="true"'
    return with_description(source, folder / source.name, declared, declared.replace("true", "false"))


def test_a_state_that_is_not_serialized_belongs_to_its_instance(fmu_folder: Path, tmp_path: Path, fmu: Open) -> None:
    path = without("canSerializeFMUstate", fmu_folder / "Plant.fmu", tmp_path)
    opened, other = fmu(path, **REST), fmu(path)
    state = opened.save()
    shown = opened.outputs()["q"]
    opened.drive(H, {"tau": np.ones((5, 2))})
    opened.restore(state)
    np.testing.assert_array_equal(opened.outputs()["q"], shown)
    assert opened.time == 0.0
    with pytest.raises(SignalError, match=r"Plant: the state to restore is of another FMU, or damaged"):
        other.restore(state)


def serialized(unit: Fmu) -> bytes:
    """Return the state of an FMU that serializes it."""
    state = unit.save()
    assert isinstance(state, bytes)
    return state


def test_states_that_fit_no_instance_are_refused(fmu_folder: Path, tmp_path: Path, fmu: Open, counter: Path) -> None:
    opened = fmu(fmu_folder / "Plant.fmu")
    for foreign in (fmu(counter).save(), b"", serialized(opened)[:30]):
        with pytest.raises(SignalError, match="of another FMU, or damaged"):
            opened.restore(foreign)
    with pytest.raises(SimulationError, match="Plant: fmi2DeSerializeFMUstate returned fmi2Error"):
        opened.restore(serialized(opened)[:-1])
    path = without("canGetAndSetFMUstate", fmu_folder / "Plant.fmu", tmp_path)
    with pytest.raises(SystemDescriptionError, match=r"Plant\.fmu does not declare canGetAndSetFMUstate"):
        fmu(path).save()


def test_it_says_what_it_is(fmu_folder: Path) -> None:
    opened = Fmu(fmu_folder / "Plant.fmu", {"q_start[1]": 0.3}, start_time=2.0)
    assert repr(opened) == "<Fmu Plant at t = 2 s>"
    assert opened.variables["tau[1]"].unit == "N.m"
    opened.close()
    assert repr(opened) == "<Fmu Plant closed>"


def test_it_needs_neither_pytest_nor_fmpy_nor_numba(fmu_folder: Path) -> None:
    script = f"""
import sys
sys.modules["pytest"] = None
from orchestration import Fmu
with Fmu({str(fmu_folder / "Plant.fmu")!r}) as opened:
    opened.step(1e-3)
sys.exit("fmpy" in sys.modules or "numba" in sys.modules)
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_it_serves_as_a_plugin(fmu_folder: Path, tmp_path: Path) -> None:
    """In a project of somebody else, by `pytest_plugins`; the FMU is freed although the test fails."""
    (tmp_path / "test_theirs.py").write_text(f"""
import numpy as np
pytest_plugins = ["orchestration.fmi.testing"]
units = []
def test_open(fmu):
    units.append(fmu({str(fmu_folder / "Plant.fmu")!r}))
    assert units[0].drive(1e-3, {{"tau": np.zeros((5, 2))}})["x"].shape == (5, 2)
def test_freed():
    try:
        units[0].step(1e-3)
    except Exception as error:
        assert str(error) == "Plant is closed; open it again, as Fmu('Plant.fmu')."
    else:
        raise AssertionError
""")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(tmp_path)]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "2 passed" in run.stdout, run.stdout + run.stderr
