"""FMUs of a task of position and angle: rules and loop; start values, units, noise, trajectory, what is refused."""

from collections.abc import Callable

import numpy as np
import pytest

from adaptimp_fmu import DefinitionError
from fmus import start
from fmus.catalog import VARIANTS
from fmus.craig_adaptive_impedance import craig_adaptive_impedance
from fmus.hogan_impedance import hogan_impedance
from fmus.plant import plant
from fmus.robots.planar_robot import PlanarRobot
from fmus.slotine_li_adaptive_impedance import slotine_li_adaptive_impedance
from fmus.spong_ortega_adaptive_impedance import spong_ortega_adaptive_impedance
from orchestration.check import Severity
from orchestration.paper.closed_loop import paper_loop
from tests.driver import Driver
from tests.property.samples import EPS
from tests.unit.fmus.test_controllers import require_refused
from tests.unit.fmus.test_start import PRINTED, starts
from tests.unit.fmus.variants import SIGNALS, TS, Open, require_finite_outputs, require_one_start, vector
from tests.unit.orchestration.checked import check
from tests.variant_files import file_of

POSE = [name for name in VARIANTS if name.endswith("Pose")]
ADAPTIVE = [name for name in POSE if "Adaptive" in name]
ROBUST = [name for name in ADAPTIVE if "Slotine" not in name]
REDUNDANT = PlanarRobot(3)


@pytest.mark.parametrize("name", POSE)
def test_a_variant_breaks_no_rule_and_shows_finite_outputs(open_variant: Open, name: str) -> None:
    """The loop is tried with one controller of each law's kind, since a ride takes its time."""
    report = check(file_of(name), loop=paper_loop if "Craig" in name else None)
    assert [finding for finding in report.findings if finding.severity is not Severity.NOTE] == []
    assert report.role is not None
    assert any(fact.startswith("Closed loop") for fact in report.facts) == ("Craig" in name)
    require_finite_outputs(open_variant(name))


def test_plant_trajectory_and_controllers_start_at_one_place(open_variant: Open) -> None:
    controllers = [name for name in POSE if "Impedance" in name]
    places = ("Plant3RPose", "VirtualTrajectoryPose")
    exact = [signal for signal in SIGNALS if signal != "ddq"]
    require_one_start(open_variant, places, controllers, 0.0, exact)
    require_one_start(open_variant, places, controllers, PRINTED, ["ddq"])
    for name in controllers:
        masses = vector(starts(open_variant(name)), "p_start")[:3]
        np.testing.assert_array_equal(masses, start.POSE_ARM.masses)


def test_the_wrist_stays_within_reach_along_the_whole_ellipse() -> None:
    """The comment of `start.POSE_ARM`: 0.96 m to 1.8 m of at most 2 m, so that the arm is never near a singular one."""
    angle = np.linspace(0, 2 * np.pi, 10_001)
    x = np.maximum(start.SEMI_AXIS[0] * np.cos(angle), -(start.WALL_OFFSET + 0.01))
    hand = start.POSE_ARM.link_lengths[2] * np.array([np.cos(start.ORIENTATION), np.sin(start.ORIENTATION)])
    reach = np.hypot(x - hand[0], start.SEMI_AXIS[1] * np.sin(angle) - hand[1])
    assert 0.96 < reach.min() < reach.max() == pytest.approx(1.8)
    assert sum(start.POSE_ARM.link_lengths[:2]) == 2.0


@pytest.mark.parametrize("name", ADAPTIVE)
def test_elements_of_an_angle_have_its_units(open_variant: Open, name: str) -> None:
    variables = open_variant(name).variables
    expected = {
        "x_v": "rad",
        "dx_v": "rad/s",
        "F_hat": "N.m",
        "M": "kg.m2",
        "B": "N.m.s/rad",
        "K": "N.m/rad",
        "e": "rad",
    }
    expected |= {"K_d": "N.m.s/rad", "s": "rad/s"} if name not in ROBUST else {"e_star": "rad/s", "F_c": "N.m"}
    assert {base: variables[f"{base}[3]"].unit for base in expected} == expected
    assert variables["F_hat[2]"].unit == "N"
    assert variables["L"].unit == "m"
    assert variables["x_v[3]"].description == "Virtual angle of the tip about x3 (out of the plane)"
    # The gain of a parameter has the unit that it has for two joints: norms are in one unit.
    assert variables["Gamma[3]"].unit == ("kg2.s2/m2" if name in ROBUST else "kg.s2/m2")
    assert [variables[f"Gamma[{i + 1}]"].start != 0 for i in range(9)] == [i == 2 for i in range(9)]


def test_the_conventional_law_and_the_plant_need_no_length(open_variant: Open) -> None:
    assert "L" not in open_variant("HoganImpedance3RPose").variables
    assert "L" not in open_variant("Plant3RPose").variables


@pytest.mark.parametrize("name", ROBUST)
def test_the_length_decides_how_much_an_angle_counts(open_variant: Open, name: str) -> None:
    """An angle off by 1 mrad alone: e* is 0.1 rad/s by Psi = 100 1/s, beta L times that."""
    betas = []
    for length in (0.15, 0.6):
        driver = open_variant(name)
        q3 = start.POSE_ARM.q[2]
        values = {"q[3]": q3 + 1e-3, "L": length, "noise_bound": 90.0, "F_hat[3]": 3.0}
        # The tip moves on a circle about the wrist, so x and dx change, too: the TIRT starts at x_v, and e is x - x_v.
        driver.initialize(values)
        e_star = driver.get("e_star[1]", "e_star[2]", "e_star[3]")
        scaled = e_star * np.array([1, 1, length])
        beta, gamma = driver.get("beta", "gamma")
        assert beta == pytest.approx(np.linalg.norm(scaled), rel=1e-14)
        assert gamma > 0
        betas.append(beta)
    assert betas[1] > 1.2 * betas[0]


@pytest.mark.parametrize("name", ROBUST)
def test_a_moment_beyond_the_threshold_switches_the_noise_bound_on(open_variant: Open, name: str) -> None:
    """3 N.m are 20 N at L = 0.15 m."""
    seen = []
    for threshold in (19.9, 20.1):
        driver = open_variant(name)
        driver.initialize({"F_hat[3]": 3.0, "noise_bound": 90.0, "contact_threshold": threshold, "q[3]": 2.69})
        seen.append(driver.get("gamma")[0] > 0)
    assert seen == [True, False]


@pytest.mark.parametrize("name", [n for n in POSE if "Impedance" in n])
def test_a_stretched_arm_is_refused(open_variant: Open, name: str) -> None:
    """The hand's angle does not matter, the elbow's does."""
    require_refused(open_variant(name), {"q[2]": 0.0}, "The arm is singular")
    open_variant(name).initialize({"q[3]": 0.0})


STD, BOUND, LENGTH = 5.0, 15.0, 0.2  # N, N, m
FORCE = np.array([300.0, -40.0, 5.0])  # N, N, N.m


def noise(open_variant: Open, ticks: int, **more: float) -> np.ndarray:
    """Errors of the sensor at its first ticks, N and N.m, shape (ticks, 3)."""
    sensor = open_variant("ForceSensorPose")
    given = {f"F_ext[{i + 1}]": value for i, value in enumerate(FORCE)}
    sensor.initialize({"noise_std": STD, "noise_bound": BOUND, "L": LENGTH, "seed": 7, **given, **more})
    rows = []
    for k in range(ticks):
        sensor.step(k * TS, TS)
        rows.append(sensor.get("F_hat[1]", "F_hat[2]", "F_hat[3]") - FORCE)
    return np.array(rows)


def test_the_noise_is_drawn_in_pairs_within_one_bound(open_variant: Open) -> None:
    """NumPy's generator gives the same: two words for the force, two for the moment."""
    bound, expected = BOUND / np.sqrt(2), []
    for n in range(500):
        words = np.random.Philox(key=7, counter=(n - 1) % 2**256).random_raw(4)
        u = [(int(word) >> 11) * 2.0**-53 + 2.0**-54 for word in words]
        r = [STD * np.sqrt(-2 * np.log1p(u[k] * np.expm1(-((bound / STD) ** 2) / 2))) for k in (0, 2)]
        turns = [2 * np.pi * u[k] for k in (1, 3)]
        expected.append([r[0] * np.cos(turns[0]), r[0] * np.sin(turns[0]), LENGTH * r[1] * np.cos(turns[1])])
    shown = noise(open_variant, 500)
    # The force is added and taken off again, as in tests/unit/fmus/test_force_sensor.py.
    np.testing.assert_allclose(shown, expected, rtol=0, atol=4 * EPS * 300)
    lengths = np.linalg.norm(shown / [1, 1, LENGTH], axis=1)
    assert bound < lengths.max() <= BOUND


def test_moments_have_a_range_and_a_resolution_of_their_own(open_variant: Open) -> None:
    coarse = noise(open_variant, 20, noise_std=0.0, resolution=7.0, moment_resolution=0.3) + FORCE
    np.testing.assert_allclose(coarse[0], [301.0, -42.0, 5.1], rtol=0, atol=1e-12)
    clipped = noise(open_variant, 1, noise_std=0.0, range=100.0, moment_range=2.0) + FORCE
    np.testing.assert_array_equal(clipped[0], [100.0, -40.0, 2.0])


def test_there_is_no_noise_without_contact(open_variant: Open) -> None:
    sensor = open_variant("ForceSensorPose")
    sensor.initialize({"noise_std": STD, "noise_bound": BOUND})
    sensor.step(0, TS)
    np.testing.assert_array_equal(sensor.get("F_hat[1]", "F_hat[2]", "F_hat[3]"), np.zeros(3))
    sensor.set({"F_ext[3]": 1.0})  # a moment alone is a contact, too
    sensor.step(TS, TS)
    assert (sensor.get("F_hat[1]", "F_hat[2]") != 0).all()


def test_the_trajectory_holds_its_angle_and_is_the_ellipse_of_two_coordinates(
    open_variant: Open, open_fmu: Callable[..., Driver]
) -> None:
    both = open_variant("VirtualTrajectoryPose"), open_fmu("VirtualTrajectory")
    for driver, more in zip(both, ({"orientation": 2.0}, {}), strict=True):
        driver.initialize({"sample_time": 0.01, **more})
    for k in range(200):
        for driver in both:
            driver.step(0.01 * k, 0.01)
        for name in ("x_v", "dx_v", "ddx_v"):
            pair = [f"{name}[1]", f"{name}[2]"]
            np.testing.assert_array_equal(both[0].get(*pair), both[1].get(*pair))
        np.testing.assert_array_equal(both[0].get("x_v[3]", "dx_v[3]", "ddx_v[3]"), [2.0, 0.0, 0.0])


@pytest.mark.parametrize("declare", [craig_adaptive_impedance, spong_ortega_adaptive_impedance])
def test_algorithm_1_refuses_a_redundant_arm(declare: Callable) -> None:
    sentence = r"^Mine: algorithm 1 needs as many joints as task coordinates, .* has 3 joints and 2 task coordinates"
    with pytest.raises(DefinitionError, match=sentence):
        declare("Mine", REDUNDANT)


@pytest.mark.parametrize(
    "declare", [craig_adaptive_impedance, slotine_li_adaptive_impedance, spong_ortega_adaptive_impedance]
)
def test_adaptive_laws_refuse_full_gains_of_angles(declare: Callable) -> None:
    with pytest.raises(
        DefinitionError, match=r"^Mine: full gains are for tasks of positions, .* 1 of 3 coordinates in rad"
    ):
        declare("Mine", PlanarRobot(3, pose=True), full=True)


def test_other_combinations_that_have_no_meaning_are_refused() -> None:
    with pytest.raises(DefinitionError, match=r"^Mine: full gains are for tasks of positions"):
        hogan_impedance(PlanarRobot(3, pose=True), "Mine", full=True)
    with pytest.raises(DefinitionError, match=r"^Mine: the force at the wrist is .* a task of two positions"):
        plant(PlanarRobot(3, pose=True), "Mine", wrist=True)


def test_a_robot_of_other_numbers_of_joints_has_no_start_values() -> None:
    with pytest.raises(DefinitionError, match=r"^PlanarRobot: .* 2 or 3 joints, not 4\.$"):
        PlanarRobot(4)
    with pytest.raises(DefinitionError, match=r"^PlanarRobot: .* position and angle .* 3 joints, not 2\.$"):
        PlanarRobot(2, pose=True)
