"""What tests ask of every variant of the catalog, and of a plant, a trajectory and controllers that belong together."""

from collections.abc import Callable, Iterable, Sequence
from itertools import count, takewhile

import numpy as np

from tests.driver import Driver
from tests.unit.fmus.test_start import PRINTED, starts

Open = Callable[[str], Driver]
TS = 1e-4  # s
SIGNALS = ("q", "dq", "ddq", "x_v", "dx_v", "ddx_v")
"""What controllers start with."""


def vector(values: dict[str, float], name: str) -> np.ndarray:
    """The elements of a vector, from 1 on."""
    return np.array([values[key] for key in takewhile(values.__contains__, (f"{name}[{i}]" for i in count(1)))])


def require_finite_outputs(driver: Driver) -> None:
    """Step an FMU three times; its outputs must be finite, and it must have nothing to say."""
    driver.initialize()
    for k in range(3):
        driver.step(k * TS, TS)
        assert all(np.isfinite(value) for value in driver.outputs().values())
    assert not driver.messages


def require_one_start(
    open_variant: Open, places: Sequence[str], controllers: Iterable[str], tolerance: float, signals: Sequence[str]
) -> None:
    """Demand that a tip starts on its trajectory, and that controllers start with what both show.

    Parameters
    ----------
    places
        The plant and the trajectory.
    tolerance
        By which start values of controllers, which are printed, may be off.
    signals
        Those of `SIGNALS` that are compared.
    """
    shown: dict[str, float] = {}
    for name in places:
        driver = open_variant(name)
        driver.initialize()
        shown |= driver.outputs()
    assert vector(shown, "x").size >= 3
    for one, other in (("x", "x_v"), ("dx", "dx_v")):
        np.testing.assert_allclose(vector(shown, one), vector(shown, other), rtol=0, atol=PRINTED)
    for name in controllers:
        inputs = starts(open_variant(name))
        for signal in signals:
            np.testing.assert_allclose(vector(inputs, signal), vector(shown, signal), rtol=0, atol=tolerance)
