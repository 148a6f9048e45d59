"""Numbers of a benchmark: statistics, ratios within rounds, and a table of them."""

import importlib.metadata
import os
import platform
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

RATIOS = (
    *(("c", "bare"), ("ours", "bare"), ("ours", "c")),
    *(("fmpy", "ours"), ("ecospy", "ours"), ("libcosimpy", "ours")),
)
MEANING = {
    "bare": "no FMI, no records",
    "c": "C loop",
    "ours": "loop.run",
    "fmpy": "Python loop",
    "ecospy": "ecos, Jacobi",
    "libcosimpy": "libcosim, Jacobi",
}
_PACKAGES = ("fmpy", "numba", "numpy", "casadi", "ziglang", "ecospy", "libcosimpy")


def statistics(seconds: np.ndarray, n_steps: int) -> dict[str, Any]:
    """Statistics of repetitions, ns per step.

    Parameters
    ----------
    seconds
        Wall times of the pieces of each repetition, s, shape (n_repetitions, n_pieces).

    Returns
    -------
    dict
        Minimum and median of the repetitions, and ``undisturbed_ns``: the minimum of every piece,
        summed. On a busy machine no repetition is spared, but most pieces are, at some time. The
        engines' repetitions are one piece each, so there it is the minimum.
    """
    ns = _per_step(seconds, n_steps)
    return {
        "minimum_ns": float(ns.min()),
        "median_ns": float(np.median(ns)),
        "undisturbed_ns": undisturbed(seconds, n_steps),
        "repetitions": len(ns),
        "steps": n_steps,
    }


def undisturbed(seconds: np.ndarray, n_steps: int) -> float:
    """Time in ns per step of a run made of the fastest of each piece, see `statistics`."""
    return float(seconds.min(axis=0).sum() / n_steps * 1e9)


def ratios(seconds: Mapping[str, np.ndarray], steps: Mapping[str, int]) -> dict[str, dict[str, float]]:
    """Pairs of `RATIOS`, of times per step: within each round, of minima, and undisturbed."""
    found = {}
    for a, b in RATIOS:
        if a in seconds and b in seconds:
            of_a, of_b = _per_step(seconds[a], steps[a]), _per_step(seconds[b], steps[b])
            quiet = undisturbed(seconds[a], steps[a]) / undisturbed(seconds[b], steps[b])
            found[f"{a}/{b}"] = {
                "median_of_rounds": float(np.median(of_a / of_b)),
                "of_minima": float(of_a.min() / of_b.min()),
                "undisturbed": quiet,
            }
    return found


def _per_step(seconds: np.ndarray, n_steps: int) -> np.ndarray:
    """Time in ns per step of each repetition."""
    return seconds.sum(axis=1) / n_steps * 1e9


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that matter, where installed."""
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def machine() -> dict[str, Any]:
    """Processor, system and load of this machine."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "load_average": load,
    }


def print_tables(result: Mapping[str, Any], console: Console) -> None:
    """Print the variants, their ratios and where the time goes."""
    table = Table("variant", "what", "minimum", "median", "undisturbed", "repetitions", title="ns per step")
    for name, what in MEANING.items():
        row = result[name]
        if "unavailable" in row:
            table.add_row(name, f"{what}: {row['unavailable']}")
            continue
        count = f"{row['repetitions']} x {row['steps']}"
        numbers = (f"{row[key]:.0f}" for key in ("minimum_ns", "median_ns", "undisturbed_ns"))
        table.add_row(name, what, *numbers, count)
    console.print(table)
    table = Table("ratio", "median of rounds", "of minima", "undisturbed")
    for name, ratio in result["ratios"].items():
        table.add_row(name, *(f"{value:.3f}" for value in ratio.values()))
    console.print(table)
    table = Table("component alone, ns/step", "bare", "set", "do_step", "get", "FMI in all")
    for name, times in result["per_fmu"].items():
        shown = (*times.values(), times["set"] + times["do_step"] + times["get"])
        table.add_row(name, *(f"{ns:.1f}" for ns in shown))
    console.print(table)


def _processor() -> str:
    """The processor's name, as Linux tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
