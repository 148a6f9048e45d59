"""Finds the largest error of a function over many arguments."""

from dataclasses import dataclass

import numpy as np
from mpmath import mp, mpf

from tests.property.mathematics.exact import BITS, Judged, error
from tests.property.mathematics.library import Mathematics

CONFIRMED = 1000
"""Arguments of each draw that mpmath judges after numpy's long doubles have chosen them."""
SIGNIFICAND = 63
"""Bits behind the point of long doubles that are worth asking, those of x86."""


@dataclass(frozen=True)
class Worst:
    """The largest error of a function, in units in the last place, and its arguments."""

    error: float
    arguments: tuple[float, ...]


def worst_of(mathematics: Mathematics, name: str, judged: Judged, arguments: np.ndarray) -> Worst:
    """The largest error at arguments of shape (n,) or (n, 2), judged by mpmath."""
    columns = arguments.reshape(len(arguments), -1)
    found = mathematics(name, *columns.T)
    worst = Worst(0.0, ())
    with mp.workprec(BITS):
        for row, value in zip(columns.tolist(), found.tolist(), strict=True):
            off = error(judged.exact(*(mpf(x) for x in row)), value)
            if not off <= worst.error:
                worst = Worst(off, tuple(row))
    return worst


def worst_of_many(mathematics: Mathematics, name: str, judged: Judged, arguments: np.ndarray) -> Worst:
    """The same for many arguments: numpy's long doubles choose those that mpmath judges, where there are any."""
    if np.finfo(np.longdouble).nmant < SIGNIFICAND or not judged.wide:
        return worst_of(mathematics, name, judged, arguments)
    columns = arguments.reshape(len(arguments), -1)
    found = mathematics(name, *columns.T)
    with np.errstate(all="ignore"):
        wide = getattr(np, judged.wide)(*columns.astype(np.longdouble).T)
        rounded = wide.astype(float)
        apart = np.abs(found - wide) / np.spacing(np.abs(rounded))
    too_large = np.isinf(found) & (rounded == found)  # the range of long doubles is wider
    apart = np.where(too_large, 0, np.where(np.isnan(apart), np.inf, apart))
    largest = np.argsort(apart)[-CONFIRMED:]
    return worst_of(mathematics, name, judged, arguments[largest])


def all_draws(judged: Judged, n: int, seed: int) -> np.ndarray:
    """About n arguments of each draw, and those that are known to be hard."""
    rng = np.random.default_rng(seed)
    drawn = [draw(rng, n) for draw in judged.draws]
    return np.concatenate([*drawn, np.array(judged.hard, dtype=float).reshape(-1, *drawn[0].shape[1:])])
