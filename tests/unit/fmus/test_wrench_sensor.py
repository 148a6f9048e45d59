"""Evidence for ForceSensorPuma560: its frame, noise, filter, zero and weight compensation, by SciPy's rotations."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

from fmus.robots.puma560 import PUMA
from orchestration import System, simulate
from orchestration.fmi.codes import Status
from orchestration.paper.built_fmus import fmus
from tests.driver import Driver
from tests.property.samples import EPS
from tests.variant_files import file_of

TS = 1e-3  # s
GRAVITY = np.array([0.0, 0.0, -9.81])
REFERENCE = Rotation.from_euler("xyz", PUMA.path.reference)
WRENCH = np.array([30.0, -12.0, 55.0, 1.5, -0.7, 2.2])
POSE = (0.4, 0.1, 0.2, 0.3, -0.5, 0.8)  # m, rad
PLACE, TURN = (0.02, -0.05, -0.12), (0.4, -0.3, 1.1)  # m, rad
LENGTH = 0.15  # m


@pytest.fixture(scope="module")
def opened() -> Iterator[Driver]:
    sensor = Driver(file_of("ForceSensorPuma560"))
    yield sensor
    sensor.close()


@pytest.fixture
def sensor(opened: Driver) -> Iterator[Driver]:
    """The sensor, not initialized yet."""
    yield opened
    opened.call("fmi2Reset")


def indexed(**vectors: Sequence[float] | np.ndarray) -> dict[str, float]:
    """Values of the elements of vectors."""
    return {f"{name}[{i + 1}]": float(v) for name, vector in vectors.items() for i, v in enumerate(vector)}


FRAME = indexed(sensor_position=PLACE, sensor_rpy=TURN)


def begin(
    sensor: Driver, values: dict[str, float] | None = None, wrench: np.ndarray = WRENCH, pose: Sequence[float] = POSE
) -> None:
    """Initialize the sensor with start values by name, under a wrench at a pose."""
    sensor.initialize({"sample_time": TS} | indexed(F_ext=wrench, x=pose) | (values or {}))


def reading(sensor: Driver) -> np.ndarray:
    """F_hat."""
    return sensor.get(*(f"F_hat[{i}]" for i in range(1, 7)))


def ticks(sensor: Driver, wrenches: Sequence[np.ndarray], first: int = 0) -> np.ndarray:
    """F_hat at ticks with a wrench each, shape (ticks, 6)."""
    rows = []
    for k, wrench in enumerate(wrenches, first):
        sensor.set(indexed(F_ext=wrench))
        sensor.step(k * TS, TS)
        rows.append(reading(sensor))
    return np.array(rows)


def tip(pose: Sequence[float] = POSE) -> Rotation:
    """Orientation of the tip: SciPy's small letters are turns about fixed axes, one after the other."""
    return Rotation.from_euler("xyz", pose[3:]) * REFERENCE


def felt(wrench: np.ndarray, pose: Sequence[float] = POSE) -> np.ndarray:
    """A wrench at the tip as the sensor at `PLACE` and `TURN` feels it."""
    frame, lever = tip(pose) * Rotation.from_euler("xyz", TURN), tip(pose).apply(PLACE)
    moment = wrench[3:] - np.cross(lever, wrench[:3])
    return np.concatenate([frame.inv().apply(wrench[:3]), frame.inv().apply(moment)])


def at_tip(wrench: np.ndarray, pose: Sequence[float] = POSE) -> np.ndarray:
    """A wrench at the sensor, at the tip in the axes of the base."""
    frame, lever = tip(pose) * Rotation.from_euler("xyz", TURN), tip(pose).apply(PLACE)
    force = frame.apply(wrench[:3])
    return np.concatenate([force, frame.apply(wrench[3:]) + np.cross(lever, force)])


def weight(mass: float, center: Sequence[float], pose: Sequence[float] = POSE) -> np.ndarray:
    """Wrench at the tip that holds a tool at rest."""
    force = -mass * GRAVITY
    return np.concatenate([force, np.cross(tip(pose).apply(center), force)])


# Forces of 70 N and levers of 0.2 m go through two rotations.
ROUNDING = 50 * EPS * 70


@pytest.mark.parametrize("frame", [{}, FRAME], ids=["at the tip", "elsewhere"])
def test_by_default_it_shows_the_wrench_bit_for_bit(sensor: Driver, frame: dict[str, float]) -> None:
    rng = np.random.default_rng(5)
    begin(sensor, frame)
    np.testing.assert_array_equal(reading(sensor), WRENCH)
    for k in range(50):
        wrench, pose = rng.normal(0, 100, 6), rng.uniform(-1.4, 1.4, 6)
        sensor.set(indexed(F_ext=wrench, x=pose))
        sensor.step(k * TS, TS)
        np.testing.assert_array_equal(reading(sensor), wrench)


def test_a_bias_is_one_of_the_sensor_s_axes(sensor: Driver) -> None:
    bias = np.array([1.0, -2.0, 3.0, 0.1, 0.2, -0.3])
    begin(sensor, FRAME | indexed(bias=bias))
    np.testing.assert_allclose(reading(sensor), WRENCH + at_tip(bias), rtol=0, atol=ROUNDING)


def test_range_and_resolution_are_those_of_the_sensor_s_axes(sensor: Driver) -> None:
    limits = {"range": 40.0, "resolution": 0.5, "moment_range": 3.0, "moment_resolution": 0.01}
    begin(sensor, FRAME | limits)
    inside = felt(WRENCH)
    span, step = np.array([40.0] * 3 + [3.0] * 3), np.array([0.5] * 3 + [0.01] * 3)
    expected = np.floor(np.clip(inside, -span, span) / step + 0.5) * step
    assert (np.abs(inside) > span).any()
    np.testing.assert_allclose(felt(reading(sensor)), expected, rtol=0, atol=ROUNDING)


def draws(seed: int, n: int, std: float, bound: float) -> np.ndarray:
    """The noise of tick n in the axes of the sensor by NumPy's generator: three pairs within bound / sqrt(3)."""
    words = np.random.Philox(key=seed, counter=(n - 1) % 2**256).random_raw(4)
    u = [(int(word) >> 11) * 2.0**-53 + 2.0**-54 for word in words]
    u += [value * 2.0**26 % 1.0 for value in u]
    part = bound / np.sqrt(3)
    pairs = []
    for k in range(3):
        r = std * np.sqrt(-2 * np.log1p(u[2 * k] * np.expm1(-((part / std) ** 2) / 2)))
        pairs += [r * np.cos(2 * np.pi * u[2 * k + 1]), r * np.sin(2 * np.pi * u[2 * k + 1])]
    return np.array(pairs) * [1, 1, 1, LENGTH, LENGTH, LENGTH]


def norms(wrenches: np.ndarray) -> np.ndarray:
    """Norm of (f, m / L), N, of each row."""
    return np.linalg.norm(wrenches / np.array([1, 1, 1, LENGTH, LENGTH, LENGTH]), axis=1)


def test_the_noise_is_drawn_and_bounded_in_the_sensor_s_axes(sensor: Driver) -> None:
    """At the tip its norm may be larger, by a factor that follows from the lever."""
    std, bound = 8.0, 15.0
    begin(sensor, FRAME | {"noise_std": std, "noise_bound": bound, "seed": 7})
    errors = ticks(sensor, [WRENCH] * 3000) - WRENCH
    inside = np.array([felt(error) for error in errors])
    expected = [draws(7, n, std, bound) for n in range(3000)]
    # u * 2^26 has lost nothing; a turn of 2 pi u with an error of EPS u, and a radius of 9 N.
    np.testing.assert_allclose(inside, expected, rtol=0, atol=20 * ROUNDING)
    assert 0.9 * bound < norms(inside).max() <= bound * (1 + 1e-12)
    s = np.linalg.norm(PLACE) / LENGTH
    factor = (s + np.sqrt(s**2 + 4)) / 2
    assert factor < 1 + s
    assert bound < norms(errors).max() <= factor * bound


def test_the_factor_of_the_docstring_is_the_norm_of_the_shift() -> None:
    """No lever of this length makes more of an error in the norm of (f, m / L), and one error reaches it."""
    s = np.linalg.norm(PLACE) / LENGTH
    scale = np.diag([1, 1, 1, 1 / LENGTH, 1 / LENGTH, 1 / LENGTH])
    shift = np.stack([at_tip(unit) for unit in np.eye(6)], axis=1)
    norm = np.linalg.norm(scale @ shift @ np.linalg.inv(scale), 2)
    assert norm == pytest.approx((s + np.sqrt(s**2 + 4)) / 2, rel=1e-14)


def test_there_is_no_noise_without_contact(sensor: Driver) -> None:
    begin(sensor, {"noise_std": 5.0, "noise_bound": 15.0}, np.zeros(6))
    found = ticks(sensor, [np.zeros(6), np.array([0, 0, 0, 0, 1e-9, 0.0])])
    np.testing.assert_array_equal(found[0], np.zeros(6))
    assert (found[1] != 0).all()


def test_the_filter_is_of_first_order_and_begins_settled(sensor: Driver) -> None:
    wrenches = np.random.default_rng(2).normal(0, 20, (200, 6))
    begin(sensor, FRAME | {"filter_time": 0.01}, wrenches[0])
    found = ticks(sensor, list(wrenches))
    share = 1 - np.exp(-TS / 0.01)
    settled = wrenches[:1] * (1 - share)
    expected, _ = lfilter([share], [1, share - 1], wrenches, axis=0, zi=settled)
    np.testing.assert_allclose(found, expected, rtol=0, atol=200 * ROUNDING)


def test_the_filter_turns_with_the_sensor(sensor: Driver) -> None:
    """A wrench that turns with the tip is constant in the axes of the sensor, so that the filter does not change it."""
    bias, other = np.array([5.0, 1.0, -2.0, 0.3, 0.0, 0.1]), (0.4, 0.1, 0.2, -0.4, 0.6, -0.9)
    begin(sensor, FRAME | indexed(bias=bias) | {"filter_time": 1.0}, np.zeros(6))
    np.testing.assert_allclose(reading(sensor), at_tip(bias), rtol=0, atol=ROUNDING)
    sensor.set(indexed(x=other))
    sensor.step(0.0, TS)
    np.testing.assert_allclose(reading(sensor), at_tip(bias, other), rtol=0, atol=ROUNDING)


def test_the_filter_keeps_the_bound_of_the_noise(sensor: Driver) -> None:
    begin(sensor, FRAME | {"noise_std": 8.0, "noise_bound": 15.0, "seed": 3, "filter_time": 3 * TS})
    inside = np.array([felt(error) for error in ticks(sensor, [WRENCH] * 1000) - WRENCH])
    assert 5 < norms(inside).max() < 15


def test_a_zero_takes_off_what_was_read_in_any_orientation_thereafter(sensor: Driver) -> None:
    bias, other = np.array([5.0, 1.0, -2.0, 0.3, 0.0, 0.1]), (0.4, 0.1, 0.2, -0.4, 0.6, -0.9)
    begin(sensor, FRAME | indexed(bias=bias), np.zeros(6))
    sensor.set({"zero": True})
    np.testing.assert_allclose(ticks(sensor, [np.zeros(6), WRENCH]), 0, rtol=0, atol=ROUNDING)
    sensor.set({"zero": False})
    # The wrench of the last tick with zero is in the zero, too.
    np.testing.assert_allclose(ticks(sensor, [np.zeros(6)], 2)[0], -WRENCH, rtol=0, atol=ROUNDING)
    sensor.set({"zero": True})
    ticks(sensor, [np.zeros(6)], 3)
    sensor.set({"zero": False} | indexed(x=other))
    np.testing.assert_allclose(ticks(sensor, [WRENCH], 4)[0], WRENCH, rtol=0, atol=ROUNDING)


def test_the_zero_comes_after_the_filter(sensor: Driver) -> None:
    """The zero is the filtered reading, so that F_hat begins at 0 and rises by what the filter still has to follow."""
    begin(sensor, {"filter_time": 0.01}, np.zeros(6))
    ticks(sensor, [np.zeros(6), *[WRENCH] * 5])
    sensor.set({"zero": True})
    np.testing.assert_allclose(ticks(sensor, [WRENCH], 6), 0, rtol=0, atol=ROUNDING)
    sensor.set({"zero": False})
    left = np.exp(-6 * TS / 0.01)
    found = ticks(sensor, [WRENCH] * 100, 7)
    np.testing.assert_allclose(found[0], left * (1 - np.exp(-TS / 0.01)) * WRENCH, rtol=1e-12)
    np.testing.assert_allclose(found[-1], left * WRENCH, rtol=1e-3)  # exp(-10) is left


def test_the_weight_of_a_tool_at_rest_is_not_felt(sensor: Driver) -> None:
    mass, center = 1.3, (0.03, -0.02, 0.09)
    begin(sensor, FRAME | {"tool_mass": mass} | indexed(tool_center=center), WRENCH + weight(mass, center))
    np.testing.assert_allclose(reading(sensor), WRENCH, rtol=0, atol=ROUNDING)
    for k, pose in enumerate(np.random.default_rng(8).uniform(-1.4, 1.4, (20, 6))):
        sensor.set(indexed(F_ext=weight(mass, center, tuple(pose)), x=pose))
        sensor.step(k * TS, TS)
        np.testing.assert_allclose(reading(sensor), np.zeros(6), rtol=0, atol=ROUNDING)


def test_the_range_limits_the_weight_too(sensor: Driver) -> None:
    """The hardware reads the weight, which is taken off afterwards: a sensor at its limit shows the limit less it."""
    mass = 2.0
    begin(sensor, {"tool_mass": mass, "range": 30.0}, np.array([0.0, 0.0, 50.0, 0, 0, 0]), (0.0,) * 6)
    np.testing.assert_allclose(reading(sensor)[:3], [0, 0, 30.0 - mass * 9.81], rtol=0, atol=ROUNDING)


def test_a_noise_without_a_bound_is_refused(sensor: Driver) -> None:
    sensor.set({"noise_std": 1.0})
    sensor.enter()
    assert sensor.instance.status("fmi2ExitInitializationMode") == Status.ERROR
    assert any("noise_bound must be positive where noise_std is" in text for text in sensor.messages)


def test_in_the_loop_it_feels_the_inertia_of_the_payload_alone() -> None:
    """Connected to F_wrist, with the payload as its tool, F_hat is F_ext and what accelerates the payload."""
    names = ("VirtualTrajectory", "ForceSensor", "HoganImpedance", "Actuator", "Plant")
    files = fmus(f"{name}Puma560" for name in names)
    parts = zip(("trajectory", "sensor", "controller", "actuator", "plant"), files.values(), strict=True)
    system = System.connected_by_name("puma", dict(parts), step=1e-4, stop_time=0.02)
    body = PUMA.payload
    tool = {"sensor.tool_mass": body.mass} | {f"sensor.{k}": v for k, v in indexed(tool_center=body.center).items()}
    wired = [c for c in system.connections if (c.target, c.output[:5]) != ("sensor", "F_ext")]
    made = simulate(replace(system, connections=tuple(wired)).connect("plant.F_wrist -> sensor.F_ext").set(tool))
    F_hat, F_ext, x = made["sensor.F_hat"], made["plant.F_ext"], made["plant.x"]
    for k in (0, 50, 199):  # a row shows the reading of the row before
        inertia = made["plant.F_wrist"][k] - F_ext[k] - weight(body.mass, body.center, tuple(x[k]))
        np.testing.assert_allclose(F_hat[k + 1], F_ext[k] + inertia, rtol=0, atol=ROUNDING)
        assert 0.1 < np.abs(inertia).max()
