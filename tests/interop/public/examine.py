"""Examines one FMU in one way, in a process of its own, and writes what it finds.

    python -m tests.interop.public.examine {about,check,ours,fmpy} X.fmu OUT

OUT is a JSON file of `about` and `check`, and an npz file with ``time`` and ``rows`` of the runs. Both runs have the
same communication points: those of the FMU's default experiment, a thousand steps at most.
"""

import json
import sys
import warnings
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from lxml import etree

from orchestration import System, simulate
from orchestration.check import check

MOST_STEPS, USUAL_STEPS, MOST_LOCALS = 1000, 500, 40


def about(path: Path) -> dict[str, Any]:
    """Version, tool and kinds of an FMU, by its description as it stands."""
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("modelDescription.xml"), etree.XMLParser(resolve_entities=False))
    kinds = [word for word, tag in (("CS", "CoSimulation"), ("ME", "ModelExchange")) if root.find(tag) is not None]
    tool = " ".join(root.get("generationTool", "not named").split())
    return {"version": root.get("fmiVersion", "?"), "tool": tool, "kinds": kinds}


def experiment(path: Path) -> tuple[np.ndarray, float, list[str]]:
    """Communication points, the step, and the variables to record: numeric outputs, or else local Reals."""
    described = fmpy.read_model_description(str(path), validate=False)
    default = described.defaultExperiment
    begin = float(getattr(default, "startTime", None) or 0.0)
    end = float(getattr(default, "stopTime", None) or begin + 1.0)
    step = float(getattr(default, "stepSize", None) or (end - begin) / USUAL_STEPS)
    n = max(1, min(MOST_STEPS, round((end - begin) / step)))
    outputs = [v.name for v in described.modelVariables if v.causality == "output" and v.type != "String"]
    local = [v.name for v in described.modelVariables if v.causality == "local" and v.type == "Real"]
    return begin + np.arange(n + 1) * step, step, outputs or local[:MOST_LOCALS]


def ours(path: Path, out: Path) -> None:
    """Run it here."""
    warnings.simplefilter("ignore")
    system = System.of({"m": path})
    times, _, names = experiment(path)
    result = simulate(system, times=times, record=[f"m.{name}" for name in names])
    np.savez(out, time=result.time, rows=np.column_stack([result[f"m.{name}"] for name in names]))


def theirs(path: Path, out: Path) -> None:
    """Run it in fmpy."""
    times, step, names = experiment(path)
    span = {"start_time": times[0], "stop_time": times[-1], "step_size": step, "output_interval": step}
    result = fmpy.simulate_fmu(str(path), fmi_type="CoSimulation", output=names, **span)
    rows = np.column_stack([np.asarray(result[name], float) for name in names])
    np.savez(out, time=result["time"], rows=rows)


def main() -> int:
    """Examine; returns the exit code."""
    way, path, out = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    if way == "about":
        out.write_text(json.dumps(about(path)), encoding="utf-8")
    elif way == "check":
        out.write_text(check(path).json(), encoding="utf-8")
    else:
        (ours if way == "ours" else theirs)(path, out)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
