"""Evaluates the times of a benchmark: statistics over rounds, ratios within rounds, goals, and tables."""

import importlib.metadata
import json
import os
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

Measure = Callable[[int], np.ndarray]  # number of steps -> wall times of its pieces, s
_PACKAGES = ("fmpy", "numba", "numpy", "casadi", "ziglang", "ecospy", "libcosimpy", "fmu-manipulation-toolbox")


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


def ratios(
    pairs: Sequence[tuple[str, str]], seconds: Mapping[str, np.ndarray], steps: Mapping[str, int]
) -> dict[str, dict[str, float]]:
    """Pairs of times per step: within each round, of minima, and undisturbed."""
    found = {}
    for a, b in pairs:
        if a in seconds and b in seconds:
            of_a, of_b = _per_step(seconds[a], steps[a]), _per_step(seconds[b], steps[b])
            quiet = undisturbed(seconds[a], steps[a]) / undisturbed(seconds[b], steps[b])
            found[f"{a}/{b}"] = {
                "median_of_rounds": float(np.median(of_a / of_b)),
                "of_minima": float(of_a.min() / of_b.min()),
                "undisturbed": quiet,
            }
    return found


def alternate(measures: Mapping[str, Measure], steps: Mapping[str, int], repetitions: int) -> dict[str, np.ndarray]:
    """Wall times of the pieces of each repetition, s, by name; in each round every measure runs once."""
    rounds: dict[str, list[np.ndarray]] = {name: [] for name in measures}
    for _ in range(repetitions):
        for name, measure in measures.items():
            rounds[name].append(measure(steps[name]))
    return {name: np.array(pieces) for name, pieces in rounds.items()}


@dataclass(frozen=True)
class Goal:
    """A measured number and what it should be at most, or at least."""

    what: str
    measured: float
    limit: float
    at_least: bool = False

    def record(self) -> dict[str, Any]:
        """For JSON."""
        met = self.measured >= self.limit if self.at_least else self.measured <= self.limit
        return {**asdict(self), "met": met}


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


def print_variants(result: Mapping[str, Any], meaning: Mapping[str, str], console: Console) -> None:
    """Print the variants and their ratios."""
    table = Table("variant", "what", "minimum", "median", "undisturbed", "repetitions", title="ns per step")
    for name, what in meaning.items():
        row = result[name]
        if "unavailable" in row:
            table.add_row(name, f"{what}: {row['unavailable']}")
            continue
        count = f"{row['repetitions']} x {row['steps']}"
        numbers = (f"{row[key]:.1f}" for key in ("minimum_ns", "median_ns", "undisturbed_ns"))
        table.add_row(name, what, *numbers, count)
    console.print(table)
    table = Table("ratio", "median of rounds", "of minima", "undisturbed")
    for name, ratio in result["ratios"].items():
        table.add_row(name, *(f"{value:.3f}" for value in ratio.values()))
    console.print(table)


def print_parts(result: Mapping[str, Any], console: Console) -> None:
    """Print where the time of the paper's system goes."""
    table = Table("component alone, ns/step", "bare", "set", "do_step", "get", "FMI in all")
    for name, times in result["per_fmu"].items():
        shown = (*times.values(), times["set"] + times["do_step"] + times["get"])
        table.add_row(name, *(f"{ns:.1f}" for ns in shown))
    console.print(table)
    table = Table("parts and whole, ns/step", *(name for name in result["parts"]))
    for row in next(iter(result["parts"].values())):
        shown = (part[row] for part in result["parts"].values())
        table.add_row(row, *("" if ns is None else f"{ns:.1f}" for ns in shown))
    console.print(table)


def print_goals(result: Mapping[str, Any], console: Console) -> None:
    """Print the goals."""
    table = Table("goal", "measured", "limit", "met")
    for goal in result["goals"]:
        sign = ">=" if goal["at_least"] else "<="
        table.add_row(
            goal["what"], f"{goal['measured']:.4g}", f"{sign} {goal['limit']:g}", "yes" if goal["met"] else "NO"
        )
    console.print(table)


def write_json(file: Path | None, result: Mapping[str, Any]) -> None:
    """Write a result, if there is a file to write."""
    if file is not None:
        file.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


def _processor() -> str:
    """The processor's name, as Linux tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
