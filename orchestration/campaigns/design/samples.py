"""Samples: rows of values drawn from distributions, taken from a table, or chosen for indices of Sobol."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.design.design import Block
from orchestration.campaigns.design.factor import Factor, Target, factors_of
from orchestration.campaigns.design.ranges import Choice, distribution
from orchestration.errors import StudyError, printable
from orchestration.fmi.given import shown
from orchestration.fmi.names import suggestion

if TYPE_CHECKING:
    import pandas as pd

SOBOL, LATIN_HYPERCUBE, RANDOM = "sobol", "latin-hypercube", "random"
METHODS = (SOBOL, LATIN_HYPERCUBE, RANDOM)
"""Ways to draw samples: points of Sobol, scrambled; Latin hypercube; independent points."""
SALIB_KEYS = {"num_vars", "names", "bounds"}
"""Keys by which a mapping is known to be a problem of SALib."""
SMALLEST = 2.0**-53
"""Distance of the uniform numbers from 0 and 1, where a distribution may be infinite."""


def unit_samples(n: int, dimensions: int, method: str, seed: int) -> np.ndarray:
    """Points in the unit cube, float64, shape (n, dimensions), above 0 and below 1.

    Points of Sobol are balanced if their number is a power of 2.

    Raises
    ------
    StudyError
        If the method is unknown, or there is no point.
    """
    from scipy.stats import qmc

    if isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1:
        msg = f"The number of samples is {shown(n)}; give n, a whole number from 1 on."
        raise StudyError(msg)
    if method not in METHODS:
        msg = f"Samples cannot be drawn by {shown(method)}; {suggestion(str(method), METHODS)}"
        raise StudyError(msg)
    generator = np.random.default_rng(_seed(seed))
    if method == SOBOL:
        found = qmc.Sobol(dimensions, scramble=True, rng=generator).random_base2((int(n) - 1).bit_length())[:n]
    elif method == LATIN_HYPERCUBE:
        found = qmc.LatinHypercube(dimensions, rng=generator).random(n)
    else:
        found = generator.random((n, dimensions))
    return np.clip(found, SMALLEST, 1 - SMALLEST)


def drawn(factors: Sequence[Factor], targets: Sequence[Target], uniform: np.ndarray) -> Block:
    """Samples from the distributions of factors.

    Parameters
    ----------
    targets
        What the factors set.
    uniform
        Points in the unit cube, shape (n, n_factors).
    """
    columns = []
    for factor, target, share in zip(factors, targets, uniform.T, strict=True):
        law = distribution(factor.name, factor.values)
        values = np.asarray(law.ppf(share), dtype=np.float64)
        if isinstance(law, Choice):
            values = target.numbers(law.levels)[values.astype(np.int64)]
        columns.append(target.checked(values))
    return Block(tuple(factor.bare() for factor in factors), np.column_stack(columns), samples=True)


def tabulated(table: "pd.DataFrame", targets: Sequence[Target]) -> Block:
    """The rows of a DataFrame as samples."""
    if not len(table) or not targets:
        msg = (
            f"The table of samples has {len(table)} rows and {len(targets)} columns; give a row and a column at least."
        )
        raise StudyError(msg)
    columns = []
    for name, target in zip(table.columns, targets, strict=True):
        column = table[name]
        plain = column.dtype.kind in "iufb"
        columns.append(target.checked(column.to_numpy(np.float64)) if plain else target.numbers(column.tolist()))
    return Block(tuple(target.factor.bare() for target in targets), np.column_stack(columns), samples=True)


def saltelli(problem: Mapping[str, Any], targets: Sequence[Target], n: int, seed: int) -> Block:
    """Saltelli's points for a problem of SALib, from which indices of Sobol can be estimated.

    Returns
    -------
    Block
        n (2 d + 2) rows for d factors, in the order that ``SALib.analyze.sobol`` expects.

    Raises
    ------
    StudyError
        If SALib is not installed, or refuses the problem.
    """
    try:
        from SALib.sample import sobol
    except ImportError as error:
        msg = 'A problem of SALib needs the package SALib; install it by pip install "adaptimp[sensitivity]".'
        raise StudyError(msg) from error
    if isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1 or n & (n - 1):
        msg = f"The number of samples for indices of Sobol is {shown(n)}; give n, a power of 2 such as 1024."
        raise StudyError(msg)
    try:
        values = np.asarray(sobol.sample(dict(problem), int(n), seed=_seed(seed)), dtype=np.float64)
    except (ValueError, KeyError, IndexError, TypeError) as error:
        msg = f"The problem of SALib cannot be sampled: {printable(error, 500)}; each name needs its bounds."
        raise StudyError(msg) from error
    checked = [target.checked(column) for target, column in zip(targets, values.T, strict=True)]
    return Block(tuple(target.factor.bare() for target in targets), np.column_stack(checked), samples=True)


def _seed(seed: Any) -> int:
    """A seed of samples, after a check that it is a whole number."""
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        msg = f"The seed of samples is {shown(seed)}; give a whole number from 0 on."
        raise StudyError(msg)
    return int(seed)


def sampled_factors(points: Any) -> tuple[Factor, ...]:
    """The factors of what samples are made of: a DataFrame, a problem of SALib, or distributions by name.

    Raises
    ------
    StudyError
        If it is something else, or has no factor.
    """
    if is_table(points):
        found = tuple(Factor(str(name), str(name)) for name in points.columns)
    elif is_problem(points):
        found = tuple(Factor(str(name), str(name)) for name in points["names"])
    else:
        found = factors_of([points])
    if not found:
        msg = (
            f'Samples are {shown(points)}, without a factor; give distributions by name, as {{"plant.K_f": "1e4:1e6"}}.'
        )
        raise StudyError(msg)
    return found


def is_table(points: Any) -> bool:
    """Whether points are a DataFrame."""
    return hasattr(points, "columns") and hasattr(points, "to_numpy")


def is_problem(points: Any) -> bool:
    """Whether points are a problem of SALib."""
    return isinstance(points, Mapping) and set(points) >= SALIB_KEYS
