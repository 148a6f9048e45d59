"""The master locates the contact of a bouncing mass, and keeps the order of the error through the bounce."""

import numpy as np
import pytest

from orchestration import Options, Result, simulate
from orchestration.master.algorithm import NEWTON, Algorithm, Correction, StepControl, Tolerance
from orchestration.master.options import Crossings
from tests.reference.problems import wall

STOP = 0.5  # s; contact begins at 0.05 s and ends half a period of 10 rad/s later
CONTACT = (0.05, 0.05 + np.pi / 10)
EXTRAPOLATED = Algorithm("extrapolated", order=1)
CORRECTED = Algorithm("corrected", order=1, correction=Correction(NEWTON, Tolerance(1e-12)))
LEVELS = 5


def bounce(h: float, algorithm: str | Algorithm, tolerance: float | None) -> Result:
    """Run the one-sided wall with the step h, s; locate contact within `tolerance`, s, unless that is None."""
    crossings = Crossings(("wall.gap",), tolerance) if tolerance else Crossings()
    n = round(STOP / h)
    return simulate(wall.system(h, n * h, **wall.BOUNCE), algorithm=algorithm, options=Options(crossings=crossings))


def off_grid(result: Result, h: float) -> np.ndarray:
    """Return the times of rows that are not communication points, s."""
    return result.time[np.abs(result.time / h - np.round(result.time / h)) > 1e-9]


@pytest.mark.parametrize("tolerance", [1e-5, 1e-9])
def test_contact_is_located(tolerance: float) -> None:
    h = 1.9e-3
    result = bounce(h, EXTRAPOLATED, tolerance)
    found = off_grid(result, h)
    assert len(found) == 2
    assert len(result.time) == round(STOP / h) + 3  # all points, and the two events
    # Until contact nothing acts on the mass. x at 0.05 s is off by rounding, which is far below 1e-10 m.
    assert 0 <= found[0] - CONTACT[0] + 1e-12 <= tolerance
    # The mass is released where the coupled motion leaves the wall. Extrapolation misses the part (w h)^2 of w^2, so
    # half of that part of the time of contact, pi / w: 5.7e-5 s.
    assert found[1] == pytest.approx(CONTACT[1], abs=tolerance + np.pi / 20 * (10 * h) ** 2)
    gap = result["wall.gap"][np.isin(result.time, found)]
    assert gap[0] <= 0 < gap[1]
    assert np.abs(gap).max() <= 2 * tolerance  # m at 1 m/s


@pytest.mark.parametrize("algorithm", [EXTRAPOLATED, CORRECTED], ids=["extrapolated", "corrected"])
def test_order_is_kept(algorithm: Algorithm) -> None:
    """With a located contact the order is kept; without location the error depends on where in a step contact falls."""
    steps = 1.94e-3 / 2.0 ** np.arange(LEVELS)

    def errors(tolerance: float | None) -> np.ndarray:
        runs = [bounce(h, algorithm, tolerance) for h in steps]
        return np.array([abs(r["mass.v"][-1] - wall.exact(r.time[-1:], **wall.BOUNCE)["mass.v"][0]) for r in runs])

    located, not_located = errors(1e-9), errors(None)
    order = -np.diff(np.log2(located))
    if algorithm is EXTRAPOLATED:
        # The terms of order 2 of the flights in and out cancel in the speed. 0.08 is that of `test_orders_known`.
        assert (order >= 2 - 0.08).all(), order
        assert np.ptp(order) <= 0.16, order
    else:
        # A force that is linear in time keeps the energy. The error of the location remains: 1e-9 s times a rate of
        # 100/s2 times x near 0.
        assert located.max() <= 1e-8, located
    assert np.ptp(-np.diff(np.log2(not_located))) > 1, not_located
    assert (located[1:] <= 1.5 * not_located[1:]).sum() >= 3


def test_a_controlled_run_locates_too() -> None:
    control = Algorithm("adaptive", order=1, control=StepControl(Tolerance(1e-4)))
    options = Options(crossings=Crossings(("wall.gap",), 1e-9))
    result = simulate(wall.system(1e-3, STOP, **wall.BOUNCE), algorithm=control, options=options)
    assert np.abs(result.time - CONTACT[0]).min() <= 1e-9
    exact = wall.exact(result.time, **wall.BOUNCE)
    assert abs(result["mass.v"][-1] - exact["mass.v"][-1]) <= 1e-4 * 2  # absolute and relative part, at 1 m/s
