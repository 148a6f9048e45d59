"""Tables as studies return them, whose measures are formulas of their factors."""

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd
import xarray as xr

UNITS = {"K_f": "N/m", "m": "kg", "peak": "N", "seed": "", "a": "", "b": "", "c": ""}
MESSAGE = "plant: fmi2DoStep returned fmi2Error at t = 0.1 s; its last message: <b>&."


def grid(
    levels: Mapping[str, object], measure: Callable[..., np.ndarray], failed: Callable[..., np.ndarray] | None = None
) -> xr.Dataset:
    """A table of all combinations of levels with the measure ``peak``; where `failed` holds, the runs failed."""
    values = {name: np.asarray(some) for name, some in levels.items()}
    cube = dict(zip(values, np.meshgrid(*values.values(), indexing="ij"), strict=True))
    names = tuple(values)
    bad = np.zeros([len(v) for v in values.values()], bool) if failed is None else failed(**cube)
    peak = np.where(bad, np.nan, measure(**cube))
    data = {
        "peak": (names, peak, {"units": "N"}),
        "status": (names, np.where(bad, "failed", "complete").astype(object)),
        "message": (names, np.where(bad, MESSAGE, "").astype(object)),
    }
    coordinates = {name: (name, some, {"units": UNITS.get(name, ""), "sets": name}) for name, some in values.items()}
    return xr.Dataset(data, coordinates, {"system": "fig7", "algorithm": "gauss-seidel", "stop_time": 2.0})


def samples(points: pd.DataFrame, peak: np.ndarray) -> pd.DataFrame:
    """A table of samples with the measure ``peak``; where it is NaN, the runs failed."""
    failed = np.isnan(peak)
    table = points.assign(
        peak=peak, status=np.where(failed, "failed", "complete"), message=np.where(failed, MESSAGE, "")
    )
    table.attrs.update(units=UNITS, sets={name: name for name in points}, system="fig7", stop_time=2.0)
    return table


K = np.geomspace(1e3, 1e6, 4)  # N/m
MASSES = [0.5, 1.0, 2.0]  # kg
SEEDS = [1, 2, 3, 4]


def force(**factors: np.ndarray) -> np.ndarray:
    """A peak force, N, that grows with stiffness and mass, and scatters with the seed."""
    return np.sqrt(factors["K_f"] * factors.get("m", 1.0)) * (1 + 0.01 * factors.get("seed", 0.0))
