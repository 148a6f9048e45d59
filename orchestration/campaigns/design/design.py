"""The points of a study: blocks of levels and samples, each combined with all others.

Runs are numbered 0, 1, ...: the variant of the system changes slowest, then the first block, and the last block changes
fastest. A block of a grid is one factor with its levels. A block of samples has several factors, whose values belong
together row by row.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orchestration.campaigns.design.factor import Factor, Target
from orchestration.campaigns.engines.engine import Points
from orchestration.errors import StudyError

MOST_RUNS = 100_000_000
"""A table of so many runs takes gigabytes."""


@dataclass(frozen=True, eq=False)
class Block:
    """Factors whose values belong together row by row.

    Attributes
    ----------
    factors
        Factors, without their values.
    values
        Numbers, float64, shape (n, n_factors).
    samples
        Whether the rows are samples, not the levels of a grid.
    """

    factors: tuple[Factor, ...]
    values: np.ndarray
    samples: bool = False


@dataclass(frozen=True, eq=False)
class Design:
    """All points of a study.

    Attributes
    ----------
    variants
        Names of the variants of the system.
    blocks
        Blocks in their order.
    """

    variants: tuple[str, ...]
    blocks: tuple[Block, ...] = ()

    @cached_property
    def factors(self) -> tuple[Factor, ...]:
        """All factors in their order, without the variants."""
        return tuple(factor for block in self.blocks for factor in block.factors)

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of variants, and number of rows of each block."""
        return (len(self.variants), *(len(block.values) for block in self.blocks))

    @property
    def sampled(self) -> bool:
        """Whether there are samples, so that the points are no grid."""
        return any(block.samples for block in self.blocks)

    def __len__(self) -> int:
        """Number of runs."""
        return math.prod(self.sizes)

    def with_block(self, block: Block) -> "Design":
        """The design with each of its points combined with each row of a block.

        Raises
        ------
        StudyError
            If a factor is there twice, or the design has more than `MOST_RUNS` runs.
        """
        known = {factor.name for factor in self.factors}
        for factor in block.factors:
            if factor.name in known:
                msg = f"Factor {factor.name} is given twice; give each factor once."
                raise StudyError(msg)
            known.add(factor.name)
        found = Design(self.variants, (*self.blocks, block))
        if math.prod(found.sizes) > MOST_RUNS:
            advice = "give fewer levels, or samples"
            msg = f"The design has {math.prod(found.sizes)} runs; at most {MOST_RUNS} are possible; {advice}."
            raise StudyError(msg)
        return found

    def values(self, numbers: np.ndarray) -> np.ndarray:
        """Values of all factors in some runs, float64, shape (n, n_factors)."""
        places = np.unravel_index(numbers, self.sizes)[1:]
        columns = [block.values[rows] for block, rows in zip(self.blocks, places, strict=True)]
        return np.concatenate(columns, axis=1) if columns else np.empty((len(numbers), 0))

    def variant_numbers(self, numbers: np.ndarray) -> np.ndarray:
        """Numbers of the variants of some runs, int64, shape (n,)."""
        return numbers // (len(self) // len(self.variants))


Pointing = Callable[[np.ndarray, np.ndarray], Points]
"""Makes points of numbers of runs, shape (n,), and values of the factors, shape (n, n_factors)."""


def pointing(targets: Sequence[Target], step: float | None) -> tuple[tuple[str, ...], Pointing]:
    """How factors set start values and the communication step.

    Parameters
    ----------
    targets
        What each factor sets.
    step
        Communication step of runs whose step is no factor, s.

    Returns
    -------
    tuple
        The varied start values; and a function that makes `Points` of numbers of runs and values of the factors.

    Raises
    ------
    StudyError
        If two factors set the same start value.
    """
    varied: dict[str, int] = {}
    for place, target in enumerate(targets):
        for path in target.paths:
            if path in varied:
                raise _both(targets[varied[path]], target, path)
            varied[path] = place
    stepping = [place for place, target in enumerate(targets) if target.sets_step]
    if len(stepping) > 1:
        raise _both(targets[stepping[0]], targets[stepping[1]], "the communication step")
    columns = np.array(list(varied.values()), dtype=np.int64)

    def points(numbers: np.ndarray, values: np.ndarray) -> Points:
        steps = values[:, stepping[0]] if stepping else np.full(len(numbers), np.nan if step is None else step)
        return Points(numbers, np.ascontiguousarray(values[:, columns]), np.ascontiguousarray(steps))

    return tuple(varied), points


def _both(first: Target, second: Target, what: str) -> StudyError:
    names = f"{first.factor.name} and {second.factor.name}"
    return StudyError(f"Factors {names} both set {what}; leave one of them out.")
