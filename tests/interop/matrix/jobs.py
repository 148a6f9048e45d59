"""The jobs: every FMU of the catalog with its reference's inputs, every figure in full length.

Figs. 5 to 7 are taken at the earlier calibration, ``fig5-first`` and so on, which has half the steps.

The FMUs that have Booleans or Integers, and all figures, are there a second time with Reals only.
"""

import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from fmus.catalog import MODELS
from orchestration import Options, System, UnconnectedInputWarning, simulate
from orchestration.fmi.description import read_description
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import AT_FIRST, CRAIG, SCENARIOS, SLOTINE_LI, SPONG_ORTEGA, Scenario
from orchestration.system.system import Component
from tests.conformance.replay import options, table
from tests.driver import Driver
from tests.interop import plain_loop
from tests.interop.matrix.protocol import FMU, LOOP_AT_ONCE, NANOSECONDS, SYSTEM, Job, Part, Tool

REALS = "-reals"
"""Ends the name of a job whose FMUs are those of ``adaptimp build --reals``."""
_CHANGED = ("ForceSensor", CRAIG, SLOTINE_LI, SPONG_ORTEGA, "Actuator", "Actuator3R")
CONTAINER = "fig5-as-fmu"
"""Name of the job of one FMU that is the whole system of fig5."""
AT_ONCE = (
    1000  # steps of fig5 in a communication step of that FMU: 100 communication steps of 0.02 s are the whole figure
)
UNITS = (*MODELS, *(f"{name}{REALS}" for name in _CHANGED), CONTAINER, f"{CONTAINER}{REALS}")
FIGURES = tuple(name for name in SCENARIOS if name.startswith("fig"))
SYSTEMS = (*FIGURES, *(f"{name}{REALS}" for name in FIGURES))
ALONE = "unit"  # the component of an FMU's job


def built(folder: Path) -> dict[str, Path]:
    """The files of all FMUs by model identifier or `CONTAINER`, and by the same with `REALS` those with Reals only.

    The containers are written into the folder.
    """
    found = {}
    for ending in ("", REALS):
        files = fmus(MODELS, reals=bool(ending))
        container = figure_system("fig5", files).to_fmu(folder / f"{CONTAINER}{ending}.fmu")
        found |= {f"{name}{ending}": path for name, path in {**files, CONTAINER: container}.items()}
    return found


def chosen(name: str, files: Mapping[str, Path]) -> tuple[str, Mapping[str, Path]]:
    """What a job is about, the model or the figure, and the files that it uses by model identifier."""
    if not name.endswith(REALS):
        return name, files
    return name.removesuffix(REALS), {key.removesuffix(REALS): files[key] for key in files if key.endswith(REALS)}


def fmu_job(identifier: str, files: Mapping[str, Path], folder: Path) -> Job:
    """An FMU alone, driven by ``fmus/reference/FMU/FMU_in.csv``, or the container, which has no inputs."""
    if identifier == CONTAINER:
        return _container_job(files, folder)
    inputs, step = table(identifier, "in"), options(identifier)["StepSize"]
    driven = [name for name in inputs.dtype.names or () if name != "time"]
    description = read_description(files[identifier])
    start = {name: float(inputs[name][0]) for name in driven}
    system = System(identifier, (Component(ALONE, description, start),), step=step, stop_time=(len(inputs) - 1) * step)
    job = _job(system, FMU, len(inputs) - 1, folder)
    return replace(job, stimulus={f"{ALONE}.{name}": [float(x) for x in inputs[name]] for name in driven})


def _container_job(files: Mapping[str, Path], folder: Path) -> Job:
    scenario = figure_scenario("fig5")
    component = Component(ALONE, read_description(files[CONTAINER]))
    step = AT_ONCE * scenario.step
    system = System(CONTAINER, (component,), step=step, stop_time=scenario.stop_time)
    return _job(system, FMU, round(scenario.stop_time / step), folder)


def figure_job(figure: str, files: Mapping[str, Path], folder: Path, n_steps: int | None = None) -> Job:
    """A figure of the paper, whole or its first steps."""
    system = figure_system(figure, files)
    return _job(system, SYSTEM, n_steps or round(system.run_stop_time() / system.run_step()), folder)


def figure_scenario(figure: str) -> Scenario:
    """The scenario of a figure; that of the earlier calibration where there is one, under the figure's name."""
    return replace(AT_FIRST.get(f"{figure}-first", SCENARIOS[figure]), name=figure)


def figure_system(figure: str, files: Mapping[str, Path]) -> System:
    """The system of a figure."""
    scenario = figure_scenario(figure)
    return scenario.system({identifier: files[identifier] for identifier in scenario.models.values()})


def our_rows(job: Job, tool: Tool, files: Mapping[str, Path]) -> np.ndarray:
    """What ours shows at all steps of a job, as the tool's algorithm and clock ask; shape (n_steps + 1, columns)."""
    if job.name == CONTAINER:
        result = simulate(figure_system("fig5", files))
        return np.column_stack([result[job.split(name)[1]][::AT_ONCE] for name in job.columns])
    times = np.arange(job.n_steps + 1) * job.step
    if tool.clock == NANOSECONDS:
        times = np.arange(job.n_steps + 1) * round(job.step * 1e9) / 1e9
    if job.kind == FMU:
        return _replayed(job, times, nanoseconds=tool.clock == NANOSECONDS)
    system = figure_system(job.name, files)
    if tool.algorithm == LOOP_AT_ONCE:
        rows = plain_loop.run(system, job.n_steps, plain_loop.loop_at_once(system))
        return rows[:, [plain_loop.columns_of(system).index(name) for name in job.columns]]
    if tool.clock == NANOSECONDS:
        result = simulate(system, algorithm=tool.algorithm, times=times)
    else:
        result = simulate(system, job.n_steps * job.step, job.step, tool.algorithm)
    return np.column_stack([result[name] for name in job.columns])


def _replayed(job: Job, times: np.ndarray, *, nanoseconds: bool) -> np.ndarray:
    """Rows of an FMU driven by its stimulus, set before every step."""
    part = job.parts[0]
    driver = Driver(Path(part.fmu))
    names = [name.partition(".")[2] for name in job.columns]

    def set_row(k: int) -> None:
        split = [(job.split(path)[1], values[k]) for path, values in job.stimulus.items()]
        driver.set({name: part.value(name, value) for name, value in split})

    driver.enter()
    set_row(0)
    driver.call("fmi2ExitInitializationMode")
    rows = [driver.get(*names)]
    for k in range(job.n_steps):
        set_row(k)
        driver.step(times[k], times[k + 1] - times[k] if nanoseconds else job.step)
        rows.append(driver.get(*names))
    driver.close()
    return np.array(rows)


def _job(system: System, kind: str, n_steps: int, folder: Path) -> Job:
    first = _initial_row(system)
    parts = []
    for component in system.components:
        variables = component.description.variables
        driven = {c.input: first[f"{c.source}.{c.output}"] for c in system.connections if c.target == component.name}
        inputs = component.description.of_causality("input")
        alone = {v.name: float(v.start) for v in inputs if v.start is not None}
        start = {name: float(value) for name, value in component.start.items()}
        parts.append(
            Part(
                component.name,
                str(component.description.path),
                start,
                {**alone, **start, **driven},
                {name: v.type for name, v in variables.items()},
                {name: v.reference for name, v in variables.items()},
                {name: v.causality for name, v in variables.items()},
            )
        )
    connections = tuple((c.source, c.output, c.target, c.input) for c in system.connections)
    ssp = system.write(folder / f"{system.name}.ssp")
    return Job(system.name, kind, system.run_step(), n_steps, str(ssp), tuple(parts), connections, tuple(first))


def _initial_row(system: System) -> dict[str, float]:
    """All outputs when initialization has settled, by ``component.variable``."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)
        result = simulate(system, system.step, options=Options(allow_stale_inputs=True))
    return dict(zip(result.names, (float(x) for x in result.rows[0]), strict=True))
