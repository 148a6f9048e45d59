"""Inputs that follow time series: hand calculations, bitwise equality with a connection, and going back."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import (
    Algorithm,
    Crossings,
    Options,
    Result,
    System,
    SystemDescriptionError,
    TimeSeries,
    UnconnectedInputWarning,
    prepare,
    simulate,
    stream,
)
from orchestration.master.algorithm import DIRECTIONAL, NEWTON, PARALLEL, Correction
from orchestration.master.snapshot import Snapshot
from tests.unit.orchestration.runs import ADAPTIVE, ALGORITHMS, SAMPLE_TIME, paper
from tests.unit.orchestration.small_models import H, system

STEPS = 16
STOP = STEPS * H  # 2 s
KINK = 10.5 * H  # within a step
every_algorithm = pytest.mark.parametrize("algorithm", ALGORITHMS.values(), ids=ALGORITHMS.keys())
FIXED = {name: algorithm for name, algorithm in ALGORITHMS.items() if algorithm.control is None}
every_fixed = pytest.mark.parametrize("algorithm", FIXED.values(), ids=FIXED.keys())
HELD = {name: algorithm for name, algorithm in FIXED.items() if algorithm.order == 0}
MOVING = {name: algorithm for name, algorithm in ALGORITHMS.items() if algorithm.order > 0}


@pytest.fixture
def plant(small: dict[str, Path]) -> System:
    """Return x' = u, with a free u."""
    return system(small, {"plant": "Integrator"}, steps=STEPS)


def roof(t: np.ndarray | float) -> np.ndarray:
    """Rise by 2 per second to the kink, then fall by 4 per second."""
    return np.where(t <= KINK, 2 * t, 2 * KINK - 4 * (t - KINK))


ROOF = (np.array([0.0, KINK, STOP]), roof(np.array([0.0, KINK, STOP])))


@pytest.mark.parametrize("algorithm", HELD.values(), ids=HELD.keys())
def test_at_order_0_a_step_has_the_value_at_its_start(plant: System, algorithm: Algorithm) -> None:
    result = simulate(plant, algorithm=algorithm, inputs={"plant.u": ROOF}, record=["plant.x", "plant.u"])
    t = np.arange(STEPS) * H
    np.testing.assert_array_equal(result["plant.u"], [0.0, *roof(t)])  # powers of two: every number is exact
    np.testing.assert_array_equal(result["plant.x"], [0.0, *np.cumsum(H * roof(t))])


@pytest.mark.parametrize("algorithm", MOVING.values(), ids=MOVING.keys())
def test_from_order_1_on_a_step_follows_the_line(plant: System, algorithm: Algorithm) -> None:
    """The integral is exact where a step does not hold the kink; there it takes the straight line to its end."""
    result = simulate(plant, algorithm=algorithm, inputs={"plant.u": ROOF})
    t = result.time
    whole = t**2 - np.maximum(0.0, t - KINK) ** 2 * 3  # the slope falls by 6 1/s at the kink
    if algorithm.control is None:
        before, after = 10 * H, 11 * H
        chord = H * (roof(before) + roof(after)) / 2
        whole = np.where(t > KINK, before**2 + chord + (whole - (after**2 - (after - KINK) ** 2 * 3)), whole)
    else:
        assert KINK in t  # controlled steps end there
    np.testing.assert_allclose(result["plant.x"], whole, rtol=0, atol=1e-14)


def test_the_line_to_the_end_of_a_step_is_what_moves_the_input(plant: System) -> None:
    narrow = TimeSeries(np.array([0.0, 10.25 * H, 10.5 * H, 10.75 * H, STOP]), np.array([1.0, 1.0, 9.0, 1.0, 1.0]))
    moving = simulate(plant, algorithm=Algorithm("straight", order=1), inputs={"plant.u": narrow})
    assert moving["plant.x"][-1] == STOP  # the peak lies between two communication points
    controlled = simulate(plant, algorithm=ADAPTIVE, inputs={"plant.u": narrow})
    assert controlled["plant.x"][-1] == pytest.approx(STOP + 8.0 * 0.25 * H, abs=1e-14)  # and is not overlooked


@every_fixed
@pytest.mark.parametrize(("jump", "seen"), [(4 * H, 4), (4.5 * H, 5), (4 * H + 1e-12, 4), (4 * H + 1e-9, 5)])
def test_a_held_series_jumps_at_the_next_communication_point(
    plant: System, algorithm: Algorithm, jump: float, seen: int
) -> None:
    """And the jump is a jump; a time that is rounded by less than 1e-9 of a step counts as reached."""
    steps = TimeSeries(np.array([0.0, jump, STOP]), np.array([1.0, 3.0, 7.0]), "held")
    result = simulate(plant, algorithm=algorithm, inputs={"plant.u": steps})
    t = np.arange(STEPS + 1) * H
    np.testing.assert_array_equal(result["plant.x"], t + 2.0 * np.maximum(0.0, t - seen * H))


def test_controlled_steps_end_on_jumps(plant: System) -> None:
    jump = 0.7
    steps = TimeSeries(np.array([0.0, 0.35, jump, STOP]), np.array([1.0, 1.0, 3.0, 3.0]), "held")
    result = simulate(plant, algorithm=ADAPTIVE, inputs={"plant.u": steps})
    assert jump in result.time
    assert 0.35 not in result.time  # nothing happens there
    np.testing.assert_allclose(result["plant.x"], result.time + 2 * np.maximum(0, result.time - jump), atol=1e-14)


@pytest.mark.parametrize("algorithm", ["jacobi", "iterative", "gauss-seidel"])
def test_a_series_with_the_values_of_a_component_is_that_component(small: dict[str, Path], algorithm: str) -> None:
    """Of all types; with a parallel exchange an input shows the row at the start of the step, else the next row."""
    relayed = "source.u -> relay.u\nsource.n -> relay.n\nsource.even -> relay.even\n"
    units = {"relay": "Relay", "plant": "Integrator"}
    whole = simulate(system(small, {"source": "Source", **units}, f"{relayed}relay.y -> plant.u"), algorithm=algorithm)
    rows = slice(1, None) if algorithm == "gauss-seidel" else slice(None, -1)
    given = {
        f"relay.{name}": TimeSeries(whole.time[:-1], whole[f"source.{name}"][rows], "held", outside="hold")
        for name in ("u", "n", "even")
    }
    alone = simulate(system(small, units, "relay.y -> plant.u"), algorithm=algorithm, inputs=given)
    assert np.ptp(alone["plant.x"]) > 1.0
    for name in alone:
        assert alone[name].tobytes() == whole[name].tobytes()


def cut(made: System, *inputs: str) -> System:
    """Return a system without the connections to inputs, which are given as component and array."""
    left = [c for c in made.connections if f"{c.target}.{c.input.partition('[')[0]}" not in inputs]
    assert len(left) < len(made.connections)
    return replace(made, connections=tuple(left))


@pytest.fixture(scope="module")
def noisy(fmu_folder: Path) -> System:
    """Return the system of Fig. 5 in contact, whose sensor draws random numbers."""
    return paper(fmu_folder, "fig5")


def measured(noisy: System) -> tuple[System, dict[str, TimeSeries], Result]:
    """Return Fig. 5 without sensor and trajectory at the controller, what they gave it, and the whole run."""
    stop = 120 * SAMPLE_TIME
    whole = simulate(noisy, stop, SAMPLE_TIME, "jacobi")
    arrays = {"F_hat": "sensor", "x_v": "trajectory", "dx_v": "trajectory", "ddx_v": "trajectory"}
    given = {f"controller.{name}": TimeSeries(whole.time, whole[f"{of}.{name}"], "held") for name, of in arrays.items()}
    return cut(noisy, *given), given, whole


def test_arrays_drive_the_paper_s_controller_to_the_same_bits(noisy: System) -> None:
    open_loop, given, whole = measured(noisy)
    assert np.ptp(whole["sensor.F_hat"]) > 1.0  # N
    result = simulate(open_loop, whole.time[-1], SAMPLE_TIME, "jacobi", inputs=given)
    assert result.names == whole.names
    assert result.rows.tobytes() == whole.rows.tobytes()


@every_algorithm
def test_saving_and_going_back_change_nothing(noisy: System, algorithm: Algorithm, tmp_path: Path) -> None:
    open_loop, given, whole = measured(noisy)
    middle, stop = 50 * SAMPLE_TIME, float(whole.time[-1])
    straight = simulate(open_loop, stop, SAMPLE_TIME, algorithm, inputs=given)
    with prepare(open_loop, stop, SAMPLE_TIME, algorithm, inputs=given) as run:
        run.run(until=middle)
        snapshot = run.save()
        run.run()
        run.restore(snapshot)
        run.run()
        assert run.result().rows.tobytes() == straight.rows.tobytes()
    path = snapshot.write(tmp_path / "middle.snapshot")
    with prepare(open_loop, stop, SAMPLE_TIME, algorithm, inputs=given) as run:
        run.restore(Snapshot.read(path))
        run.run()
        assert run.result().rows.tobytes() == straight.rows.tobytes()
    other = given | {"controller.F_hat": TimeSeries(whole.time, 2 * whole["sensor.F_hat"], "held")}
    with (
        prepare(open_loop, stop, SAMPLE_TIME, algorithm, inputs=other) as run,
        pytest.raises(SystemDescriptionError, match="time series"),
    ):
        run.restore(Snapshot.read(path))


def test_a_stream_has_the_same_rows(plant: System, tmp_path: Path) -> None:
    path = tmp_path / "x.parquet"
    result = simulate(plant, inputs={"plant.u": ROOF})
    assert stream(path, plant, inputs={"plant.u": ROOF}) == len(result.time)
    streamed = Result.read(path)
    assert streamed.rows.tobytes() == result.rows.tobytes()
    assert streamed.metadata["inputs"] == result.metadata["inputs"]


def test_values_at_the_start_reach_through_a_chain_during_initialization(small: dict[str, Path]) -> None:
    """Each component feeds through twice its input, so row 0 shows eight times the first value, 3."""
    units = {name: "Integrator" for name in "cba"}  # in the order against the signals
    made = system(small, units, "a.y -> b.u\nb.y -> c.u").set({f"{name}.through": 2.0 for name in "abc"})
    given = {"a.u": (np.array([-1.0, 1.0, STOP]), np.array([1.0, 5.0, 5.0]))}
    result = simulate(made, inputs=given)
    assert [result[f"{name}.y"][0] for name in "abc"] == [6.0, 12.0, 24.0]


def test_a_slow_component_takes_the_value_at_the_start_of_its_step(plant: System) -> None:
    result = simulate(plant, inputs={"plant.u": ROOF}, options=Options(ratios={"plant": 4}))
    begun = 4 * H * np.arange(STEPS // 4)
    np.testing.assert_array_equal(result["plant.x"][::4], [0.0, *np.cumsum(4 * H * roof(begun))])


def test_a_crossing_is_located_on_the_line(plant: System) -> None:
    """With x(0) = -1 and u = 2 t, x = t^2 - 1 passes zero at 1 s minus 1e-3 s, as the start is."""
    made = plant.set({"plant.x_start": -(0.999**2)})
    options = Options(crossings=Crossings(("plant.x",), 1e-12))
    given = (np.array([0.0, STOP]), np.array([0.0, 2 * STOP]))
    result = simulate(made, algorithm=Algorithm("straight", order=1), inputs={"plant.u": given}, options=options)
    assert len(result.time) == STEPS + 2
    assert np.abs(result.time - 0.999).min() <= 2e-12
    np.testing.assert_allclose(result["plant.x"], result.time**2 - 0.999**2, atol=1e-14)


def test_inputs_beside_connected_ones_keep_their_places(small: dict[str, Path]) -> None:
    """Of one component the Integer is connected, the others follow series, with set calls that copy and do not."""
    made = system(small, {"source": "Source", "relay": "Relay"}, "source.n -> relay.n")
    t = np.arange(STEPS + 1) * H
    given = {"relay.u": (t, t**2), "relay.even": (t, np.arange(STEPS + 1) % 3 == 0)}
    result = simulate(made, inputs=given, record=["relay.*", "relay.u", "relay.even"])
    k = np.arange(STEPS)
    np.testing.assert_array_equal(result["relay.y"][1:], 2 * t[:-1] ** 2)
    np.testing.assert_array_equal(result["relay.m"][1:], k + 1)
    np.testing.assert_array_equal(result["relay.odd"][1:], k % 3 != 0)
    np.testing.assert_array_equal(result["relay.even"][1:], k % 3 == 0)


def test_directional_derivatives_see_outputs_only(small: dict[str, Path]) -> None:
    """A recorded input or parameter is not an unknown of the Jacobian."""
    units = {"a": "Integrator", "b": "Integrator"}
    made = system(small, units, "a.y -> b.u").set({"a.through": 0.5})
    newton = Algorithm("directional", PARALLEL, correction=Correction(NEWTON, jacobian=DIRECTIONAL))
    plain = simulate(made, algorithm=newton, inputs={"a.u": ROOF})
    more = simulate(made, algorithm=newton, inputs={"a.u": ROOF}, record=["*", "a.u", "b.u", "a.through"])
    for name in plain:
        assert more[name].tobytes() == plain[name].tobytes()
    np.testing.assert_array_equal(more["a.through"], 0.5)


def test_recording_an_input_does_not_move_controlled_steps(plant: System) -> None:
    wavy = (np.linspace(0, STOP, 5), np.sin(np.linspace(0, STOP, 5)))
    plain = simulate(plant, algorithm=ADAPTIVE, inputs={"plant.u": wavy})
    more = simulate(plant, algorithm=ADAPTIVE, inputs={"plant.u": wavy}, record=["*", "plant.u", "plant.x_start"])
    assert more.time.tobytes() == plain.time.tobytes()


def test_the_first_values_are_those_at_the_start(small: dict[str, Path]) -> None:
    made = system(small, {"relay": "Relay"})
    t = np.array([-1.0, 0.0, 1e-12, 3.0])
    given = {"relay.u": (t[[0, 3]], [1.0, 5.0]), "relay.n": (t, [4, 5, 6, 7]), "relay.even": (t, [1, 0, 1, 1])}
    with prepare(made, 1.0, 0.125, inputs=given) as run:
        assert run.judge.inputs == {"relay.u": 2.0, "relay.n": 6.0, "relay.even": 1.0}
        row = run.result()
    assert (row["relay.y"][0], row["relay.m"][0], row["relay.odd"][0]) == (4.0, 7.0, 0.0)


def test_driven_inputs_are_not_unconnected(small: dict[str, Path]) -> None:
    made = system(small, {"plant": "Integrator", "relay": "Relay"})
    flat = (np.array([0.0, STOP]), np.array([1.0, 1.0]))
    with pytest.warns(UnconnectedInputWarning, match=r"start values: relay\.n, relay\.even\.$"):
        simulate(made, inputs={"plant.u": flat, "relay.u": flat})


def test_the_metadata_names_what_came_from_where(plant: System, tmp_path: Path) -> None:
    path = tmp_path / "measured.csv"
    path.write_text("time,plant.u [mm]\n0,0\n2,4000\n", encoding="utf-8")
    result = simulate(plant, inputs=path, record=["plant.u"])
    (entry,) = json.loads(result.metadata["inputs"])
    assert entry.pop("sha256") == hashlib.sha256(path.read_bytes()).hexdigest()
    assert entry == {
        **{"input": "plant.u", "interpolation": "linear", "points": 2, "unit": "mm", "file": "measured.csv"},
    }
    np.testing.assert_array_equal(result["plant.u"][1:], 2 * result.time[:-1])  # 0.001 is not exact, twice it is
    again = simulate(plant, inputs={"plant.u": ROOF})
    assert len(json.loads(again.metadata["inputs"])[0]["sha256"]) == 64
    assert "inputs" not in simulate(plant, options=Options(strict=False), changes={0.0: {"plant.u": 1.0}}).metadata


@pytest.mark.parametrize("make", [lambda v: v, lambda v: np.repeat(v, 3)[::3], lambda v: v[::-1].copy()[::-1]])
def test_values_are_read_in_place(plant: System, make: Callable[[np.ndarray], np.ndarray]) -> None:
    """A float64 array is not copied, whatever its stride: what is written to it before a step is what the step uses."""
    t = np.arange(STEPS + 1) * H
    values = make(np.ones(STEPS + 1))
    with prepare(plant, inputs={"plant.u": TimeSeries(t, values, "held")}) as run:
        run.run(until=4 * H)
        values[4:] = 5.0
        run.run()
        result = run.result()
    np.testing.assert_array_equal(np.diff(result["plant.x"]), H * np.where(np.arange(STEPS) < 4, 1.0, 5.0))


def test_an_array_s_columns_are_its_elements(fig2: System) -> None:
    open_loop = cut(fig2, "plant.tau")
    t = np.linspace(0.0, 0.01, 11)
    tau = np.column_stack([t, 10 - t])
    both = simulate(open_loop, 0.01, inputs={"plant.tau": (t, tau)}, record=["plant.x", "plant.tau"])
    each = simulate(open_loop, 0.01, inputs={"plant.tau[1]": (t, tau[:, 0]), "plant.tau[2]": (t, tau[:, 1])})
    assert both["plant.x"].tobytes() == each["plant.x"].tobytes()
    np.testing.assert_allclose(both["plant.tau"][1:, 1], 10 - both.time[:-1], rtol=1e-14)
    assert both.unit("plant.tau") == "N.m"


def test_many_short_runs_do_not_run_out_of_numbers(plant: System) -> None:
    """Each part of a run may be four times as long as the last; without a bound the number leaves 64 bits."""
    for algorithm in ("jacobi", "iterative"):
        with prepare(plant, 1000 * H, H, algorithm, changes={0.0: {"plant.u": 1.0}}) as run:
            for k in range(1, 1000):
                run.run(until=k * H)
            assert run.result()["plant.x"][-1] == 999 * H
