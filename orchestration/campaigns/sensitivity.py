"""Sensitivity of a measure to the factors of a study: shares of its variance, with SALib or exactly for a grid.

Let Y be the measure and x_i a factor. The first-order index S1 = Var(E[Y | x_i]) / Var(Y) is the share of the variance
that goes when x_i is fixed. The total index ST = E[Var(Y | all but x_i)] / Var(Y) is the share that stays when all
other factors are fixed (Sobol 1993; Homma and Saltelli 1996).
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.view import View
from orchestration.errors import StudyError

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

GRID, SALTELLI, GIVEN = "variance of the grid", "Sobol indices of Saltelli's points", "RBD-FAST of samples"
"""How indices are computed, by what the table holds."""
RESAMPLES = 200
FEWEST_BLOCKS = 2  # of Saltelli's points
FEWEST = 50  # samples for RBD-FAST, which looks at 10 harmonics


def sensitivity(table: "xr.Dataset | pd.DataFrame", measure: str, *, seed: int = 0) -> "pd.DataFrame":
    """How much of the variance of a measure comes from each factor.

    Parameters
    ----------
    table
        Table of a `Study`. Of Saltelli's points, which `Study.samples` makes of a problem of SALib, come indices of
        Sobol; of a full grid the exact shares of its variance; of other samples the first-order index by RBD-FAST. Over
        seeds, a mean is taken first.
    measure
        Name of the measure.
    seed
        Seed of the resampling that gives the confidence.

    Returns
    -------
    DataFrame
        A row for each factor. Columns ``S1`` and, but for other samples, ``ST``, dimensionless; ``S1_conf`` and
        ``ST_conf`` have half the width of a 95 % confidence interval where points were sampled. ``attrs`` has the
        ``method``, the ``measure``, the number of ``points`` and of those ``left_out`` because a run failed.

    Raises
    ------
    StudyError
        If the table holds several systems, a grid has runs that failed, all values are equal, or SALib is missing.
    UnknownNameError
        If there is no such measure.

    Examples
    --------
    >>> from orchestration import Study, scenario, sensitivity
    >>> study = Study(scenario("fig2"), measure="peak = max(abs(controller.tau_cmd[1]))", stop_time=0.1)
    >>> table = study.grid({"plant.m[2]": [0.9, 1.0, 1.1], "controller.K": [3900.0, 4000.0, 4100.0]}).run()
    >>> found = sensitivity(table, "peak")
    >>> found.index.tolist(), bool(found["S1"].sum() <= 1)
    (['m[2]', 'K'], True)
    """
    view = View.of(table, measure)
    if len(view.variants()) > 1:
        names = ", ".join(view.variants())
        msg = f"The table holds the systems {names}; choose the rows of one, such as table.sel(system=...)."
        raise StudyError(msg)
    points, values, names = _points(view)
    if not names:
        msg = "Only seeds vary in the table; a sensitivity needs a factor with an order."
        raise StudyError(msg)
    if view.grid:
        found, method, left_out = _of_grid(view, points, values), GRID, 0
    elif (blocks := saltelli_blocks(points)) is not None:
        found, left_out = _of_saltelli(values, blocks, names, seed)
        method = SALTELLI
    else:
        found, left_out = _of_samples(points, values, names, seed)
        method = GIVEN
    import pandas as pd

    frame = pd.DataFrame(found, index=pd.Index(names, name="factor"))
    frame.attrs.update(method=method, measure=measure, points=len(values) - left_out, left_out=left_out)
    return frame


def _points(view: View) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Values of the factors, shape (n, d), and the mean of the measure over seeds, shape (n,), in the table's order."""
    names = view.ordered
    if not view.seeds or not names:
        return np.column_stack([view.column(name) for name in names or view.factors]), view.values, names
    groups = view.frame.groupby(list(names), sort=False)[view.measure]
    # A mean over the seeds that are left would compare points of unequal noise, so one failed run counts as failed.
    means = groups.agg(lambda values: values.mean(skipna=False)).reset_index()
    return means[list(names)].to_numpy(np.float64), means[view.measure].to_numpy(np.float64), names


def _require_variance(values: np.ndarray) -> None:
    if not np.ptp(values) > 0:
        msg = (
            "The measure has the same value in all runs, so no factor moves it; choose another measure or wider ranges."
        )
        raise StudyError(msg)


def _of_grid(view: View, points: np.ndarray, values: np.ndarray) -> dict[str, np.ndarray]:
    """Exact indices: every combination of levels counts the same."""
    failed = int(np.isnan(values).sum())
    if failed:
        msg = (
            f"{failed} of {len(values)} points of the grid have no value of {view.measure}, since runs failed; leave"
            " out levels at which they fail."
        )
        raise StudyError(msg)
    _require_variance(values)
    places = [np.unique(column, return_inverse=True) for column in points.T]
    cube = np.empty([len(levels) for levels, _ in places])
    cube[tuple(place for _, place in places)] = values
    axes = range(cube.ndim)
    total = cube.var()
    first = [cube.mean(axis=tuple(a for a in axes if a != axis)).var() / total for axis in axes]
    return {"S1": np.array(first), "ST": np.array([cube.var(axis=axis).mean() / total for axis in axes])}


def saltelli_blocks(points: np.ndarray) -> int | None:
    """Number of rows that belong together in Saltelli's points; None for other points.

    A block has the rows A, then A with one column of B each, then B with one column of A each, then B; without
    the second set if only indices of first and total order were asked for.

    Parameters
    ----------
    points
        Values of the factors, shape (n, d).
    """
    n, d = points.shape
    for size in dict.fromkeys((2 * d + 2, d + 2)):
        if n % size == 0 and n and _is_saltelli(points.reshape(-1, size, d)):
            return size
    return None


def has_indices(view: View) -> bool:
    """Whether a table holds Saltelli's points of one system whose measure varies, so that indices can be estimated."""
    if view.grid or view.seeds or not view.ordered or len(view.variants()) > 1:
        return False
    points, values, _ = _points(view)
    size = saltelli_blocks(points)
    if size is None:
        return False
    blocks = values.reshape(-1, size)
    whole = blocks[np.isfinite(blocks).all(axis=1)]
    return len(whole) >= FEWEST_BLOCKS and np.ptp(whole) > 0


def _is_saltelli(blocks: np.ndarray) -> bool:
    """Whether blocks of rows, shape (n, size, d), mix their first and their last row as Saltelli's do."""
    d = blocks.shape[2]
    a, b = blocks[:, 0], blocks[:, -1]
    for column in range(d):
        mixed = a.copy()
        mixed[:, column] = b[:, column]
        if not np.array_equal(blocks[:, 1 + column], mixed):
            return False
        if blocks.shape[1] == 2 * d + 2 and d > 1:
            mixed = b.copy()
            mixed[:, column] = a[:, column]
            if not np.array_equal(blocks[:, 1 + d + column], mixed):
                return False
    return bool((a != b).any())


def _of_saltelli(values: np.ndarray, size: int, names: tuple[str, ...], seed: int) -> tuple[dict[str, np.ndarray], int]:
    """Indices of Sobol by SALib; blocks with a failed run are left out as a whole."""
    blocks = values.reshape(-1, size)
    whole = np.isfinite(blocks).all(axis=1)
    _require_points(int(whole.sum()), FEWEST_BLOCKS, len(values), "blocks of Saltelli's points without a failed run")
    kept = blocks[whole].ravel()
    _require_variance(kept)
    analyze = _salib("sobol")
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    second = size == 2 * len(names) + 2
    found = analyze(problem, kept, calc_second_order=second, num_resamples=RESAMPLES, seed=_generator(seed))
    return {key: np.asarray(found[key]) for key in ("S1", "S1_conf", "ST", "ST_conf")}, len(values) - len(kept)


def _of_samples(
    points: np.ndarray, values: np.ndarray, names: tuple[str, ...], seed: int
) -> tuple[dict[str, np.ndarray], int]:
    """First-order indices by SALib's RBD-FAST, which takes any samples (Tarantola, Gatelli and Mara 2006)."""
    kept = np.isfinite(values)
    _require_points(int(kept.sum()), FEWEST, len(values), "samples without a failed run")
    _require_variance(values[kept])
    analyze = _salib("rbd_fast")
    bounds = [[float(column.min()), float(column.max())] for column in points.T]
    problem = {"num_vars": len(names), "names": list(names), "bounds": bounds}
    found = analyze(problem, points[kept], values[kept], num_resamples=RESAMPLES, seed=_generator(seed))
    return {key: np.asarray(found[key]) for key in ("S1", "S1_conf")}, int((~kept).sum())


def _generator(seed: int) -> np.random.Generator:
    """Random numbers for SALib, which takes a seed of 0 for none."""
    return np.random.default_rng(seed)


def _require_points(number: int, least: int, runs: int, what: str) -> None:
    if number < least:
        msg = f"The table has {runs} runs and only {number} {what}; {least} are the least for a sensitivity."
        raise StudyError(msg)


def _salib(method: str) -> Any:
    """The analysis of a method of SALib.

    Raises
    ------
    StudyError
        If SALib is not installed.
    """
    from importlib import import_module

    try:
        return import_module(f"SALib.analyze.{method}").analyze
    except ImportError as error:
        msg = (
            'Sensitivity indices of samples need the package SALib; install it by pip install "adaptimp[sensitivity]".'
        )
        raise StudyError(msg) from error
