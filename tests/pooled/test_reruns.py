"""Runs with FMUs that stay open have the bits of runs with FMUs just loaded, whatever the FMUs' fmi2Reset does."""

import warnings
from collections.abc import Sequence

import pytest

from orchestration import Connection, SimulationError, System, SystemDescriptionError, scenario, simulate
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.pool import Reuse
from orchestration.master.form import FormalityWarning
from orchestration.master.open_system import After
from orchestration.master.options import Options
from orchestration.master.reruns import Reruns
from orchestration.results.result import Result
from tests.pooled.conftest import Pooled
from tests.pooled.fmus import Deed

STOP, STEP = 1.0, 0.125
POINTS = [{"source.p": 1.0 + k, "m.p": 10.0 - k} for k in range(5)]


def outcome(run, *arguments) -> Result | str:
    """What a run returns, or the sentence with which it fails."""
    try:
        return run(*arguments)
    except SimulationError as error:
        return str(error)


def ways(runs: Reruns, after: After = After.END) -> list[Reuse | None]:
    """How the FMUs of source and m are made like new."""
    return [runs.learned.way(after, (name,)) for name in ("source", "m")]


def run_all(runs: Reruns, system: System, points: Sequence[dict[str, float]] = POINTS) -> None:
    """Make all runs, and compare each with a run of its own."""
    for point in points:
        found = outcome(runs.run, point, STEP)
        truth = outcome(simulate, system.set(point), STOP, STEP)
        assert found == truth


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi", "iterative"])
def test_each_run_equals_a_run_of_its_own(pooled: Pooled, algorithm: str) -> None:
    system = pooled()
    with Reruns(system, STOP, algorithm) as runs:
        for point in POINTS:
            assert runs.run(point, STEP) == simulate(system.set(point), STOP, STEP, algorithm)
        assert ways(runs) == [Reuse.RESET, Reuse.RESET]


@pytest.mark.parametrize(
    ("kind", "given", "way"),
    [
        ("keeps", {}, Reuse.STATE),
        ("keeps", {"flags": ""}, Reuse.ANEW),
        ("refuses", {}, Reuse.STATE),
        ("good", {"library": "unresettable", "flags": ""}, Reuse.ANEW),
        ("counts", {}, Reuse.FRESH),
    ],
)
def test_an_fmu_that_resets_badly_is_made_like_new_in_another_way(
    pooled: Pooled, kind: str, given: dict[str, str], way: Reuse
) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormalityWarning)  # fmi2Reset may be missing
        system = pooled(kind, **given)
        with Reruns(system, STOP) as runs, warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", FormalityWarning)
            run_all(runs, system)
            assert ways(runs) == [Reuse.RESET, way]
    said = [str(warning.message) for warning in caught if "like new" in str(warning.message)]
    assert len(said) == 1
    assert said[0].startswith(f"{system['m'].path.name} ")


def test_an_fmu_in_a_process_of_its_own_is_loaded_once(pooled: Pooled) -> None:
    system = pooled()
    with Reruns(system, STOP, options=Options(isolate=["m"])) as runs:
        results = [runs.run(point, STEP) for point in POINTS]
        process = runs.processes
        again = runs.run(POINTS[0], STEP)
        assert runs.processes == process
        assert ways(runs) == [Reuse.RESET, Reuse.RESET]
    for point, found in zip([*POINTS, POINTS[0]], [*results, again], strict=True):
        assert found == simulate(system.set(point), STOP, STEP, isolate=["m"])


def test_a_step_may_differ_from_run_to_run(pooled: Pooled) -> None:
    system = pooled()
    with Reruns(system, STOP) as runs:
        for step in (0.125, 0.25, 0.125, 0.5):
            assert runs.run({}, step) == simulate(system, STOP, step)


@pytest.mark.parametrize("deed", [Deed.DIVERGE, Deed.REFUSE, Deed.DISCARD, Deed.TERMINATE, Deed.NOT_A_NUMBER])
def test_a_run_after_a_failure_equals_a_run_of_its_own(pooled: Pooled, deed: Deed) -> None:
    system = pooled()
    points = [{**point, "m.deed": float(deed)} if k in (1, 3, 4) else point for k, point in enumerate(POINTS * 2)]
    with Reruns(system, STOP) as runs:
        run_all(runs, system, points)


def test_an_fmu_that_resets_badly_after_failures_is_loaded_after_failures(pooled: Pooled) -> None:
    system = pooled("keeps after failures")
    points = [{**point, "m.deed": float(Deed.REFUSE)} if k % 2 else point for k, point in enumerate(POINTS)]
    with Reruns(system, STOP) as runs:
        run_all(runs, system, [*POINTS[:2], *points, *POINTS[:2]])
        assert ways(runs) == [Reuse.RESET, Reuse.RESET]
        assert ways(runs, After.FAILURE) == [Reuse.FRESH, Reuse.FRESH]


def test_an_fmu_is_not_called_after_fatal(pooled: Pooled) -> None:
    system = pooled()
    points = [{**point, "m.deed": float(Deed.FATAL)} if k in (1, 2) else point for k, point in enumerate(POINTS)]
    with Reruns(system, STOP) as runs:
        run_all(runs, system, points)


def test_values_that_are_refused_fail_their_run_alone(pooled: Pooled) -> None:
    system = pooled()
    with Reruns(system, STOP) as runs:
        runs.run(POINTS[0], STEP)
        with pytest.raises(SystemDescriptionError, match=r"m\.deed = 0\.5"):
            runs.run({"m.deed": 0.5}, STEP)
        assert runs.run(POINTS[1], STEP) == simulate(system.set(POINTS[1]), STOP, STEP)


def test_only_what_is_asked_for_is_recorded(pooled: Pooled) -> None:
    system = pooled()
    with Reruns(system, STOP, options=Options(record=["m.y", "m.p"])) as runs:
        for point in POINTS:
            found, truth = runs.run(point, STEP), simulate(system.set(point), STOP, STEP, record=["m.y", "m.p"])
            assert found == truth


def test_a_system_of_one_library_shares_it(pooled: Pooled) -> None:
    one = pooled()
    system = System.of({"a": one["source"], "b": one["source"]})
    with Reruns(system, STOP) as runs:
        for point in ({"a.p": 2.0}, {"a.p": 3.0, "b.p": 5.0}, {"b.p": 7.0}):
            assert runs.run(point, STEP) == simulate(system.set(point), STOP, STEP)
        assert runs.learned.way(After.END, ("a", "b")) == Reuse.RESET


def test_a_crash_costs_its_run(pooled: Pooled) -> None:
    system = pooled()
    crash = {**POINTS[0], "m.deed": float(Deed.CRASH)}
    careful = Isolation(["m"], time_limit=60.0)
    with Reruns(system, STOP, options=Options(isolate=careful)) as runs:
        for _ in range(2):
            with pytest.raises(SimulationError, match=r"m: fmi2DoStep died of SIGSEGV at t = 0\.5 s"):
                runs.run(crash, STEP)
            assert runs.run(POINTS[1], STEP) == simulate(system.set(POINTS[1]), STOP, STEP, isolate=["m"])


def test_scaled_inputs_stay_scaled_when_an_fmu_is_instantiated_again(pooled: Pooled) -> None:
    one = pooled("keeps", flags="")
    system = System("scaled", tuple(one.components)).connect(Connection("source", "y", "m", "u", factor=7.0))
    with Reruns(system, STOP) as runs:
        runs.run(POINTS[0], STEP)
        with pytest.warns(FormalityWarning, match="like new"):
            runs.run(POINTS[1], STEP)
        assert ways(runs) == [Reuse.RESET, Reuse.ANEW]
        run_all(runs, system)


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "iterative", "newton", "adaptive"])
def test_the_paper_s_loop_is_run_again_with_noise(algorithm: str) -> None:
    system = scenario("fig7").set({"sensor.noise_std": 10.0, "sensor.noise_bound": 30.0, "sensor.contact_gated": False})
    points = [{"sensor.seed": float(seed), "plant.K_f": 1e4 * (1 + seed)} for seed in range(5)]
    with Reruns(system, 0.02, algorithm) as runs:
        for point in points:
            assert runs.run(point, 1e-5) == simulate(system.set(point), 0.02, 1e-5, algorithm)
        assert {runs.learned.way(After.END, (name,)) for name in system} == {Reuse.RESET}


def test_a_sample_time_may_differ_from_run_to_run() -> None:
    system = scenario("fig2")
    sampled = [f"{name}.sample_time" for name in system.sample_times]
    with Reruns(system, 0.01) as runs:
        for step in (1e-4, 1e-3, 5e-4):
            truth = simulate(system.with_sample_time(step), 0.01, step)
            assert runs.run(dict.fromkeys(sampled, step), step) == truth


@pytest.mark.parametrize("isolate", [(), ("m",)])
def test_a_run_that_fails_since_an_fmu_wears_out_is_made_again(pooled: Pooled, isolate: tuple[str, ...]) -> None:
    system = pooled("wears out")
    with Reruns(system, STOP, options=Options(isolate=isolate)) as runs:
        for k in range(12):
            point = {"m.p": float(k)}
            assert runs.run(point, STEP)["m.y"].tolist() == simulate(system.set(point), STOP, STEP)["m.y"].tolist()
        assert ways(runs) == [Reuse.RESET, Reuse.RESET]
        assert ways(runs, After.FAILURE) == [None, None]


def test_a_run_of_fmus_that_are_trusted_is_not_made_again(pooled: Pooled) -> None:
    system = pooled("wears out")
    with Reruns(system, STOP, trusted=["source", "m"]) as runs:
        failures = [isinstance(outcome(runs.run, {"m.p": float(k)}, STEP), str) for k in range(8)]
    assert failures.index(True) == 4
