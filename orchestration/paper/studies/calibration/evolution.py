"""Covariance matrix adaptation: an evolution strategy that learns which directions of a search are worth their while.

Source: N. Hansen, "The CMA evolution strategy: a tutorial", arXiv:1604.00772 (2016), with the constants of its table 1.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

Costs = Callable[[np.ndarray], Sequence[float]]


@dataclass(frozen=True)
class _Constants:
    """Weights and rates of learning for points of `size` numbers."""

    weights: np.ndarray
    mass: float
    c_sigma: float
    d_sigma: float
    c_c: float
    c_1: float
    c_mu: float
    length: float

    @classmethod
    def of(cls, size: int, offspring: int) -> "_Constants":
        parents = offspring // 2
        raw = np.log((offspring + 1) / 2) - np.log(np.arange(1, parents + 1))
        weights = raw / raw.sum()
        mass = float(1 / (weights**2).sum())
        c_sigma = (mass + 2) / (size + mass + 5)
        c_1 = 2 / ((size + 1.3) ** 2 + mass)
        return cls(
            weights,
            mass,
            c_sigma,
            d_sigma=1 + 2 * max(0.0, np.sqrt((mass - 1) / (size + 1)) - 1) + c_sigma,
            c_c=(4 + mass / size) / (size + 4 + 2 * mass / size),
            c_1=c_1,
            c_mu=min(1 - c_1, 2 * (mass - 2 + 1 / mass) / ((size + 2) ** 2 + mass)),
            length=np.sqrt(size) * (1 - 1 / (4 * size) + 1 / (21 * size**2)),
        )


def minimize(costs: Costs, start: np.ndarray, width: float, *, offspring: int, generations: int, seed: int) -> None:
    """Look for small costs in the unit cube, generation by generation; what was found is the caller's to keep.

    Parameters
    ----------
    costs
        Costs of the points of a generation, shape (offspring, size).
    start, width
        Point to start from, shape (size,), and standard deviation of the first generation around it.
    seed
        Of the random numbers.

    Notes
    -----
    Points that fall outside of the cube are moved to its surface.
    """
    size = len(start)
    constants = _Constants.of(size, offspring)
    random = np.random.default_rng(seed)
    mean, sigma, covariance = start.astype(float), width, np.eye(size)
    path_sigma, path_c = np.zeros(size), np.zeros(size)
    for generation in range(generations):
        values, vectors = np.linalg.eigh(covariance)
        root = vectors * np.sqrt(np.maximum(values, 0))
        points = np.clip(mean + sigma * random.standard_normal((offspring, size)) @ root.T, 0, 1)
        best = np.argsort(np.asarray(costs(points)), kind="stable")[: len(constants.weights)]
        steps = (points[best] - mean) / sigma
        step = constants.weights @ steps
        mean = mean + sigma * step
        white = vectors @ ((vectors.T @ step) / np.sqrt(np.maximum(values, 1e-20)))
        keep = np.sqrt(constants.c_sigma * (2 - constants.c_sigma) * constants.mass)
        path_sigma = (1 - constants.c_sigma) * path_sigma + keep * white
        norm = np.linalg.norm(path_sigma) / np.sqrt(1 - (1 - constants.c_sigma) ** (2 * (generation + 1)))
        moving = norm < (1.4 + 2 / (size + 1)) * constants.length
        gain = np.sqrt(constants.c_c * (2 - constants.c_c) * constants.mass) if moving else 0.0
        path_c = (1 - constants.c_c) * path_c + gain * step
        lost = 0.0 if moving else constants.c_c * (2 - constants.c_c)
        covariance = (
            (1 - constants.c_1 * (1 - lost) - constants.c_mu) * covariance
            + constants.c_1 * np.outer(path_c, path_c)
            + constants.c_mu * (constants.weights * steps.T) @ steps
        )
        sigma *= np.exp(constants.c_sigma / constants.d_sigma * (np.linalg.norm(path_sigma) / constants.length - 1))
