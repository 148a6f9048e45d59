"""Native libraries of systems: what they refuse, how they are shared, and how a call is stopped."""

import ctypes
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from threading import Timer

import numpy as np
import pytest

from adaptimp_fmu.files.cache_contents import KINDS, clear
from orchestration import ContainerError, SimulationError, System, SystemDescriptionError, scenario
from orchestration.containers.native.library import Failure, Outcome
from orchestration.containers.native.program import STOPPED, NativeProgram, Stop
from orchestration.containers.native.sentences import failure_sentence
from orchestration.results.measures.expression import Column, Reduction, Time

DEEPEST = Reduction("max", Column("plant.gap"))
STEP = 1e-4  # s


@cache
def program() -> NativeProgram:
    return NativeProgram.of(scenario("fig2"), varied=("plant.K_f",), reductions=(DEEPEST, Reduction("final", Time())))


def test_runs_in_several_threads_are_those_of_one() -> None:
    walls = np.logspace(3, 6, 12)[:, None]
    one = program().runs(walls, np.full(12, STEP), 1.0)
    with ThreadPoolExecutor(4) as threads:
        parts = threads.map(lambda i: program().runs(walls[i : i + 1], np.array([STEP]), 1.0), range(12))
        assert np.concatenate([part.reduced for part in parts]).tobytes() == one.reduced.tobytes()
    assert len(set(one.reduced[:, 0])) == 12


def test_a_run_leaves_nothing_behind_for_the_next() -> None:
    walls = np.array([[1e4], [-1.0], [1e6], [1e4]])
    runs = program().runs(walls, np.array([STEP, STEP, 2e-5, STEP]), 1.0)
    assert runs.reduced[3].tobytes() == runs.reduced[0].tobytes()
    assert [bool(message) for message in runs.messages] == [False, True, False, False]
    assert runs.made == 4


def test_a_stop_ends_a_call_before_its_next_run() -> None:
    stop = Stop()
    stop.set()
    runs = program().runs(np.full((3, 1), 1e4), np.full(3, STEP), 1.0, stop=stop)
    assert (runs.made, runs.messages) == (0, (STOPPED,) * 3)
    assert np.isnan(runs.reduced).all()


def test_another_thread_stops_a_call() -> None:
    stop, n = Stop(), 20_000  # minutes
    timer = Timer(0.2, stop.set)
    timer.start()
    runs = program().runs(np.full((n, 1), 1e4), np.full(n, STEP), 2.0, stop=stop)
    timer.join()
    assert 0 < runs.made < n
    assert runs.messages[runs.made - 1] == ""
    assert runs.messages[runs.made] == STOPPED
    assert np.isfinite(runs.reduced[: runs.made]).all()
    assert np.isnan(runs.reduced[runs.made :]).all()


def test_a_library_is_loaded_once() -> None:
    other = NativeProgram.of(
        scenario("fig2").set({"plant.m[2]": 3.0}),
        varied=("plant.K_f",),
        reductions=(DEEPEST, Reduction("final", Time())),
    )
    assert other.identity == program().identity
    assert other._library is program()._library
    jacobi = NativeProgram.of(scenario("fig2"), "jacobi", varied=("plant.K_f",), reductions=(DEEPEST,))
    assert jacobi.identity != program().identity


def test_a_library_comes_from_the_cache_and_is_made_anew_if_it_was_altered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from orchestration.containers.native import library

    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path))
    monkeypatch.setattr(library, "_LOADED", {})
    loaded: list[bytes] = []
    real = ctypes.CDLL

    def watched(path: str) -> ctypes.CDLL:
        loaded.append(Path(path).read_bytes())
        return real(path)

    monkeypatch.setattr(library.ctypes, "CDLL", watched)
    files = {
        "runs.c": '#define E __attribute__((visibility("default")))\n'
        "E int native_size(void);\nE int native_runs(void);\n"
        "int native_size(void) { return 1; }\nint native_runs(void) { return 2; }\n"
    }
    assert library.loaded("a", files, ["runs.c"]).native_size() == 1
    (file,) = (tmp_path / "native").rglob("native.*")
    file.unlink()  # the loaded file itself stays as it is
    file.write_bytes(b"something else")
    monkeypatch.setattr(library, "_LOADED", {})
    assert library.loaded("a", files, ["runs.c"]).native_runs() == 2
    assert loaded[0] == loaded[1]
    assert clear(tmp_path, KINDS["native"]).files == 0  # this process works with it


def test_a_machine_without_a_platform_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    system = scenario("fig2")
    monkeypatch.setattr("platform.machine", lambda: "abacus")
    with pytest.raises(ContainerError, match=r"No FMU platform for .* on abacus"):
        NativeProgram.of(system)


def test_recorded_rows_of_runs_of_unequal_length_end_with_nan() -> None:
    recording = NativeProgram.of(scenario("fig2"), record=("plant.gap",))
    runs = recording.runs(np.empty((2, 0)), np.array([1e-4, 5e-5]), 0.1)
    assert runs.rows is not None
    assert runs.rows.shape == (2, 2001, 1)
    assert np.isfinite(runs.rows[0, :1001]).all()
    assert np.isnan(runs.rows[0, 1001:]).all()
    assert np.isfinite(runs.rows[1]).all()


def test_a_result_of_a_run_that_fails_is_an_error() -> None:
    with pytest.raises(SimulationError, match="K_f = -1 must be at least 0 N/m"):
        program().result(np.array([-1.0]), STEP, 1.0)


@pytest.mark.parametrize(
    ("choice", "error", "words"),
    [
        ({"varied": ("plant.gap",)}, ContainerError, "plant.gap of Plant.* is a Real of causality output"),
        ({"varied": ("controller.q[1]",)}, ContainerError, r"controller.q\[1\] takes its value from plant.q\[1\]"),
        ({"varied": ("plant.nothing",)}, SystemDescriptionError, "nothing"),
        ({"reductions": (Reduction("max", Column("plant.gab")),)}, ContainerError, "shows no plant.gab.*plant.gap"),
        ({"record": ("controller.q[1]",)}, ContainerError, r"shows no controller.q\[1\]"),
        ({"algorithm": "newton"}, ContainerError, "cannot step with newton"),
    ],
)
def test_what_a_native_library_cannot_do_is_refused(choice: dict, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        NativeProgram.of(scenario("fig2"), **choice)


def test_arrays_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ContainerError, match=r"shape \(2, 2\).*give 1 values and one step for each run"):
        program().runs(np.zeros((2, 2)), np.full(2, STEP), 1.0)


def test_an_fmu_of_another_tool_is_refused(tmp_path: Path) -> None:
    whole = scenario("fig2").to_fmu(tmp_path / "whole.fmu")
    system = System.of({"arm": whole}).with_sample_time(STEP)
    with pytest.raises(ContainerError, match=r"arm: whole\.fmu cannot be a part of a native library"):
        NativeProgram.of(system)


def test_a_sentence_shows_texts_and_numbers_as_an_fmu_logs_them() -> None:
    failure = Failure(component=b"arm", sentence=b"%s is %.17g of %g at 100%%.", n=3)
    failure.arguments[0].kind, failure.arguments[0].text = b"s", b"x[1]"
    failure.arguments[1].kind, failure.arguments[1].number = b"g", 0.1
    failure.arguments[2].kind, failure.arguments[2].number = b"g", 2.5
    outcome = Outcome(failure=failure, where=3, steps=7)
    assert failure_sentence(outcome, (), (), 0.7) == (
        "arm: fmi2DoStep returned fmi2Error at t = 0.7 s (step 7); its last message:"
        ' "x[1] is 0.10000000000000001 of 2.5 at 100%.".'
    )
