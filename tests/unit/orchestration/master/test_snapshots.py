"""A run that is saved, restored, branched or continued elsewhere gives the bits of a run without a break."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, OrchestrationError, Result, System, SystemDescriptionError, simulate
from orchestration.master.algorithm import Algorithm
from orchestration.master.simulate import prepare
from orchestration.master.simulation import Simulation
from orchestration.master.snapshot import Snapshot
from tests.reference.problems import PROBLEMS
from tests.unit.orchestration.runs import ADAPTIVE, ALGORITHMS, SAMPLE_TIME, at_zero, crossing, falling, paper
from tests.unit.orchestration.small_models import H

ROOT = Path(__file__).parents[3]
STEPS = 160
MIDDLE = 70 * SAMPLE_TIME  # s
CONTINUE = """
import sys
import numpy as np
from orchestration import System
from orchestration.master.algorithm import *
from orchestration.master.simulate import prepare
from orchestration.master.snapshot import Snapshot
package, snapshot, stop, algorithm, out = sys.argv[1:]
system = System.read(package)
with prepare(system, float(stop), algorithm=eval(algorithm)) as simulation:
    simulation.restore(Snapshot.read(snapshot))
    simulation.run()
    result = simulation.result()
np.savez(out, time=result.time, rows=result.rows)
"""


@pytest.fixture(scope="module")
def noisy(fmu_folder: Path) -> System:
    """Return the system of Fig. 5 in contact, where the sensor draws random numbers."""
    return paper(fmu_folder, "fig5")


def run_of(system: System, algorithm: Algorithm, options: Options | None = None) -> Simulation:
    """Return a run of Fig. 5, which is not entered yet."""
    return prepare(system, STEPS * SAMPLE_TIME, SAMPLE_TIME, algorithm, options=options)


def assert_same(a: Result, b: Result) -> None:
    """Require the same times and rows, bit by bit."""
    assert a.time.tobytes() == b.time.tobytes()
    assert a.rows.tobytes() == b.rows.tobytes()


def test_there_is_noise_to_continue(noisy: System) -> None:
    stop = STEPS * SAMPLE_TIME
    seeds = [simulate(noisy.set({"sensor.seed": seed}), stop, SAMPLE_TIME)["sensor.F_hat[1]"] for seed in (1, 2)]
    assert (np.abs(seeds[0] - seeds[1])[2:] > 0).all()


@pytest.mark.parametrize("algorithm", ALGORITHMS.values(), ids=ALGORITHMS.keys())
def test_stopping_in_the_middle_and_going_back_change_nothing(noisy: System, algorithm: Algorithm) -> None:
    whole = simulate(noisy, STEPS * SAMPLE_TIME, SAMPLE_TIME, algorithm)
    with run_of(noisy, algorithm) as simulation:
        simulation.run(until=MIDDLE)
        assert simulation.time == MIDDLE
        snapshot, before = simulation.save(), simulation.result()
        assert_same(before, replace(whole, time=whole.time[: len(before.time)], rows=whole.rows[: len(before.time)]))
        for _ in range(2):
            simulation.run()
            assert_same(simulation.result(), whole)
            simulation.restore(snapshot)
            assert simulation.time == MIDDLE
            assert_same(simulation.result(), before)


@pytest.mark.parametrize("algorithm", ALGORITHMS.values(), ids=ALGORITHMS.keys())
@pytest.mark.parametrize("name", ["force-displacement", "quarter car"])
def test_coupled_continuous_components_continue_too(name: str, algorithm: Algorithm) -> None:
    """The polynomials, Jacobians and step lengths of coupled components belong to the state of a run."""
    step = 2.0**-10
    system = PROBLEMS[name].system(step, 128 * step)
    whole = simulate(system, algorithm=algorithm)
    # With controlled steps and without ticks, the only communication point ahead is the stop time.
    until = None if algorithm.control else 60 * step
    with prepare(system, algorithm=algorithm) as simulation:
        start = simulation.save()
        simulation.run(until)
        middle = simulation.save()
        simulation.run()
        assert_same(simulation.result(), whole)
        for snapshot in (middle, start):
            simulation.restore(snapshot)
            simulation.run()
            assert_same(simulation.result(), whole)


def test_located_crossings_continue(small: dict[str, Path]) -> None:
    system = falling(small)
    whole = simulate(system, options=at_zero())
    k = np.searchsorted(whole.time, crossing())
    assert whole.time[k] == pytest.approx(crossing(), abs=2e-9)
    with prepare(system, options=at_zero()) as simulation:
        for until in (2 * H, 4 * H, 5 * H):  # before the crossing, at the end of its step, after it
            simulation.run(until)
            snapshot = simulation.save()
            simulation.run()
            assert_same(simulation.result(), whole)
            simulation.restore(snapshot)


@pytest.mark.parametrize("algorithm", ALGORITHMS.values(), ids=ALGORITHMS.keys())
def test_a_branch_is_a_fresh_run_with_that_change(noisy: System, algorithm: Algorithm) -> None:
    change = {"controller.K[1]": 2000.0}
    with run_of(noisy, algorithm) as fresh:
        fresh.run(MIDDLE)
        fresh.set(change)
        fresh.run()
        expected = fresh.result()
    with run_of(noisy, algorithm) as simulation:
        simulation.run(MIDDLE)
        snapshot = simulation.save()
        simulation.run()
        unchanged = simulation.result()
        simulation.restore(snapshot)
        simulation.set(change)
        simulation.run()
        branch = simulation.result()
        assert_same(branch, expected)
        k = int(np.searchsorted(unchanged.time, MIDDLE))
        assert branch.rows[: k + 1].tobytes() == unchanged.rows[: k + 1].tobytes()
        assert abs(branch["plant.q[1]"][-1] - unchanged["plant.q[1]"][-1]) > 0
        simulation.restore(snapshot)  # parameters go back too
        simulation.run()
        assert_same(simulation.result(), unchanged)


@pytest.mark.parametrize("value", [2000.0, [2000.0, 3000.0]])
def test_an_array_is_set_as_its_elements_are(noisy: System, value: float | list[float]) -> None:
    first, second = value if isinstance(value, list) else (value, value)
    elements: dict[str, float | list[float]] = {"controller.K[1]": first, "controller.K[2]": second}
    whole: dict[str, float | list[float]] = {"controller.K": value}
    found = []
    for change in (whole, elements):
        with prepare(noisy, STEPS * SAMPLE_TIME, SAMPLE_TIME) as simulation:
            simulation.run(MIDDLE)
            simulation.set(change)
            simulation.run()
            found.append(simulation.result())
    assert found[0] == found[1]
    assert [entry[1] for entry in json.loads(found[0].metadata["changes"])] == list(elements)


def test_another_process_continues(noisy: System, tmp_path: Path) -> None:
    package = noisy.write(tmp_path / "fig5.ssp")
    stop = STEPS * SAMPLE_TIME
    system = System.read(package)
    for algorithm in (ALGORITHMS["gauss-seidel"], ADAPTIVE):
        whole = simulate(system, stop, algorithm=algorithm)
        with prepare(system, stop, algorithm=algorithm) as simulation:
            simulation.run(MIDDLE)
            file = simulation.save().write(tmp_path / "middle.npz")
        out = tmp_path / f"{algorithm.name}.npz"
        command = [sys.executable, "-c", CONTINUE, str(package), str(file), repr(stop), repr(algorithm), str(out)]
        elsewhere = {"ADAPTIMP_CACHE": str(tmp_path / "cache")} if algorithm.plain else {}  # others compile for long
        environment = {**os.environ, **elsewhere}
        run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr
        continued = np.load(out)
        assert continued["time"].tobytes() == whole.time.tobytes()
        assert continued["rows"].tobytes() == whole.rows.tobytes()


def test_another_run_continues_from_a_file(noisy: System, tmp_path: Path) -> None:
    with run_of(noisy, ADAPTIVE) as simulation:
        simulation.run(MIDDLE)
        file = simulation.save().write(tmp_path / "deep" / "middle.npz")
        simulation.run()
        whole = simulation.result()
    assert [p.name for p in file.parent.iterdir()] == ["middle.npz"]
    with run_of(noisy, ADAPTIVE) as simulation:
        simulation.restore(Snapshot.read(file))
        simulation.run()
        assert_same(simulation.result(), whole)


def test_a_snapshot_of_another_run_is_refused(noisy: System, fmu_folder: Path) -> None:
    with run_of(noisy, ADAPTIVE) as simulation:
        snapshot = simulation.save()
    plain = Algorithm("gauss-seidel")
    others = [
        run_of(paper(fmu_folder, "fig2"), ADAPTIVE),
        run_of(noisy, plain),
        run_of(noisy, ADAPTIVE, Options(record=["plant.q[1]"])),
        run_of(noisy, ADAPTIVE, Options(every=2)),
        prepare(noisy, 2 * STEPS * SAMPLE_TIME, SAMPLE_TIME, ADAPTIVE),
        prepare(noisy, STEPS * SAMPLE_TIME, SAMPLE_TIME, ADAPTIVE, order=[c.name for c in noisy.components][::-1]),
    ]
    for other in others:
        with other, pytest.raises(SystemDescriptionError, match=r"the snapshot at t = 0 s is of another run"):
            other.restore(snapshot)


def test_a_damaged_file_is_refused(noisy: System, tmp_path: Path) -> None:
    with run_of(noisy, ADAPTIVE) as simulation:
        simulation.run(MIDDLE)
        file = simulation.save().write(tmp_path / "middle.npz")
    content = file.read_bytes()
    damaged = tmp_path / "damaged.npz"
    for part in (b"", b"time,x\n0,1\n", content[: len(content) // 2], content[:-30], content[100:]):
        damaged.write_bytes(part)
        with pytest.raises(OrchestrationError, match=r"damaged\.npz"):
            Snapshot.read(damaged)
    intact = Snapshot.read(file)
    for place in range(200, len(content), len(content) // 40):  # one byte changed
        damaged.write_bytes(content[:place] + bytes([content[place] ^ 0xFF]) + content[place + 1 :])
        with suppress(OrchestrationError):
            found = Snapshot.read(damaged)  # the byte was of no content, such as a date of the archive
            assert (found.identity, found.states) == (intact.identity, intact.states)
            assert all(found.arrays[name].tobytes() == intact.arrays[name].tobytes() for name in intact.arrays)
    with pytest.raises(OrchestrationError, match=r"no\.npz: there is no such snapshot; its folder has damaged\.npz"):
        Snapshot.read(tmp_path / "no.npz")


def other_state(field: str, value: int) -> Callable[[dict[str, np.ndarray]], None]:
    """An edit of a number in the state of a run."""

    def edit(arrays: dict[str, np.ndarray]) -> None:
        arrays["state"][field] = value

    return edit


FORGED: dict[str, Callable[[dict[str, np.ndarray]], object]] = {
    "interval is 9999": other_state("interval", 9999),
    "interval is -1": other_state("interval", -1),
    "n_past is 4": other_state("n_past", 4),
    "moved is 77": other_state("moved", 77),
    "it has no array past": lambda arrays: arrays.pop("past"),
    "it has no array times": lambda arrays: arrays.pop("times"),
    "array reals has shape": lambda arrays: arrays.update(reals=np.zeros(1)),
    "array pivots has shape": lambda arrays: arrays.update(pivots=np.array([9])),
    r"it has \(3,\) times": lambda arrays: arrays.update(times=np.zeros(3)),
    "times of type int64": lambda arrays: arrays.update(times=arrays["times"].astype(np.int64)),
}


@pytest.mark.parametrize("said", FORGED)
def test_a_snapshot_that_somebody_made_up_is_refused(noisy: System, tmp_path: Path, said: str) -> None:
    """Its numbers are indices in compiled code: they would be read outside of their arrays."""
    with run_of(noisy, ADAPTIVE) as simulation:
        simulation.run(MIDDLE)
        snapshot = Snapshot.read(simulation.save().write(tmp_path / "middle.npz"))
        FORGED[said](snapshot.arrays)
        forged = Snapshot.read(snapshot.write(tmp_path / "forged.npz"))  # with the right hash
        with pytest.raises(OrchestrationError, match=rf"^The snapshot does not fit the run: .*{said}"):
            simulation.restore(forged)
        simulation.run()  # the run goes on from where it was


def test_content_that_has_changed_is_noticed(noisy: System, tmp_path: Path) -> None:
    """An archive that is intact, with another array in it."""
    with run_of(noisy, ADAPTIVE) as simulation:
        file = simulation.save().write(tmp_path / "start.npz")
    with np.load(file) as archive:
        arrays = {name: archive[name] for name in archive.files}
    np.savez(file, **{**arrays, "state_0": arrays["state_0"][::-1]})
    with pytest.raises(OrchestrationError, match="is not a snapshot: its content has changed since it was written"):
        Snapshot.read(file)


def test_only_points_ahead_can_be_run_to(noisy: System) -> None:
    with run_of(noisy, ADAPTIVE) as simulation:
        simulation.run(MIDDLE)
        for until in (MIDDLE - SAMPLE_TIME, MIDDLE + 0.4 * SAMPLE_TIME, 10.0):
            with pytest.raises(SystemDescriptionError, match="is not a communication point ahead"):
                simulation.run(until)
        with pytest.raises(SystemDescriptionError, match="The time to run until is nan; give a finite number"):
            simulation.run(np.nan)
        simulation.run(MIDDLE)  # is where it is already
        assert simulation.time == MIDDLE
