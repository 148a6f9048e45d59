"""Run an SSP package in two independent co-simulation engines and read every value exactly.

The engines are ecos (ecospy 0.7.2) and libcosim 0.11.2 (libcosimpy 0.0.6). Both run a Jacobi
scheme of fixed step; ``engines.md`` beside this file lists their calls. ecos ignores the status of
every call and goes on with the values it gets, so a comparison must compare values.
"""

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any, NamedTuple
from zipfile import ZipFile

import numpy as np

from tests.untested import needs

_SSD = {"ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription"}
_LIBCOSIM_EXPERIMENT = """<ssd:DefaultExperiment startTime="0.0"><ssd:Annotations>
<ssc:Annotation type="com.opensimulationplatform"
xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations"><osp:Algorithm>
<osp:FixedStepAlgorithm baseStepSize="{step!r}" numWorkerThreads="{workers}"/>
</osp:Algorithm></ssc:Annotation></ssd:Annotations></ssd:DefaultExperiment>"""
_ECOS_GETTERS = {"Real": "get_real", "Integer": "get_integer", "Boolean": "get_bool"}
_PYTHON_TYPES = {"Real": float, "Integer": int, "Boolean": bool}
Inputs = Mapping[str, Sequence[float]]


class PeerError(RuntimeError):
    """An engine refused a package or could not finish a run."""


class _Variable(NamedTuple):
    """A variable of a component, as its modelDescription.xml declares it."""

    component: str
    name: str
    type: str
    reference: int
    causality: str


def unavailable(engine: str) -> str | None:
    """Tell why ``"ecospy"`` or ``"libcosimpy"`` does not load here, None if it does."""
    try:
        if engine == "ecospy":
            import ecospy  # noqa: F401
        else:
            from libcosimpy._internal import libcosimc

            libcosimc()
    except ModuleNotFoundError as error:
        return f"{engine} has no binaries for this platform: {error}"
    except (ImportError, OSError) as error:
        reason = f"{engine} does not load: {error}"
        return needs(reason, "libtbb12") if "libtbb" in reason else reason
    return None


def run_ecospy(
    ssp: Path, step: float, n_steps: int, columns: Sequence[str], inputs: Inputs | None = None
) -> np.ndarray:
    """Simulate a package in ecos from t = 0.

    Parameters
    ----------
    ssp : Path
        The package; all its parameter sets have one name.
    step : float
        Communication step [s].
    n_steps : int
        Number of steps N.
    columns : sequence of str
        Variables such as ``"plant.q[1]"``: Real, Integer or Boolean.
    inputs : mapping of str to sequence of float, optional
        By variable, what is set before the step from t_k; initialization knows none of it.

    Returns
    -------
    ndarray, shape (n_steps + 1, len(columns))
        Row k holds the values at step k, row 0 those after initialization; Booleans are 0 or 1.

    Raises
    ------
    PeerError
        If ecos refuses the package. Failures of FMUs during the run cannot be seen.
    """
    values = np.empty((n_steps + 1, len(columns)))
    with _unpacked(ssp) as folder, _ecos(folder, step) as simulation:
        readers = _ecos_readers(simulation, _select(folder, columns))
        drive = _ecos_driver(simulation, folder, inputs or {})
        for k in range(n_steps + 1):
            if k > 0:
                drive(k - 1)
            simulation.step(1 if k > 0 else 0)
            values[k] = [read(name) for read, name in readers]
    return values


def run_libcosim(
    ssp: Path,
    step_ns: int,
    n_steps: int,
    columns: Sequence[str],
    inputs: Inputs | None = None,
    *,
    workers: int | None = 0,
) -> np.ndarray:
    """Simulate a package in libcosim from t = 0.

    Parameters
    ----------
    ssp, n_steps, columns, inputs
        As for `run_ecospy`. Boolean columns slow the run: they need an observer of everything; so do inputs.
    step_ns : int
        Communication step [ns].
    workers : int or None, default 0
        Threads of the engine, named by an annotation in a copy of the package. With 0 a step of
        small FMUs is about 20 times faster, and an error during initialization is an exception;
        with threads it ends the process. None runs the package as it is. Same values each way.

    Returns
    -------
    ndarray, shape (n_steps, len(columns))
        Row k - 1 holds the values at step k; Booleans are 0 or 1.

    Raises
    ------
    PeerError
        If libcosim refuses the package or a step fails.
    """
    values = np.empty((n_steps, len(columns)))
    with _unpacked(ssp) as folder:
        chosen = _select(folder, columns)
        execution = _libcosim(folder, step_ns, workers)
        series = _record(execution, chosen, n_steps)
        if inputs or any(v.type == "Boolean" for v in chosen):
            drive = _libcosim_driver(execution, folder, inputs or {})
            _step_singly(execution, step_ns, chosen, values, drive)
        else:
            _advance(execution, step_ns, n_steps)
        _take_out(execution, series, chosen, values)
    return values


def time_ecospy(ssp: Path, step: float, n_steps: int, *, record: bool = True) -> float:
    """Measure the wall time [s] of `n_steps` steps of ecos, taken in one call after a first step.

    With `record`, ecos fetches all outputs after every step and keeps the last values (its one
    recorder of series writes text with six decimals); without, the connected outputs only.
    """
    with _unpacked(ssp) as folder, _ecos(folder, step) as simulation:
        for read, name in _ecos_readers(simulation, _select(folder) if record else []):
            read(name)  # from now on ecos fetches it
        simulation.step()
        start = perf_counter()
        simulation.step(n_steps)
        return perf_counter() - start


def time_libcosim(ssp: Path, step_ns: int, n_steps: int, *, record: bool = True, workers: int | None = 0) -> float:
    """Measure the wall time [s] of `n_steps` steps of libcosim, in one call after a first step.

    With `record`, libcosim stores the series of all Real and Integer outputs in memory (Booleans
    it cannot store); taking them out is not measured. `workers` as for `run_libcosim`.
    """
    with _unpacked(ssp) as folder:
        execution = _libcosim(folder, step_ns, workers)
        _record(execution, _select(folder) if record else [], n_steps + 1)
        _advance(execution, step_ns, 1)
        start = perf_counter()
        _advance(execution, step_ns, n_steps)
        return perf_counter() - start


@contextmanager
def _unpacked(ssp: Path) -> Iterator[Path]:
    """Unpack a package for a while (ecos never deletes the copy that it makes itself)."""
    with TemporaryDirectory() as folder, ZipFile(ssp) as package:
        package.extractall(folder)
        yield Path(folder)


def _variables(folder: Path) -> dict[str, _Variable]:
    """Read the variables of all components, by "component.variable"."""
    found = {}
    ssd = ET.parse(folder / "SystemStructure.ssd")
    for component in ssd.iterfind("ssd:System/ssd:Elements/ssd:Component", _SSD):
        name = component.attrib["name"]
        with ZipFile(folder / component.attrib["source"]) as fmu:
            description = ET.fromstring(fmu.read("modelDescription.xml"))
        for scalar in description.iterfind("ModelVariables/ScalarVariable"):
            about = scalar.attrib
            for kind in [element.tag for element in scalar if element.tag in _ECOS_GETTERS]:
                reference, causality = int(about["valueReference"]), about.get("causality", "local")
                v = _Variable(name, about["name"], kind, reference, causality)
                found[f"{name}.{v.name}"] = v
    return found


def _select(folder: Path, columns: Sequence[str] | None = None) -> list[_Variable]:
    """Look up columns, or all outputs; an unknown column is an error that lists the known ones."""
    variables = _variables(folder)
    if columns is None:
        return [v for v in variables.values() if v.causality == "output"]
    if unknown := [column for column in columns if column not in variables]:
        msg = f"No variables {', '.join(unknown)} in the package; it has {', '.join(variables)}."
        raise PeerError(msg)
    return [variables[column] for column in columns]


@contextmanager
def _ecos(folder: Path, step: float) -> Iterator[Any]:
    """Load a package in ecos and initialize it with its one parameter set."""
    from ecospy import EcosLib, EcosSimulation

    EcosLib.set_log_level("off")
    names = {ET.parse(f).getroot().attrib["name"] for f in (folder / "resources").glob("*.ssv")}
    try:
        simulation = EcosSimulation(step_size=step, ssp_path=str(folder))
    except Exception as error:  # ecospy raises nothing more specific
        msg = f"ecos does not load the package: {error}"
        raise PeerError(msg) from error
    with simulation:
        if len(names) > 1 or not simulation.init(0, *names):
            why = EcosLib.get_last_error()
            msg = f"ecos, which takes one parameter set, was given {sorted(names)}. {why}".strip()
            raise PeerError(msg)
        yield simulation
        simulation.terminate()


def _ecos_readers(simulation: Any, chosen: Sequence[_Variable]) -> list[tuple[Any, str]]:
    """Pair the function that reads a variable with the variable's name in ecos."""
    return [(getattr(simulation, _ECOS_GETTERS[v.type]), f"{v[0]}::{v[1]}") for v in chosen]


def _ecos_driver(simulation: Any, folder: Path, inputs: Inputs) -> Callable[[int], None]:
    """Make a function that sets the inputs of step k."""
    setters = {"Real": simulation.set_real, "Integer": simulation.set_integer, "Boolean": simulation.set_bool}
    chosen = _select(folder, list(inputs))

    def drive(k: int) -> None:
        for v, values in zip(chosen, inputs.values(), strict=True):
            setters[v.type](f"{v.component}::{v.name}", _PYTHON_TYPES[v.type](values[k]))

    return drive


def _libcosim_driver(execution: Any, folder: Path, inputs: Inputs) -> Callable[[int], None]:
    """Make a function that overrides the inputs from step k on."""
    if not inputs:
        return lambda _: None
    from libcosimpy.CosimManipulator import CosimManipulator

    override = CosimManipulator.create_override()
    execution.add_manipulator(override)
    setters = {
        "Real": override.slave_real_values,
        "Integer": override.slave_integer_values,
        "Boolean": override.slave_boolean_values,
    }
    chosen = [(v, _slave(execution, v)) for v in _select(folder, list(inputs))]

    def drive(k: int) -> None:
        for (v, index), values in zip(chosen, inputs.values(), strict=True):
            setters[v.type](index, [v.reference], [_PYTHON_TYPES[v.type](values[k])])

    return drive


def _libcosim(folder: Path, step_ns: int, workers: int | None) -> Any:
    """Load a package in libcosim; its first step will initialize it."""
    from libcosimpy._internal import get_last_error_message
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

    log_output_level(CosimLogLevel.FATAL)
    if workers is not None:
        _ask_for_workers(folder / "SystemStructure.ssd", step_ns, workers)
    step_size = step_ns if workers is None else None  # a step given here overrides the annotation
    try:
        return CosimExecution.from_ssp_file(ssp_path=str(folder), step_size=step_size)
    except AssertionError as error:
        msg = f"libcosim does not load the package: {get_last_error_message()}"
        raise PeerError(msg) from error


def _ask_for_workers(ssd: Path, step_ns: int, workers: int) -> None:
    """Replace the default experiment by one that names step and threads to libcosim."""
    step = step_ns / 1e9
    if int(step * 1e9) != step_ns:  # libcosim truncates to nanoseconds
        step = float(np.nextafter(step, np.inf))
    experiment = r"<ssd:DefaultExperiment[^>]*(/>|>.*</ssd:DefaultExperiment>)"
    text = re.sub(experiment, "", ssd.read_text("utf-8"), flags=re.DOTALL)
    body, end, _ = text.rpartition("</ssd:SystemStructureDescription>")
    ssd.write_text(body + _LIBCOSIM_EXPERIMENT.format(step=step, workers=workers) + end, "utf-8")


def _slave(execution: Any, v: _Variable) -> int:
    """Find libcosim's index of a variable's component."""
    return execution.slave_index_from_instance_name(v.component)


def _advance(execution: Any, step_ns: int, n_steps: int) -> None:
    """Take steps, and check that libcosim's clock advanced by as many."""
    from libcosimpy._internal import get_last_error_message

    before = execution.status().current_time
    succeeded = execution.step(n_steps)
    now = execution.status().current_time
    if not succeeded or now - before != n_steps * step_ns:
        msg = f"libcosim failed at t = {now / 1e9:g} s: {get_last_error_message().strip()}"
        raise PeerError(msg)


def _record(execution: Any, chosen: Sequence[_Variable], n_steps: int) -> Any:
    """Make libcosim record Real and Integer variables at the steps 0..N."""
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimObserver import CosimObserver

    series = CosimObserver.create_time_series(n_steps + 1)
    execution.add_observer(series)
    for v in chosen:
        if v.type != "Boolean":
            kind = CosimVariableType[v.type.upper()]
            series.start_time_series(_slave(execution, v), v.reference, kind)
    return series


def _take_out(execution: Any, series: Any, chosen: Sequence[_Variable], values: np.ndarray) -> None:
    """Fill the columns of Reals and Integers with the recorded series."""
    for j, v in enumerate(chosen):
        if v.type != "Boolean":
            read = getattr(series, f"time_series_{v.type.lower()}_samples")
            values[:, j] = read(_slave(execution, v), v.reference, 1, len(values))[2]


def _step_singly(
    execution: Any, step_ns: int, chosen: Sequence[_Variable], values: np.ndarray, drive: Callable[[int], None]
) -> None:
    """Take one driven step per row of `values` and fill its Boolean columns."""
    from libcosimpy.CosimObserver import CosimObserver

    last = CosimObserver.create_last_value()
    execution.add_observer(last)
    where = [(j, _slave(execution, v), v) for j, v in enumerate(chosen) if v.type == "Boolean"]
    for k, row in enumerate(values):
        drive(k)
        _advance(execution, step_ns, 1)
        for j, index, v in where:
            row[j] = last.last_boolean_values(index, [v.reference])[0]
