"""Evidence for VirtualTrajectoryCorner: the nearest point that is too deep in neither of two walls, and its rates."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import build
from fmus.virtual_trajectory import virtual_trajectory
from orchestration.fmi.codes import Status
from tests.driver import Driver
from tests.property.test_trajectory import ROUNDING, WALLS, H, ellipse, shown

Open = Callable[..., Driver]

DEPTH = 0.01  # m
CORNERS = {
    "right angle": ((-1.0, 0.0), 1.45, (0.0, -1.0), 0.1),
    "blunt": ((-1.0, 0.0), 1.3, (-0.6, -0.8), 0.9),
    "sharp": ((-1.0, 0.0), 0.9, (0.6, -0.8), -0.1),
}


@pytest.fixture(scope="module")
def corner(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU `VirtualTrajectoryCorner`."""
    return build(virtual_trajectory("VirtualTrajectoryCorner", 2), tmp_path_factory.mktemp("trajectory"))


def second_wall(n: tuple[float, float], offset: float) -> dict[str, float]:
    """Start values of the second wall."""
    return {"wall_normal2[1]": n[0], "wall_normal2[2]": n[1], "wall_offset2": offset}


def clipped(driver: Driver, name: str) -> np.ndarray:
    """What the FMU shows at its ticks, shape (SAMPLES, 3, 2): x_v, dx_v, ddx_v."""
    n, offset, n2, offset2 = CORNERS[name]
    driver.set(second_wall(n2, offset2))
    return shown(driver, (n, offset, DEPTH))


def nearest(x: np.ndarray, name: str) -> tuple[np.ndarray, str]:
    """The nearest point of the wedge: of a point itself, its feet on both lines and their meeting, the first inside."""
    n, offset, n2, offset2 = CORNERS[name]
    N, b = np.array([n, n2]), np.array([offset, offset2]) + DEPTH
    feet = {"ellipse": x, "first": x - (N[0] @ x - b[0]) * N[0], "second": x - (N[1] @ x - b[1]) * N[1]}
    feet["corner"] = np.linalg.solve(N, b)
    inside = {place: foot for place, foot in feet.items() if (N @ foot <= b + 1e-12).all()}
    place = min(inside, key=lambda p: float(np.linalg.norm(inside[p] - x)))
    return inside[place], place


@pytest.mark.parametrize("name", CORNERS)
def test_it_is_the_nearest_point_that_is_deep_enough_in_neither_wall(open_fmu: Open, corner: Path, name: str) -> None:
    value, free = clipped(open_fmu(corner), name), ellipse()
    expected = [nearest(x, name) for x in free[:, 0]]
    assert {place for _, place in expected} == {"ellipse", "first", "second", "corner"}
    # A sharp corner divides by 1 - (n1.n2)^2 = 0.64.
    np.testing.assert_allclose(value[:, 0], [point for point, _ in expected], rtol=0, atol=2 * ROUNDING)
    resting = np.array([place == "corner" for _, place in expected])
    np.testing.assert_allclose(value[resting, 1:], 0, rtol=0, atol=2 * ROUNDING)


@pytest.mark.parametrize("name", CORNERS)
def test_rates_are_the_derivatives_of_the_position(open_fmu: Open, corner: Path, name: str) -> None:
    """Central differences over H, where the three samples lie on one piece of the path."""
    value = clipped(open_fmu(corner), name)
    places = np.array([nearest(x, name)[1] for x in ellipse()[:, 0]])
    smooth = (places[2:] == places[1:-1]) & (places[:-2] == places[1:-1])
    for signal, derivative in ((0, 3), (1, 4)):  # truncation as in `test_trajectory`
        difference = (value[2:, signal] - value[:-2, signal]) / (2 * H)
        bound = 1.5 * np.pi**derivative * H**2 / 6 * 1.01
        assert np.abs(difference - value[1:-1, signal + 1])[smooth].max() <= bound


def test_with_a_wall_far_away_it_is_the_trajectory_of_one_wall(open_fmu: Open, corner: Path) -> None:
    slanted = WALLS["slanted"]
    far = open_fmu(corner)
    far.set(second_wall((0.0, -1.0), 100.0))
    np.testing.assert_array_equal(shown(far, slanted), shown(open_fmu("VirtualTrajectory"), slanted))


def test_parallel_walls_are_an_error(open_fmu: Open, corner: Path) -> None:
    driver = open_fmu(corner)
    driver.set(second_wall((1.0, 0.0), 1.45))
    driver.enter()
    assert driver.instance.status("fmi2ExitInitializationMode") == Status.ERROR
    assert any("wall_normal and wall_normal2 must not be parallel" in text for text in driver.messages)
