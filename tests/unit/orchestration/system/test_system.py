"""Tests of `System`: errors with both sides and the known names, and values that its methods keep."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import SampledModel, build
from orchestration import (
    Component,
    Connection,
    Options,
    System,
    SystemDescriptionError,
    UnconnectedInputWarning,
    simulate,
)
from orchestration.fmi.description import read_description
from tests.unit.orchestration.small_models import H, chain, system


def linked(fmus: dict[str, Path], line: str) -> System:
    """System of three components with the given connections."""
    return system(fmus, {"source": "Source", "relay": "Relay", "plant": "Integrator"}, line)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("source.z -> relay.u", r"source has no variable z; there are sample_time, u, n, even"),
        (
            "source.u -> relay.z",
            r"relay has no variable z; there are sample_time, offset, u, n and 4 more",
        ),
        ("spring.u -> relay.u", r"System small has no component spring; there are source, relay, plant"),
        ("source.u -> spring.u", r"System small has no component spring; there are source, relay, plant"),
        ("relay.u -> plant.u", r"Connection relay\.u -> plant\.u: u has causality input, not output"),
        ("source.u -> relay.y", r"Connection source\.u -> relay\.y: y has causality output, not input"),
        ("source.u -> relay.n", r"Connection source\.u -> relay\.n: types Real and Integer differ"),
        ("source.n -> relay.even", r"Connection source\.n -> relay\.even: types Integer and Boolean differ"),
        ("source.even -> relay.u", r"types Boolean and Real differ"),
        (
            "source.u -> relay.u\nplant.x -> relay.u",
            r"Connection plant\.x -> relay\.u: relay\.u already has a source",
        ),
    ],
)
def test_wrong_connections_are_refused(small: dict[str, Path], line: str, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        linked(small, line)


def test_units_must_agree(fig2: System) -> None:
    connections = tuple(c for c in fig2.connections if c.target != "sensor")
    wrong = Connection("plant", "x[1]", "sensor", "F_ext[1]")
    with pytest.raises(
        SystemDescriptionError,
        match=r"^Connection plant\.x\[1\] -> sensor\.F_ext\[1\]: units m and N differ; connect an output in N",
    ):
        replace(fig2, connections=(*connections, wrong))


def test_equal_units_of_other_names_agree(small: dict[str, Path], tmp_path: Path) -> None:
    model = SampledModel("Joules", "Torque in J", sample_time=H)
    model.output(
        "work",
        model.parameter("w", 1.0, unit="J", description="Work"),
        unit="J",
        description="Work",
        scalar=True,
    )
    sink = SampledModel("Sink", "Takes N.m", sample_time=H)
    sink.output("y", sink.input("u", 0.0, unit="N.m", description="Torque"), unit="N.m", description="u", scalar=True)
    fmus = {**small, "Joules": build(model, tmp_path), "Sink": build(sink, tmp_path)}
    result = simulate(system(fmus, {"a": "Joules", "b": "Sink"}, "a.work -> b.u"), H)
    assert result["b.y"][0] == 1.0
    with pytest.raises(SystemDescriptionError, match=r"units m and N\.m differ"):
        system(fmus, {"a": "Source", "b": "Sink"}, "a.u -> b.u")


@pytest.mark.parametrize("name", ["", "a.b", "twice"])
def test_component_names_must_be_clear(small: dict[str, Path], name: str) -> None:
    description = read_description(small["Source"])
    with pytest.raises(SystemDescriptionError, match=f"component name '{name}' is empty, has a dot, or is used twice"):
        System("s", (Component("twice", description), Component(name, description)))


def test_a_system_needs_components() -> None:
    with pytest.raises(SystemDescriptionError, match="System empty has no components"):
        System("empty", ())


def test_unconnected_inputs_warn_or_fail(small: dict[str, Path]) -> None:
    loose = linked(small, "source.u -> relay.u")
    sentence = r"^Unconnected inputs keep their start values: relay\.n, relay\.even, plant\.u\."
    with pytest.warns(UnconnectedInputWarning, match=f"{sentence}$"):
        simulate(loose, H)
    with pytest.raises(SystemDescriptionError, match=rf"{sentence} Connect them, or run without strict\.$"):
        simulate(loose, H, options=Options(strict=True))
    simulate(chain(small, 2), H, options=Options(strict=True))


def test_sample_time_sets_step_and_every_period(fig2: System) -> None:
    changed = fig2.with_sample_time(2e-5)
    assert changed.step == 2e-5
    assert {c.name: c.sample_time for c in changed.components if c.sample_time is not None} == dict.fromkeys(
        ("trajectory", "sensor", "controller", "actuator"), 2e-5
    )
    assert changed.steps_per_tick(1e-5) == dict.fromkeys(("trajectory", "sensor", "controller", "actuator"), 2)
    assert "dt_max" not in changed.component("plant").start


@pytest.mark.parametrize(
    ("period", "step", "message"),
    [
        (3e-4, 2e-4, r"time 0\.0003 s is not a multiple of the step 0\.0002 s; use a step of 0\.00015 s"),
        (1e-4, 3e-4, r"use a step of 0\.0001 s, or a sample time of 0\.0003 s"),
        (0.0, 1e-4, r"source: sample time 0 s is not positive"),
        (-1e-4, 1e-4, r"source: sample time -0\.0001 s is not positive"),
        (float("inf"), 1e-4, r"source: sample time inf s is not positive"),
    ],
)
def test_period_must_be_a_multiple_of_the_step(
    small: dict[str, Path], period: float, step: float, message: str
) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        system(small, {"source": "Source"}).set({"source.sample_time": period}).steps_per_tick(step)


def test_connecting_by_name_refuses_two_sources(small: dict[str, Path]) -> None:
    twins = {"a": small["Source"], "b": small["Source"], "relay": small["Relay"]}
    with pytest.raises(SystemDescriptionError, match=r"relay\.u could come from a or b; connect it by hand"):
        System.connected_by_name("s", twins)
    single = System.connected_by_name("s", {"relay": small["Relay"], "a": small["Source"]}, step=H)
    assert {str(c) for c in single.connections} == {
        "a.u -> relay.u",
        "a.n -> relay.n",
        "a.even -> relay.even",
    }


def test_a_system_without_a_step_or_a_stop_time_asks_for_them(small: dict[str, Path]) -> None:
    """Neither is guessed: an FMU cannot know how fast what it is coupled with moves, nor for how long."""
    lone = System.connected_by_name("lone", {"source": small["Source"]})
    assert (lone.step, lone.stop_time) == (None, None)
    no_step = r"^System lone has no communication step; give one, in s, as `step` or --step\.$"
    no_stop = r"^System lone has no stop time; give one, in s, as `stop_time` or --stop\.$"
    for algorithm in ("gauss-seidel", "adaptive"):
        with pytest.raises(SystemDescriptionError, match=no_step):
            simulate(lone, stop_time=2 * H, algorithm=algorithm)
        with pytest.raises(SystemDescriptionError, match=no_stop):
            simulate(lone, step=H, algorithm=algorithm)
    with pytest.raises(SystemDescriptionError, match=no_step):
        lone.stability()
    assert simulate(lone, stop_time=2 * H, step=H).time.tolist() == [0.0, H, 2 * H]
    assert simulate(lone, times=np.array([0.0, H, 2 * H])).time.tolist() == [0.0, H, 2 * H]
    assert simulate(replace(lone, step=H, stop_time=H)).time.tolist() == [0.0, H]


def test_a_verdict_without_a_stop_time_tells_the_growth_alone(small: dict[str, Path]) -> None:
    given = system(small, {"source": "Source", "relay": "Relay", "plant": "Integrator"}, "source.u -> plant.u")
    known, unknown = given.stability(), replace(given, stop_time=None).stability()
    assert f"times over {given.stop_time:g} s" in str(known)
    assert (unknown.amplification, unknown.radius) == (None, known.radius)
    assert "times over" not in str(unknown)
