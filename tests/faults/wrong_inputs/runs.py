"""Wrong runs: times, steps, algorithms, options, records."""

import numpy as np

from orchestration import (
    Algorithm,
    Correction,
    Crossings,
    Options,
    OrchestrationError,
    SimulationError,
    StepControl,
    System,
    SystemDescriptionError,
    Tolerance,
    prepare,
    simulate,
)
from tests.faults.wrong_inputs.case import Action, Bench, Wrong, made, untyped

E = SystemDescriptionError


def _run(*arguments: object, **options: object) -> Action:
    return lambda b: untyped(simulate)(b.loop, *arguments, **options)


def _beyond(b: Bench) -> None:
    with prepare(b.loop, 1e-3, 1e-4) as simulation:
        simulation.run(until=0.5)


def _between(b: Bench) -> None:
    with prepare(b.loop, 1e-3, 1e-4) as simulation:
        simulation.run(until=2.5e-4)


def _fixed(b: Bench) -> None:
    with prepare(b.loop, 1e-3, 1e-4) as simulation:
        simulation.set({"plant.K_f": 1e4})


def _driven(b: Bench) -> None:
    with prepare(b.loop, 1e-3, 1e-4) as simulation:
        simulation.set({"plant.tau[1]": 1.0})


def _other_run(b: Bench) -> None:
    with prepare(b.loop, 1e-3, 1e-4) as one, prepare(b.loop, 2e-3, 1e-4) as other:
        other.restore(one.save())


def _no_snapshot(b: Bench) -> None:
    with prepare(b.loop, 1e-3, 1e-4) as simulation:
        simulation.restore(untyped("a.npz"))


def _lone(b: Bench) -> System:
    return System.of({"plant": b.fmu("Plant")})


TABLE = (
    Wrong("no step", lambda b: simulate(_lone(b), 1.0), "system|communication step", "no", "give one", E),
    Wrong("no stop time", lambda b: simulate(_lone(b), step=1e-3), "system|stop time", "no", "give one", E),
    Wrong("a run of no length", _run(0.0), "stop time 0 s", "start time 0 s", "later", E),
    Wrong("a stop time before the start", _run(-1.0), "stop time -1 s", "start time 0 s", "later", E),
    Wrong(
        "a start after the stop",
        _run(1.0, options=Options(start_time=2.0)),
        "stop time 1 s",
        "start time 2 s",
        "later",
        E,
    ),
    Wrong("a stop time of NaN", _run(float("nan")), "stop time", "nan", "finite", E),
    Wrong("an endless run", _run(float("inf")), "stop time", "inf", "finite", E),
    Wrong("a stop time that is a text", _run("2 s"), "stop time", "'2 s'", "number, in s", E),
    Wrong("a stop time that is a list", _run([1.0, 2.0]), "stop time", "[1.0, 2.0]", "number, in s", E),
    Wrong("a run of 30 years", _run(1e9), "1e+13 steps", "GB|TB", "larger step", E),
    Wrong("a run of 1e300 s", _run(1e300), "stop time 1e+300 s", "step 0.0001 s", "larger step", E),
    Wrong(
        "a step of a nanosecond", lambda b: simulate(_lone(b), 1000.0, 1e-9), "1e+12 steps", "GB|TB", "larger step", E
    ),
    Wrong("a step of 1e-300 s", lambda b: simulate(_lone(b), 1.0, 1e-300), "step", "1e-300 s", "larger", E),
    Wrong("a step of zero", _run(1.0, 0.0), "step", "0 s", "positive", E),
    Wrong("a step that is negative", _run(1.0, -1e-4), "step", "-0.0001 s", "positive", E),
    Wrong("a step of NaN", _run(1.0, float("nan")), "step", "nan", "finite number", E),
    Wrong("a step that is a text", _run(1.0, "1e-4"), "step", "'1e-4'", "number, in s", E),
    Wrong(
        "a step longer than the run", lambda b: simulate(_lone(b), 1e-4, 1e-3), "step 0.001 s", "0.0001 s", "stop at", E
    ),
    Wrong("a step that does not divide the run", _run(1.5e-4), "0.00015 s", "0.0001 s", "stop at", E),
    Wrong(
        "a step that does not fit the ticks", _run(1.2, 3e-4), "trajectory|sample time 0.0001 s", "0.0003 s", "use", E
    ),
    Wrong(
        "a time beyond which a step is nothing",
        lambda b: simulate(_lone(b), 1e12 + 1, 1e-5, options=Options(start_time=1e12)),
        "start time 1e+12 s",
        "step 1e-05 s",
        "larger step",
        E,
    ),
    Wrong("one point of time", _run(times=np.array([0.0])), "communication points", "1", "at least two", E),
    Wrong(
        "points that go back",
        _run(times=np.array([0.0, 2e-4, 1e-4])),
        "communication points",
        "0.0002 s|0.0001 s",
        "increas",
        E,
    ),
    Wrong("a point of NaN", _run(times=np.array([0.0, np.nan])), "communication points", "nan", "finite", E),
    Wrong("points that are texts", _run(times=["a", "b"]), "communication points", "['a', 'b']", "numbers", E),
    Wrong(
        "an unknown algorithm",
        _run(1e-3, 1e-4, "gaus-seidel"),
        "algorithm 'gaus-seidel'",
        "gauss-seidel",
        "did you mean",
        E,
    ),
    Wrong("an algorithm that is a number", _run(1e-3, 1e-4, 1), "algorithm 1", "gauss-seidel", "there are", E),
    Wrong("a record that is mistyped", _run(1e-3, record="plant.xx"), "plant|xx", "x", "did you mean", E),
    Wrong(
        "a record in another case",
        _run(1e-3, record="plant.X"),
        "plant has no variable X",
        "plant.x",
        "case-sensitive",
        E,
    ),
    Wrong("a record of an unknown component", _run(1e-3, record="plnt.x"), "plnt", "plant", "did you mean", E),
    Wrong(
        "a pattern that matches nothing",
        _run(1e-3, record="plnt.*"),
        "record: no output fits 'plnt.*'",
        "plant.x",
        "did you mean",
        E,
    ),
    Wrong("a record that is a number", _run(1e-3, record=5), "record", "5", "plant.x[1]", E),
    Wrong("a record with a number", _run(1e-3, record=["plant.x", 5]), "record", "5", "plant.x[1]", E),
    Wrong("options that are a mapping", _run(1e-3, options={"every": 2}), "options", "dict", "Options(", E),
    Wrong("a system that is a number", made(simulate, 5), "system", "5", "System", E),
    Wrong("progress that is a text", _run(1e-3, progress="yes"), "progress", "'yes'", "True", E),
    Wrong("an order that is mistyped", _run(1e-3, order=["plnt"]), "order", "plnt|plant", "did you mean", E),
    Wrong(
        "unconnected inputs in a strict run",
        lambda b: simulate(_lone(b), 1.0, 1e-3, options=Options(strict=True)),
        "plant.tau[1]",
        "start value",
        "connect",
        E,
    ),
    Wrong("every 1.5th step", made(Options, every=1.5), "every", "1.5", "integer", E),
    Wrong("every step that is true", made(Options, every=True), "every", "True", "integer", E),
    Wrong("a record that is no text", made(Options, record=5), "record", "5", "plant.x[1]", E),
    Wrong("a start time that is a text", made(Options, start_time="0"), "start_time", "'0'", "number", E),
    Wrong("a start time of NaN", made(Options, start_time=float("nan")), "start_time", "nan", "finite", E),
    Wrong("strict that is a text", made(Options, strict="yes"), "strict", "'yes'", "True or False", E),
    Wrong("ratios that are a number", made(Options, ratios=2), "ratios", "2", '{"plant": 2}', E),
    Wrong("a ratio of a half", made(Options, ratios={"plant": 0.5}), "plant", "0.5", "integer", E),
    Wrong(
        "crossings that are a text", made(Options, crossings="plant.gap"), "crossings", "'plant.gap'", "Crossings(", E
    ),
    Wrong("progress that is no function", made(Options, progress=5), "progress", "5", "function", E),
    Wrong("an output of crossings that is a number", made(Crossings, 5), "crossings", "5", "plant.gap", E),
    Wrong("a tolerance of crossings of zero", made(Crossings, ("plant.gap",), 0.0), "crossings", "0 s", "positive", E),
    Wrong(
        "a tolerance of crossings that is a text",
        made(Crossings, ("plant.gap",), "1 ns"),
        "crossings",
        "'1 ns'",
        "number",
        E,
    ),
    Wrong(
        "crossings of an unknown output",
        _run(1e-3, options=Options(crossings=Crossings(("plant.gop",)))),
        "plant|gop",
        "gap",
        "did you mean",
        E,
    ),
    Wrong(
        "a ratio of an unknown component",
        _run(1e-3, options=Options(ratios={"plnt": 2})),
        "plnt",
        "plant",
        "did you mean",
        E,
    ),
    Wrong("an order of inputs of 3", made(Algorithm, "a", order=3), "order", "3", "0, 1 or 2", E),
    Wrong("an order of inputs that is a text", made(Algorithm, "a", order="1"), "order", "'1'", "0, 1 or 2", E),
    Wrong("an unknown exchange", made(Algorithm, "a", "paralel"), "exchange 'paralel'", "parallel", "did you mean", E),
    Wrong("a name that is a number", made(Algorithm, 5), "name", "5", "text", E),
    Wrong(
        "a correction that is a text",
        made(Algorithm, "a", correction="newton"),
        "correction",
        "'newton'",
        "Correction(",
        E,
    ),
    Wrong("a control that is a number", made(Algorithm, "a", control=1e-6), "control", "1e-06", "StepControl(", E),
    Wrong("an unknown correction", made(Correction, "newtn"), "correction 'newtn'", "newton", "did you mean", E),
    Wrong("no iterations", made(Correction, max_iterations=0), "max_iterations", "0", "at least 1", E),
    Wrong("a tolerance that is a number", made(Correction, tolerance=1e-6), "tolerance", "1e-06", "Tolerance(", E),
    Wrong(
        "a tolerance of a step control that is a number", made(StepControl, 1e-6), "tolerance", "1e-06", "Tolerance(", E
    ),
    Wrong("a first step that is negative", made(StepControl, first=-1.0), "first step", "-1 s", "positive", E),
    Wrong("a first step that is a text", made(StepControl, first="1"), "first step", "'1'", "number", E),
    Wrong("a tolerance of zero", made(Tolerance, 0.0), "tolerance", "0", "positive", E),
    Wrong("a tolerance that is a text", made(Tolerance, "small"), "tolerance", "'small'", "number", E),
    Wrong(
        "an absolute tolerance that is negative",
        made(Tolerance, 1e-6, {"m": -1.0}),
        "tolerance in m",
        "-1 m",
        "positive",
        E,
    ),
    Wrong("an absolute tolerance without a unit", made(Tolerance, 1e-6, 1e-9), "absolute", "1e-09", '{"m": ', E),
    Wrong(
        "a run outside its block",
        lambda b: prepare(b.loop, 1e-3).run(),
        "run",
        "has not begun",
        "with prepare",
        OrchestrationError,
    ),
    Wrong("a run until beyond its end", _beyond, "0.5 s", "0.001 s", "communication point", E),
    Wrong("a run until between two points", _between, "0.00025 s", "0.0002 s", "communication point", E),
    Wrong(
        "a fixed parameter of a run",
        _fixed,
        "plant|K_f",
        "fixed parameter",
        "can be set until initialization ends",
        OrchestrationError,
    ),
    Wrong("a driven input of a run", _driven, "plant.tau[1]", "actuator.tau[1]", "disconnect", OrchestrationError),
    Wrong("a snapshot of another run", _other_run, "snapshot|another run", "points", "must be the same", E),
    Wrong("a snapshot that is a file name", _no_snapshot, "snapshot", "'a.npz'", "Snapshot.read", E),
    Wrong(
        "a loop that diverges",
        lambda b: simulate(b.loop.set({"controller.K": 1e9}), 1.0, 1e-4),
        "plant|at t =",
        "step",
        "diverge",
        SimulationError,
    ),
)
