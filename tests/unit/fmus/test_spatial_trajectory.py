"""The virtual trajectory in space: an ellipse in any plane, cut at a wall in any direction, and a tip that tilts."""

from collections.abc import Iterator

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.driver import Driver
from tests.property.samples import EPS
from tests.variant_files import file_of

H, TICKS = 4e-3, 500  # s; one turn of 2 s
ROUNDING = 30 * EPS * 15  # of angles up to 2 pi, times the largest acceleration, as in the plane
CENTER, RPY = np.array([0.4, -0.2, 0.3]), np.array([0.7, -0.4, 1.9])
SEMI_AXIS = np.array([0.3, 0.2])
NORMAL = np.array([0.6, 0.0, 0.8])
ORIENTATION, TILT = np.array([0.1, 0.2, -0.3]), np.array([0.4, -0.5, 0.6])


@pytest.fixture
def trajectory() -> Iterator[Driver]:
    driver = Driver(file_of("VirtualTrajectoryPuma560"))
    yield driver
    driver.close()


def shown(driver: Driver, offset: float) -> np.ndarray:
    """What the FMU shows at its ticks, shape (TICKS, 3, 6): x_v, dx_v, ddx_v."""
    vectors = {
        "center": CENTER, "plane_rpy": RPY, "semi_axis": SEMI_AXIS, "wall_normal": NORMAL, "orientation": ORIENTATION,
        "tilt": TILT,
    }  # fmt: skip
    start = {f"{name}[{i + 1}]": float(value) for name, values in vectors.items() for i, value in enumerate(values)}
    driver.initialize(start | {"wall_offset": offset, "depth": 0.02, "sample_time": H})
    signals = [f"{name}[{i}]" for name in ("x_v", "dx_v", "ddx_v") for i in range(1, 7)]
    rows = []
    for k in range(TICKS):
        driver.step(k * H, H)
        rows.append(driver.get(*signals).reshape(3, 6))
    return np.array(rows)


def ellipse() -> np.ndarray:
    """The whole ellipse with its derivatives, shape (TICKS, 3, 3), by another rotation than the FMU's."""
    w = np.pi
    c, s = np.cos(w * H * np.arange(TICKS)), np.sin(w * H * np.arange(TICKS))
    axes = SEMI_AXIS[:, None] * Rotation.from_euler("xyz", RPY).as_matrix()[:, :2].T
    turns = np.array([[c, s], [-w * s, w * c], [-w * w * c, -w * w * s]]).transpose(2, 0, 1)
    return turns @ axes + np.array([CENTER, np.zeros(3), np.zeros(3)])


def test_the_wall_holds_the_normal_component_only(trajectory: Driver) -> None:
    free, offset = ellipse(), 0.45
    found = shown(trajectory, offset)[:, :, :3]
    straight = free[:, 0] @ NORMAL > offset + 0.02
    assert 50 < straight.sum() < TICKS - 50
    np.testing.assert_allclose(found[~straight], free[~straight], rtol=0, atol=ROUNDING)
    inside = free - (free @ NORMAL)[..., None] * NORMAL
    np.testing.assert_allclose(found - (found @ NORMAL)[..., None] * NORMAL, inside, rtol=0, atol=ROUNDING)
    held = np.broadcast_to([offset + 0.02, 0, 0], (straight.sum(), 3))
    np.testing.assert_allclose((found @ NORMAL)[straight], held, rtol=0, atol=ROUNDING)


def test_the_tip_tilts_and_comes_back(trajectory: Driver) -> None:
    """Angles are those of the start, of the tilt after half a turn, and rates are their derivatives."""
    angles = shown(trajectory, 10.0)[:, :, 3:]
    np.testing.assert_allclose(angles[0], [ORIENTATION, np.zeros(3), TILT * np.pi**2 / 2], rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(angles[TICKS // 2, :2], [ORIENTATION + TILT, np.zeros(3)], rtol=0, atol=ROUNDING)
    for order in (0, 1):
        # Central differences miss H^2 / 6 times the third derivative.
        slope = (angles[2:, order] - angles[:-2, order]) / (2 * H)
        bound = H**2 / 6 * 0.3 * np.pi ** (3 + order) * 1.01
        assert np.abs(slope - angles[1:-1, order + 1]).max() < bound
