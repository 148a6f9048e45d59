"""Writes references of every FMU into fmus/reference/: runs in the form of the FMI cross-check, and parameter sets.

    python -m orchestration.paper.reference_data [--out DIR]

For each FMU: ``NAME_in.csv``, what is set at each communication point before the step from there;
``NAME_ref.csv``, the outputs after initialization and at the end of each step; ``NAME_ref.opt``, times,
step, and the tolerance. Another tool that agrees within ``RelTol`` of each column's largest absolute
value imports the FMU correctly. Tunable parameters are among the inputs, as fmpy accepts them. An FMU
without inputs has no ``NAME_in.csv``. ``NAME_sets.csv`` holds the start values of the FMU in the paper's runs.

The FMUs carry these files. The results do not depend on the files that an FMU carries, so there is no circle: here the
FMUs are built without them.
"""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import fmpy
import numpy as np
from fmpy.util import read_csv

from adaptimp_fmu.files.whole_file import write_whole
from fmus.catalog import MODELS
from fmus.project import REFERENCES
from orchestration.paper.built_fmus import built_model
from orchestration.paper.parameter_sets import write_parameter_sets
from orchestration.paper.stimuli import STIMULI, Stimulus

FOLDER = REFERENCES
DIGITS = 10
REL_TOL = 1e-9  # ten digits are rounded by up to 5e-10; a last bit changed in all inputs moves outputs by 1e-12


def write_reference(name: str, folder: Path) -> None:
    """Simulate an FMU with fmpy and write its three files into ``folder/NAME``."""
    stimulus = STIMULI[name]
    folder = folder / name
    folder.mkdir(parents=True, exist_ok=True)
    times = stimulus.times()
    columns = stimulus.columns(times)
    inputs = None
    if columns:
        path = folder / f"{name}_in.csv"
        _write(path, {"time": times, **columns})
        inputs = read_csv(path)  # as another tool sees them: rounded
    result = _simulate(name, stimulus, inputs)
    _write(folder / f"{name}_ref.csv", {column: result[column] for column in result.dtype.names or ()})
    _write_options(folder / f"{name}_ref.opt", stimulus)


def _simulate(name: str, stimulus: Stimulus, inputs: np.ndarray | None) -> np.ndarray:
    """All outputs at the communication points."""
    model = MODELS[name]()
    model.reference_runs, model.parameter_sets = (), ()  # the old ones may not fit any more
    path = str(built_model(model))
    variables = fmpy.read_model_description(path).modelVariables
    return fmpy.simulate_fmu(
        path,
        start_time=0.0,
        stop_time=stimulus.times()[-1],
        step_size=stimulus.step,
        output_interval=stimulus.step,
        fmi_type="CoSimulation",
        input=cast("Any", inputs),  # fmpy takes None too, which its annotation forgets
        output=[variable.name for variable in variables if variable.causality == "output"],
    )


def _write(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    lines = [",".join(f'"{name}"' for name in columns)]
    for row in zip(*columns.values(), strict=True):
        lines.append(",".join(f"{float(value) + 0.0:.{DIGITS}g}" for value in row))
    write_whole(path, "".join(f"{line}\n" for line in lines).encode())


def _write_options(path: Path, stimulus: Stimulus) -> None:
    options = {"StartTime": 0, "StopTime": stimulus.times()[-1], "StepSize": stimulus.step, "RelTol": REL_TOL}
    text = "".join(f"{name},{value:.{DIGITS}g}\n" for name, value in options.items())
    write_whole(path, text.encode())


def main() -> None:
    """Write the references of every FMU."""
    parser = argparse.ArgumentParser(prog="reference_data", description=__doc__.partition("\n")[0] if __doc__ else "")
    parser.add_argument("--out", type=Path, default=FOLDER)
    out = parser.parse_args().out
    for name in STIMULI:
        write_reference(name, out)
        write_parameter_sets(name, out)


if __name__ == "__main__":
    main()
