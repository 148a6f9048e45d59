"""The program of the fresh processes that benchmarks measure; it prints a JSON object.

    python -m tests.benchmarks.child import MODULE
    python -m tests.benchmarks.child simulate FMU ALGORITHM
    python -m tests.benchmarks.child memory FMU N_ROWS [PARQUET]
    python -m tests.benchmarks.child campaign N_RUNS

FMU is a model of `tests.benchmarks.trivial`. Nothing but the standard library is imported at first.
"""

import json
import sys
from importlib import import_module
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

N_MEMORY_UNITS = 4


def main(arguments: list[str]) -> None:
    """Do it, and print the numbers."""
    work, *rest = arguments
    found = {"import": time_import, "simulate": time_simulate, "memory": measure_memory, "campaign": measure_campaign}[
        work
    ](*rest)
    sys.stdout.write(json.dumps(found) + "\n")


def time_import(module: str) -> dict[str, float]:
    """Time of an import, s."""
    begin = perf_counter()
    import_module(module)
    return {"seconds": perf_counter() - begin}


def time_simulate(fmu: str, algorithm: str) -> dict[str, float]:
    """Time of imports, and of the first and the second `simulate` of two FMUs, s; of the first also processor time."""
    begin = perf_counter()
    import_module("orchestration.master.kernel.step_control")  # which the first run would import
    import_module("orchestration.master.simulation")
    from orchestration.master.simulate import simulate

    system = chain(fmu, 2)
    imported, processor = perf_counter(), process_time()
    simulate(system, 16 * system.step, algorithm=algorithm)
    first, processor = perf_counter(), process_time() - processor
    simulate(system, 16 * system.step, algorithm=algorithm)
    second = perf_counter() - first
    return {"imports": imported - begin, "first": first - imported, "processor": processor, "second": second}


def measure_memory(fmu: str, n_rows: str, parquet: str | None = None) -> dict[str, float]:
    """Peak memory of a run that records all outputs, in memory or to a file; bytes."""
    import resource

    from orchestration.master.simulate import simulate, stream

    system = chain(fmu, N_MEMORY_UNITS)
    simulate(system, 9 * system.step)  # compiled code and caches are there
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    stop_time, begin = (int(n_rows) - 1) * system.step, perf_counter()
    if parquet is None:
        result = simulate(system, stop_time)
        size = result.time.nbytes + result.rows.nbytes
    else:
        stream(parquet, system, stop_time)
        size = Path(parquet).stat().st_size
    seconds = perf_counter() - begin
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    unit = 1 if sys.platform == "darwin" else 1024  # of ru_maxrss, bytes
    return {"peak": peak * unit, "peak_before": before * unit, "size": size, "seconds": seconds}


def measure_campaign(n_runs: str) -> dict[str, float]:
    """Peak memory of a study of many short runs when a tenth of them is made, and at the end; bytes."""
    import resource

    from orchestration.campaigns.study import Study
    from orchestration.paper.ready import scenario

    peaks: list[float] = []

    class Watch:
        """Takes the peak after each chunk from a tenth of the runs on."""

        def __init__(self) -> None:
            self.made = 0

        def begin(self, total: int, _names: object, _place: object) -> None:
            self.total = total

        def add(self, outcomes: Any, _kept: bool) -> None:
            self.made += len(outcomes.numbers)
            if self.made >= self.total / 10:
                peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)

        def end(self) -> None:
            """The last peak is taken with the last chunk."""

    system = scenario("fig7").with_sample_time(1e-4)
    study = Study(system, measure=["peak_force", "max_e"], stop_time=1e-3)
    walls = [1e4 + k for k in range(int(n_runs))]  # N/m
    study.grid({"plant.K_f": walls}).run(workers=2, progress=Watch())
    unit = 1 if sys.platform == "darwin" else 1024  # of ru_maxrss, bytes
    return {"tenth": peaks[0] * unit, "end": peaks[-1] * unit}


def chain(fmu: str, n_fmus: int) -> Any:
    """Components of one FMU, each output to the next component; every component has as many inputs as outputs."""
    from orchestration.fmi.description import read_description
    from orchestration.system.system import Component, Connection, System

    description = read_description(Path(fmu))
    names = [f"member{i + 1}" for i in range(n_fmus)]
    inputs, outputs = ([v.name for v in description.of_causality(kind)] for kind in ("input", "output"))
    links = [
        Connection(names[i - 1], y, names[i], u) for i in range(n_fmus) for y, u in zip(outputs, inputs, strict=True)
    ]
    return System("ring", tuple(Component(name, description) for name in names), tuple(links), step=2.0**-10)


if __name__ == "__main__":
    main(sys.argv[1:])
