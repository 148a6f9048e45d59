"""Initialization hands outputs to inputs through any chain, solves algebraic loops, and names what fails."""

import sys
from pathlib import Path

import numpy as np
import pytest

from orchestration import InitializationError, Result, SimulationError, System, simulate
from tests.unit.orchestration.checked import compiled, misbehaving
from tests.unit.orchestration.small_models import FIRST, LAST_TICK, H, chain, system

LENGTH = 12


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
@pytest.mark.parametrize("backwards", [False, True])
def test_row_0_has_passed_through_a_chain_of_any_order(small: dict[str, Path], algorithm: str, backwards: bool) -> None:
    signals = chain(small, LENGTH)
    names = [component.name for component in signals.components]
    result = simulate(signals, H, algorithm=algorithm, order=names[::-1] if backwards else names)
    for i in range(1, LENGTH + 1):
        assert result[f"relay{i}.y"][0] == 2.0**i * FIRST
        assert result[f"relay{i}.m"][0] == i
        assert result[f"relay{i}.odd"][0] == (i % 2 == 0)


def test_start_values_of_unconnected_inputs_reach_row_0(small: dict[str, Path]) -> None:
    relay = system(small, {"relay": "Relay"}).set(
        {"relay.u": 1.5, "relay.offset": 0.25, "relay.n": 6, "relay.even": True}
    )
    with pytest.warns(UserWarning, match=r"relay\.u, relay\.n, relay\.even"):
        result = simulate(relay, H)
    np.testing.assert_array_equal(result.rows[0], [3.25, 7, 0])


def test_direct_feedthrough_of_a_continuous_component_is_propagated(small: dict[str, Path]) -> None:
    components = {"last": "Integrator", "first": "Integrator", "source": "Source"}
    links = "source.u -> first.u\nfirst.y -> last.u"
    through = {"first.through": 2.0, "last.through": 4.0, "first.x_start": 1.0, "last.x_start": 0.5}
    result = simulate(system(small, components, links).set(through), H)
    assert result["first.y"][0] == 1 + 2 * FIRST
    assert result["last.y"][0] == 0.5 + 4 * (1 + 2 * FIRST)


def test_cycle_without_feedthrough_settles(small: dict[str, Path]) -> None:
    ring = system(small, {"a": "Integrator", "b": "Integrator"}, "a.y -> b.u\nb.y -> a.u")
    result = simulate(ring.set({"a.x_start": 1.0, "b.x_start": 2.0}), H)
    np.testing.assert_array_equal(result.rows[0], [1, 1, 2, 2])


def test_algebraic_loop_is_solved(small: dict[str, Path]) -> None:
    """The loop is y_a = 1 + 2 y_b and y_b = 2 y_a; a transfer of outputs by turns would diverge."""
    ring = system(small, {"a": "Integrator", "b": "Integrator"}, "a.y -> b.u\nb.y -> a.u")
    result = simulate(ring.set({"a.through": 2.0, "b.through": 2.0, "a.x_start": 1.0}), H)
    # The loop is linear. Newton's correction is exact up to differences of relative 1e-9; repeats reach 1e-12.
    assert result["a.y"][0] == pytest.approx(-1 / 3, rel=1e-11)
    assert result["b.y"][0] == pytest.approx(-2 / 3, rel=1e-11)


def test_algebraic_loop_without_a_solution_is_an_error_with_both_values(small: dict[str, Path]) -> None:
    ring = system(small, {"a": "Integrator", "b": "Integrator"}, "a.y -> b.u\nb.y -> a.u")
    with pytest.raises(InitializationError) as caught:
        simulate(ring.set({"a.through": 1.0, "b.through": 1.0, "a.x_start": 1.0}), H)  # y_a = 1 + y_a
    message = str(caught.value)
    assert "close an algebraic loop that has no solution near the start values" in message
    assert "at its source and" in message
    assert "a.y -> b.u" in message or "b.y -> a.u" in message
    assert caught.value.result is None


def test_loop_of_booleans_is_an_error(small: dict[str, Path]) -> None:
    ring = system(small, {"a": "Relay"}, "a.odd -> a.even").set({"a.even": False})
    with (
        pytest.warns(UserWarning, match=r"a\.u, a\.n"),
        pytest.raises(InitializationError, match=r"discrete values do not settle"),
    ):
        simulate(ring, H)


@pytest.mark.filterwarnings("ignore::orchestration.DifferentWallsWarning")  # one of the walls is wrong on purpose
@pytest.mark.parametrize(
    ("start", "call", "words"),
    [
        ({"plant.q_start[2]": 0.0}, "fmi2ExitInitializationMode", "singular"),
        ({"plant.K_f": -1.0}, "plant: fmi2SetReal", "K_f = -1 must be at least 0 N/m"),
        ({"trajectory.period": 0.0}, "trajectory: fmi2SetReal", "period = 0 must be at least 1e-12 s"),
        ({"plant.wall_normal[1]": -2.0}, "plant: fmi2ExitInitializationMode", "length 1"),
        ({"sensor.noise_std": 1.0}, "sensor: fmi2ExitInitializationMode", "noise_bound must be positive"),
    ],
)
def test_refused_start_values_name_component_call_and_message(
    fig2: System, start: dict[str, float], call: str, words: str
) -> None:
    with pytest.raises(InitializationError) as caught:
        simulate(fig2.set(start), fig2.step)
    message = str(caught.value)
    assert f"{call} returned fmi2Error" in message
    assert words in message
    assert "logged nothing" not in message
    assert caught.value.result is None


def test_every_component_keeps_its_own_messages(small: dict[str, Path]) -> None:
    """Messages of one component do not end up at another, whichever was instantiated last."""
    fleet = {f"fragile{i}": "Fragile" for i in range(4)}
    for i in range(4):
        components = dict(fleet)
        slow = {f"{name}.sample_time": H * (1 if name == f"fragile{i}" else 2) for name in components}
        with pytest.raises(SimulationError, match=rf'fragile{i}: .*its last message: "k must stay small'):
            simulate(system(small, components).set(slow), 60 * H)


def test_a_component_that_refuses_what_another_gave_it_names_both(small: dict[str, Path], tmp_path: Path) -> None:
    """An FMU of a stranger shows a NaN at 2 s; the relay refuses the NaN at the end of the step to that time."""
    stranger = misbehaving(compiled(tmp_path, "nan"), tmp_path / "Misbehaving.fmu", "nan")
    components = {"source": "Source", "stranger": "Misbehaving", "relay": "Relay"}
    lines = "source.u -> stranger.u\nstranger.y -> relay.u\nsource.n -> relay.n\nsource.even -> relay.even"
    given = system({**small, "Misbehaving": stranger}, components, lines)
    expected = r"relay: fmi2DoStep returned fmi2Error at t = 1\.875 s \(step 15\); .* It was given stranger\.y = nan\."
    with pytest.raises(SimulationError, match=expected):
        simulate(given, 4.0)


def test_failed_step_has_time_step_and_the_rows_before(small: dict[str, Path]) -> None:
    fragile = system(small, {"source": "Source", "fragile": "Fragile"})
    with pytest.raises(SimulationError) as caught:
        simulate(fragile, 100 * H)
    k = LAST_TICK + 1
    assert str(caught.value) == (
        f"fragile: fmi2DoStep returned fmi2Error at t = {k * H:.9g} s (step {k}); its last message:"
        ' "k must stay small (value -0.5, must be positive).".'
    )
    assert not isinstance(caught.value, InitializationError)
    part = caught.value.result
    whole = simulate(fragile, k * H)
    assert isinstance(part, Result)
    assert part.names == whole.names
    assert part.time.tobytes() == whole.time.tobytes()
    assert part.rows.tobytes() == whole.rows.tobytes()
    assert part.steps_per_tick == whole.steps_per_tick
    assert (part.status, part.message) == ("failed", str(caught.value))


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_diverging_plant_is_an_error_with_its_rows(fig2: System, algorithm: str) -> None:
    with pytest.raises(SimulationError, match=r"at t = \S+ s \(step \d+\)") as caught:
        simulate(fig2.set({"controller.K[1]": 1e9}), 0.1, algorithm=algorithm)
    part = caught.value.result
    assert part is not None
    assert 1 < len(part.time) < 1000
    assert np.isfinite(part.rows).all()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="counts the loaded libraries in /proc")
def test_failed_runs_free_what_they_opened(fig2: System) -> None:
    def loaded() -> int:
        return Path("/proc/self/maps").read_text().count("/adaptimp-")

    before = loaded()
    for start in ({"plant.q_start[2]": 0.0}, {"plant.K_f": -1.0}):
        with pytest.raises(InitializationError):
            simulate(fig2.set(start), fig2.step)
    assert loaded() == before
