"""Tests of systems whose FMUs have Reals only: an engine that can move nothing but Reals runs them as the master does.

ROS 2's fmi_adapter, CoFMuPy and PathSim are such engines. `plain_loop` is one of ours, and knows fmi2GetReal and
fmi2SetReal only.
"""

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import ContinuousModel, Type, build
from adaptimp_fmu.description import STANDS_FOR as WRITTEN
from orchestration import Algorithm, Connection, System, SystemDescriptionError, scenario, simulate
from orchestration.fmi.codes import STANDS_FOR
from orchestration.paper.closed_loop import paper_loop
from orchestration.paper.scenarios import SCENARIOS, VARIANTS
from tests.interop.plain_loop import Groups, columns_of, one_by_one, run, simultaneous
from tests.unit.orchestration.checked import check

FULL, SHORT = 100_000, 2_000  # steps of 2e-5 s: 2 s with contact, noise and adaptation, and 40 ms


@pytest.mark.parametrize(
    ("algorithm", "order", "n_steps"), [("gauss-seidel", one_by_one, FULL), ("jacobi", simultaneous, SHORT)]
)
def test_fig5_with_reals_alone_is_the_masters_run_bitwise(
    algorithm: str, order: Callable[[System], Groups], n_steps: int
) -> None:
    """The master runs the FMUs with Booleans."""
    reals = scenario("fig5-first", reals=True)
    rows = run(reals, n_steps, order(reals))
    result = simulate(scenario("fig5-first"), n_steps * reals.run_step(), algorithm=algorithm)
    assert set(columns_of(reals)) == set(result.names)
    for name, column in zip(columns_of(reals), rows.T, strict=True):
        assert column.tobytes() == result[name].tobytes(), name
    assert np.ptp(result["controller.p_hat[2]"]) > 0
    assert (np.abs(result["plant.F_ext[1]"]).max() > 100) == (n_steps == FULL)  # N, the wall


def test_the_order_makes_a_difference() -> None:
    """Else the test above could not tell one algorithm from another."""
    system = scenario("fig5", reals=True)
    assert (run(system, 20, one_by_one(system)) != run(system, 20, simultaneous(system))).any()


def test_a_boolean_is_no_real_for_the_loop() -> None:
    with pytest.raises(AssertionError, match="all variables must be Reals"):
        run(scenario("fig5"), 1, [])


@pytest.mark.parametrize("name", [*SCENARIOS, *VARIANTS])
def test_the_master_runs_both_with_the_same_bits(name: str) -> None:
    usual, reals = scenario(name), scenario(name, reals=True)
    stop = 200 * usual.run_step()
    expected, found = simulate(usual, stop), simulate(reals, stop)
    assert found.names == expected.names
    assert found.rows.tobytes() == expected.rows.tobytes()


def _switched(folder: Path, *, reals: bool) -> System:
    """A clock that opens a valve after half a second, and the tank that the valve fills."""
    clock = ContinuousModel("Clock", "Opens a valve")
    clock.output("on", clock.time > 0.5, type=Type.BOOLEAN, description="Whether the valve is open", scalar=True)
    clock.output("t", clock.time, unit="s", description="Time, which makes the clock continuous", scalar=True)
    tank = ContinuousModel("Tank", "Is filled")
    on = tank.input("on", 0, type=Type.BOOLEAN, description="Whether the valve is open")
    level = tank.state("level", 0.0)
    tank.derivative(level, on)
    tank.output("level", level, description="Level", scalar=True)
    files = {name: build(model, folder, reals=reals) for name, model in (("clock", clock), ("tank", tank))}
    return System.of(files).connect("clock.on -> tank.on")


def test_they_are_held_where_other_inputs_move(tmp_path: Path) -> None:
    """A straight line through 0 and 1 would be neither, and the FMU takes no derivative of such an input."""
    runs = [
        simulate(_switched(tmp_path / str(reals), reals=reals), 1.0, 0.1, Algorithm("straight", order=1))
        for reals in (False, True)
    ]
    assert runs[0].names == runs[1].names
    assert runs[0].rows.tobytes() == runs[1].rows.tobytes()
    assert 0.3 < runs[0]["tank.level"][-1] < 0.7


def test_a_verdict_leaves_them_out_as_it_leaves_out_booleans() -> None:
    usual, reals = (scenario("fig5", reals=reals).stability(1e-5) for reals in (False, True))
    assert reals.radius == usual.radius
    assert str(reals) == str(usual)


@pytest.mark.parametrize("name", ["ForceSensor", "Actuator", "CraigAdaptiveImpedance"])
def test_check_finds_nothing(name: str, reals_folder: Path) -> None:
    """A controller drives the closed loop, in which the actuator has Reals, too."""
    report = check(reals_folder / f"{name}.fmu", loop=paper_loop, timeout=600.0)
    assert report.findings == ()
    assert not any("kept at their start" in fact for fact in report.facts)
    assert ("Closed loop" in str(report.facts)) == (name == "CraigAdaptiveImpedance")


def test_start_values_may_be_given_as_booleans() -> None:
    system = scenario("fig5", reals=True).set({"sensor.contact_gated": False, "controller.projection": "true"})
    assert (system["sensor"]["contact_gated"], system["controller"]["projection"]) == (0.0, 1.0)
    for path, value in {"sensor.contact_gated": 0.5, "sensor.seed": 1.5, "controller.update_divisor": "true"}.items():
        with pytest.raises(SystemDescriptionError, match=path):
            system.set({path: value})


def test_a_package_with_booleans_runs_with_the_fmus_of_reals_in_it(reals_folder: Path, tmp_path: Path) -> None:
    """The names are the same, so the files can take each other's place."""
    package = scenario("fig5").write(tmp_path / "fig5.ssp")
    with zipfile.ZipFile(package) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    assert b"ssv:Boolean" in b"".join(entries.values())
    with zipfile.ZipFile(tmp_path / "changed.ssp", "w") as archive:
        for name, content in entries.items():
            own = reals_folder / Path(name).name
            archive.writestr(name, own.read_bytes() if own.suffix == ".fmu" and own.exists() else content)
    system = System.read(tmp_path / "changed.ssp")
    assert {v.type for c in system.components for v in c.description.variables.values()} == {"Real"}
    stop = 50 * system.run_step()
    assert simulate(system, stop).rows.tobytes() == simulate(scenario("fig5"), stop).rows.tobytes()


def test_a_boolean_is_not_connected_to_a_real(fmu_folder: Path, reals_folder: Path) -> None:
    parts = {"actuator": fmu_folder / "Actuator.fmu", "controller": reals_folder / "CraigAdaptiveImpedance.fmu"}
    connection = Connection("actuator", "saturated[1]", "controller", "saturated[1]")
    with pytest.raises(SystemDescriptionError, match="types Boolean and Real differ"):
        System.of(parts).connect(connection)


def test_both_sides_know_the_declared_types_by_the_same_names() -> None:
    assert {name: type.value for type, (name, _) in WRITTEN.items()} == STANDS_FOR
