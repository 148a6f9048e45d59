"""Evidence for VirtualTrajectory: an ellipse, its component along the wall's normal held in the straight segment."""

from collections.abc import Callable

import numpy as np
import pytest

from orchestration.fmi.codes import Status
from tests.driver import Driver
from tests.property.samples import EPS

Wall = tuple[tuple[float, float], float, float]  # normal, offset and depth

H, SAMPLES = 2e-3, 1000
WALLS: dict[str, Wall] = {
    "paper": ((-1.0, 0.0), 1.45, 0.01),
    "floor": ((0.0, -1.0), 0.7, 0.02),
    "slanted": ((0.6, 0.8), 0.9, 0.015),
    "before the wall": ((-0.28, 0.96), 0.8, -0.03),
}
SIGNALS = [f"{name}[{i}]" for name in ("x_v", "dx_v", "ddx_v") for i in (1, 2)]
# Angles up to 2 pi round to EPS * 2 pi, the rest to a few EPS, all times at most semi-axis * rate^2 = 15 m/s2.
ROUNDING = 30 * EPS * 15


def shown(driver: Driver, wall: Wall, shape: tuple[float, float, float] = (1.5, 1.0, 2.0)) -> np.ndarray:
    """What the FMU shows at its ticks, shape (SAMPLES, 3, 2): x_v, dx_v, ddx_v."""
    (n1, n2), offset, depth = wall
    start = {"wall_normal[1]": n1, "wall_normal[2]": n2, "wall_offset": offset, "depth": depth}
    start |= {"semi_axis[1]": shape[0], "semi_axis[2]": shape[1], "period": shape[2], "sample_time": H}
    driver.initialize(start)
    rows = []
    for k in range(SAMPLES):
        driver.step(k * H, H)  # its tick, at k H, holds until the next
        rows.append(driver.get(*SIGNALS).reshape(3, 2))
    return np.array(rows)


def ellipse(shape: tuple[float, float, float] = (1.5, 1.0, 2.0)) -> np.ndarray:
    """The ellipse at the ticks, shape (SAMPLES, 3, 2)."""
    w = 2 * np.pi / shape[2]
    t = H * np.arange(SAMPLES)
    c, s = np.cos(w * t), np.sin(w * t)
    return np.array([[c, s], [-w * s, w * c], [-w * w * c, -w * w * s]]).transpose(2, 0, 1) * np.array(shape[:2])


def frame(wall: str) -> tuple[np.ndarray, np.ndarray, float]:
    """Normal, tangent and the distance at which the straight segment lies."""
    n, offset, depth = WALLS[wall]
    return np.array(n), np.array([-n[1], n[0]]), offset + depth


@pytest.mark.parametrize("wall", WALLS)
def test_straight_segment_holds_the_normal_component_only(open_fmu: Callable[..., Driver], wall: str) -> None:
    value, free, (n, t, distance) = shown(open_fmu("VirtualTrajectory"), WALLS[wall]), ellipse(), frame(wall)
    straight = free[:, 0] @ n > distance
    assert 50 < straight.sum() < SAMPLES - 50
    np.testing.assert_allclose(value[~straight], free[~straight], rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(value @ t, free @ t, rtol=0, atol=ROUNDING)
    held = np.broadcast_to([distance, 0, 0], (straight.sum(), 3))
    np.testing.assert_allclose(value[straight] @ n, held, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("wall", WALLS)
def test_rates_are_the_derivatives_of_the_position(open_fmu: Callable[..., Driver], wall: str) -> None:
    """Central differences over H, where the three samples lie on one side of a corner."""
    value, (n, _, distance) = shown(open_fmu("VirtualTrajectory"), WALLS[wall]), frame(wall)
    straight = ellipse()[:, 0] @ n > distance
    smooth = (straight[2:] == straight[1:-1]) & (straight[:-2] == straight[1:-1])
    assert smooth.sum() > SAMPLES - 10
    # Truncation H^2/6 times the third derivative of the differenced signal, at most 1.5 pi^3 and 1.5 pi^4.
    for signal, derivative in ((0, 3), (1, 4)):
        difference = (value[2:, signal] - value[:-2, signal]) / (2 * H)
        bound = 1.5 * np.pi**derivative * H**2 / 6 * 1.01
        assert np.abs(difference - value[1:-1, signal + 1])[smooth].max() <= bound


def test_without_a_wall_in_reach_it_is_the_whole_ellipse(open_fmu: Callable[..., Driver]) -> None:
    shape = (0.8, 0.3, 0.7)  # nearest edge of the wall at 1.46 m
    value = shown(open_fmu("VirtualTrajectory"), WALLS["paper"], shape)
    w = 2 * np.pi / shape[2]
    # Angles up to 18 rad and rates up to w^2 * 0.8.
    np.testing.assert_allclose(value, ellipse(shape), rtol=0, atol=30 * EPS * 0.8 * w**2)


def test_a_normal_of_another_length_is_an_error(open_fmu: Callable[..., Driver]) -> None:
    driver = open_fmu("VirtualTrajectory")
    driver.set({"wall_normal[1]": -1.001})
    driver.enter()
    assert driver.instance.status("fmi2ExitInitializationMode") == Status.ERROR
    assert any("wall_normal must have length 1" in text for text in driver.messages)
