"""Tests that the benchmarks run, and compare programs that compute the same; no time is asserted."""

import json
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from adaptimp_fmu import host_platform
from orchestration.paper.built_fmus import find_scenario, fmus
from tests.benchmarks import campaign, containers, isolation, master, overhead, paper, reruns, scale, scaling, start
from tests.benchmarks.forms import CProgram
from tests.benchmarks.rig import BenchmarkError, Rig
from tests.benchmarks.sizes import BINARY_LIMIT, MODULE_LIMIT
from tests.benchmarks.trivial import ring
from tests.benchmarks.variants import Bench
from tests.untested import PROPERTY

N_STEPS = 200
# Before the tip touches the wall too, noise is seen, and the actuator saturates now and then.
NOISE = {"sensor.contact_gated": False, "sensor.noise_std": 30.0, "sensor.noise_bound": 90.0}
SATURATION = {"actuator.tau_max[1]": 150.0, "controller.freeze_when_saturated": True}
CHANGES = {"fig2": NOISE, "fig5": {**NOISE, **SATURATION, "controller.update_divisor": 4}}
PARTS = ("set", "do_step", "get", "link copies", "recording")
Record = Callable[[str, object], None]


@pytest.fixture(params=master.SCENARIOS)
def bench(request: pytest.FixtureRequest):
    """A system of the paper with `CHANGES`, ready to run `N_STEPS` steps."""
    about = find_scenario(request.param)
    with Bench(about.system(fmus(about.models.values())).set(CHANGES[about.name]), N_STEPS) as b:
        yield b


def test_every_loop_records_the_same_bits(bench: Bench) -> None:
    ours = bench.records(bench.time_ours, N_STEPS)
    assert ours.shape == (N_STEPS + 1, len(bench.assembly.columns))
    for measure in (bench.time_c, bench.time_fmpy):
        assert bench.records(measure, N_STEPS).tobytes() == ours.tobytes()
    assert bench.first_contact(ours) == N_STEPS + 1
    assert bench.check_bare(ours) == N_STEPS


def test_the_comparison_has_noise_slow_updates_and_saturation() -> None:
    about = find_scenario("fig5")
    system = about.system(fmus(about.models.values())).set(CHANGES["fig5"])
    with Bench(system, N_STEPS) as b:
        ours = b.records(b.time_ours, N_STEPS)
        column = b.assembly.columns.index
        draws = round(N_STEPS * system.run_step() / find_scenario("fig5").values["sensor.noise_period"].number)
        assert len(np.unique(ours[1:, column("sensor.F_hat[1]")])) == draws > N_STEPS / 8
        assert set(ours[:, column("actuator.saturated[1]")]) == {0.0, 1.0}
        changes = np.flatnonzero(np.diff(ours[:, column("controller.p_hat[2]")]))
        assert len(changes) > N_STEPS / 16
        assert set(np.diff(changes) % 4) == {0}


def test_a_repetition_begins_where_the_first_began(bench: Bench) -> None:
    first = bench.records(bench.time_c, N_STEPS)
    assert bench.records(bench.time_c, N_STEPS).tobytes() == first.tobytes()


def test_a_component_alone_repeats_what_it_did_in_the_run(bench: Bench) -> None:
    ours = bench.records(bench.time_ours, N_STEPS)
    inputs = bench.inputs(ours)
    assert inputs["controller"].booleans.shape[1] == (2 if "controller.mu" in bench.assembly.columns else 0)
    row = np.empty(ours.shape[1])
    for i, (name, given) in enumerate(inputs.items()):
        columns = [j for j, path in enumerate(bench.assembly.columns) if path.startswith(f"{name}.")]
        bench.time_component(i, given, (1, 1, 1))
        bench.assembly.record(row)
        assert row[columns].tobytes() == ours[-1, columns].tobytes()
        bench.time_unit(name, given, step=True)
        assert bench.bare.outputs(name, len(columns)).tobytes() == ours[-1, columns].tobytes()


def test_a_difference_is_an_error(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(b: Bench, n: int) -> np.ndarray:
        seconds = b.time_ours(n)
        b.rows[n // 2, 0] += 1e-12
        return seconds

    monkeypatch.setattr(Bench, "time_c", wrong)
    with pytest.raises(BenchmarkError, match=f"c differ from ours, first in row {N_STEPS // 2}"):
        master.check(bench, N_STEPS)


@pytest.mark.parametrize("every", [1, 7, 10])
def test_the_c_loop_records_every_nth_step_as_ours_does(every: int) -> None:
    with Rig(ring(3, 2), N_STEPS, piece=33) as rig:
        all_rows = rig.records(rig.time_ours, N_STEPS)
        for measure in (rig.time_c, rig.time_ours):
            rows = rig.records(lambda n, measure=measure: measure(n, every=every), N_STEPS)
            count = N_STEPS // every + 1
            assert rows[:count].tobytes() == all_rows[::every][:count].tobytes()
            assert np.isnan(rows[count:]).all()


def assert_measured(found: Mapping[str, Any], variants: Iterable[str], record_property: Record) -> None:
    """Each variant has a time, or says why it is missing; the end of the run of the tests says so too."""
    for variant in variants:
        if "unavailable" in found[variant]:
            record_property(PROPERTY, found[variant]["unavailable"])
        else:
            assert found[variant]["minimum_ns"] > 0


@pytest.mark.parametrize("name", master.SCENARIOS)
def test_master_writes_its_numbers(name: str, tmp_path: Path, record_property: Record) -> None:
    file = tmp_path / "speed.json"
    arguments = ["--scenario", name, "--json", str(file), "--steps", str(N_STEPS), "--repetitions", "1"]
    assert master.main(arguments) == 0
    result = json.loads(file.read_text(encoding="utf-8"))
    assert_measured(result, (*master.FAST, *master.SLOW), record_property)
    assert result["checks"] == {
        "c_equals_ours_bitwise": True,
        "steps_compared": N_STEPS,
        "bare_equals_ours_steps": N_STEPS,
    }
    assert set(result["per_fmu"]) == {"trajectory", "sensor", "controller", "actuator", "plant"}
    assert result["per_fmu"]["plant"].keys() == {"bare", "set", "do_step", "get"}
    for parts in result["parts"].values():
        assert parts["sum"] == pytest.approx(sum(parts[part] or 0.0 for part in PARTS))
        assert parts["left"] == pytest.approx(parts["whole"] - parts["sum"])
    assert {"ratios", "goals", "machine", "versions"} <= result.keys()


def test_containers_writes_its_numbers(tmp_path: Path, record_property: Record) -> None:
    file, steps, here = tmp_path / "containers.json", str(containers.LONG), host_platform().name
    arguments = ["--scenario", "fig2", "--steps", steps, "--repetitions", "1", "--platform", here, "--json", str(file)]
    assert containers.main(arguments) == 0
    result = json.loads(file.read_text(encoding="utf-8"))
    assert_measured(result, containers.MEANING, record_property)
    assert {"c/bare", "fmu-1000/ours", "fmucontainer/ours"} <= result["ratios"].keys()
    assert result["bytes"]["wasm"] < MODULE_LIMIT
    assert result["bytes"][here] < BINARY_LIMIT
    assert {goal["what"] for goal in result["goals"]} >= {"fmu-1000/bare", "wasm, bytes", f"{here}, bytes"}


def test_a_form_that_computes_something_else_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    real = CProgram.time_rows

    def wrong(program: CProgram, n: int, rig: Rig) -> np.ndarray:
        seconds = real(program, n, rig)
        rig.rows[n, 0] = np.nextafter(rig.rows[n, 0], np.inf)
        return seconds

    monkeypatch.setattr(CProgram, "time_rows", wrong)
    with pytest.raises(BenchmarkError, match=f"c-rows differ from ours, first in row {containers.LONG}"):
        containers.run("fig2", containers.LONG, 1, ())


def test_overhead_writes_its_numbers(tmp_path: Path, record_property: Record) -> None:
    file = tmp_path / "overhead.json"
    assert overhead.main(["--json", str(file), "--steps", str(N_STEPS), "--repetitions", "1"]) == 0
    result = json.loads(file.read_text(encoding="utf-8"))
    assert set(result["systems"]) == {"chain5x1", "ring5x6"}
    for found in result["systems"].values():
        assert_measured(found, overhead.MEANING, record_property)
    assert {"goals", "machine", "versions"} <= result.keys()


def test_scaling_measures_sizes_and_lengths() -> None:
    result = scaling.run((2, 3), (1, 2), (50,), repetitions=1, work=100)
    assert [(record["fmus"], record["variables"]) for record in result["size"]] == [(2, 1), (3, 1), (2, 2), (3, 2)]
    assert [record["steps"] for record in result["length"]] == [50]
    assert all(record["ours"] > 0 for record in result["size"])


@pytest.mark.skipif("sys.platform == 'win32'", reason="FMUs are not isolated on Windows")
def test_isolation_measures_each_choice(tmp_path: Path) -> None:
    file = tmp_path / "isolation.json"
    assert isolation.main(["--json", str(file), "--steps", str(N_STEPS), "--repetitions", "1"]) == 0
    result = json.loads(file.read_text(encoding="utf-8"))
    assert set(result["microseconds_per_step"]) == set(isolation.CHOICES)
    assert all(seconds > 0 for seconds in result["start_seconds"].values())


@pytest.mark.skipif("sys.platform == 'win32'", reason="FMUs are not isolated on Windows")
def test_reruns_measure_both_kinds_of_runs(tmp_path: Path) -> None:
    file = tmp_path / "reruns.json"
    assert reruns.main(["--json", str(file), "--repetitions", "1"]) == 0
    found = json.loads(file.read_text(encoding="utf-8"))["runs"]
    assert set(found) == {*reruns.CHOICES, "crash"}
    assert all(times["kept_open"] > 0 for times in found.values())


@pytest.mark.skipif("sys.platform == 'win32'", reason="peak memory is asked from the module resource of Unix")
def test_start_measures_fresh_processes() -> None:
    memory = start.measure_memory(1000)
    assert memory["in_memory"]["data"] == 8 * 1000 * 41
    assert all(found["few"] > 0 for found in memory.values())
    assert start.child("import", "json")["seconds"] > 0
    times = start.child("simulate", str(start.trivial_fmu(1)), "gauss-seidel")
    assert times.keys() == {"imports", "first", "second", "processor"}


def test_a_process_that_fails_is_an_error() -> None:
    with pytest.raises(RuntimeError, match="no_such_module"):
        start.child("import", "no_such_module")


@pytest.mark.skipif("sys.platform == 'win32'", reason="peak memory is asked from the module resource of Unix")
def test_campaign_writes_its_numbers(tmp_path: Path) -> None:
    file = tmp_path / "campaign.json"
    numbers = ("--runs", "4", "--repetitions", "1", "--fmpy-runs", "2", "--memory-runs", "40", "--stop-time", "0.02")
    assert campaign.main([*numbers, "--json", str(file)]) == 0
    result = json.loads(file.read_text(encoding="utf-8"))
    assert all(result[variant]["minimum_ns"] > 0 for variant in ("bare", "engine"))
    for times in (result["study"], result["one/two"], result["fmpy_per_run"]):
        assert times["wall"] > 0
        assert times["processor"] > 0
    assert result["rss"]["end"] >= result["rss"]["tenth"] > 0
    assert len(result["goals"]) == 5


def test_a_sweep_over_fmpy_that_measures_something_else_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaign, "time_sweep", lambda _sweep, rows, _workers: ({}, np.zeros((len(rows), 3))))
    with pytest.raises(BenchmarkError, match="The sweep over fmpy measures something else"):
        campaign._beside_fmpy(campaign._system(), 2, 0.02)


def test_scale_measures_three_sizes_of_each_wiring(tmp_path: Path) -> None:
    file = tmp_path / "scale.json"
    assert scale.main(["--json", str(file), "--wiring", "star", "scattered", "--size", "2", "3", "4"]) == 0
    result = json.loads(file.read_text(encoding="utf-8"))
    counts = [(r["wiring"], r["components"], r["variables"], r["connections"]) for r in result["sizes"]]
    star = [("star", n, 10 * n, 3 * (n - 1)) for n in (2, 4, 8)]
    assert counts == [*star, *(("scattered", n, 10 * n, 3 * n) for n in (2, 4, 8))]
    assert set(result["growth"]["star"]) == set(scale.PHASES)


KEEPS = "import os, sys; os.makedirs(os.environ['ADAPTIMP_CACHE'] + '/kept'); sys.exit(len(sys.argv) != 2)"


def test_paper_is_measured_with_an_empty_and_then_the_same_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paper, "STATES", ("cold",))
    assert set(paper.run([sys.executable, "-c", KEEPS])["cold"]) == {"elapsed", "processor"}
    monkeypatch.setattr(paper, "STATES", ("cold", "cached"))
    with pytest.raises(RuntimeError, match="kept"):
        paper.run([sys.executable, "-c", KEEPS])
