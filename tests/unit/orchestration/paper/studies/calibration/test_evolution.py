"""The evolution strategy finds the minimum of functions that are known, and always the same way."""

import numpy as np

from orchestration.paper.studies.calibration.evolution import minimize

SIZE = 6
MIDDLE = np.linspace(0.2, 0.8, SIZE)
SCALES = np.logspace(0, 3, SIZE)  # the valley is a thousand times longer than it is wide


def valley(points: np.ndarray) -> list[float]:
    """A quadratic function whose axes are turned against those of the cube."""
    turned = np.linalg.qr(np.random.default_rng(5).standard_normal((SIZE, SIZE)))[0]
    return (((points - MIDDLE) @ turned) ** 2 @ SCALES).tolist()


def course(generations: int, seed: int) -> list[float]:
    """The least cost of each generation."""
    found: list[float] = []

    def costs(points: np.ndarray) -> list[float]:
        assert points.shape == (12, SIZE)
        assert points.min() >= 0
        assert points.max() <= 1
        values = valley(points)
        found.append(min(values))
        return values

    minimize(costs, np.full(SIZE, 0.5), 0.2, offspring=12, generations=generations, seed=seed)
    return found


def test_it_learns_the_shape_of_a_turned_valley() -> None:
    found = course(150, seed=1)
    assert len(found) == 150
    # Without a covariance of its own, a strategy of this size needs some thousand generations for a ratio of 1,000.
    assert found[-1] < 1e-8 * found[0]


def test_a_seed_gives_one_course() -> None:
    assert course(5, seed=7) == course(5, seed=7)
    assert course(5, seed=7) != course(5, seed=8)


def test_a_minimum_outside_is_found_on_the_surface() -> None:
    found: list[np.ndarray] = []

    def costs(points: np.ndarray) -> list[float]:
        found.append(points)
        return ((points + 0.5) ** 2).sum(axis=1).tolist()

    minimize(costs, np.full(SIZE, 0.3), 0.2, offspring=12, generations=30, seed=1)
    assert (found[-1].min(axis=0) == 0).all()
