"""The wall, `fmus.environment.contact`: it only pushes, stores without loss, damps, and its friction opposes sliding.

F_ext is the force of the tip on the wall: what opposes the tip is -F_ext, and F_ext' dx is the power into the wall.
"""

import math
from collections.abc import Callable

import casadi as ca
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from adaptimp_fmu import SampledModel
from fmus.environment.contact import Wall
from fmus.environment.half_space import HalfSpace, declare_half_space
from tests.driver import Driver
from tests.property.samples import EPS

PROFILE = settings(derandomize=True, database=None, deadline=None, max_examples=200)
K_F = 1e5  # N/m
speeds = st.floats(-5, 5, allow_subnormal=False)  # m/s
depths = st.floats(-0.05, 0.05, allow_subnormal=False)  # m
angles = st.floats(0, 2 * math.pi)
dampings = st.sampled_from([0.0, 0.2, 1.0, 5.0])  # s/m
frictions = st.sampled_from([0.0, 0.3, 1.2])


class Tip:
    """A tip at a depth in a wall of any direction, with velocity (normal, along); everything in numbers."""

    def __init__(self, angle: float, depth: float, v: tuple[float, float], D_f: float = 0.0, mu: float = 0.0) -> None:
        self.n = np.array([math.cos(angle), math.sin(angle)])
        self.t = np.array([-self.n[1], self.n[0]])
        self.x, self.dx, self.mu = (0.7 + depth) * self.n + 0.4 * self.t, v[0] * self.n + v[1] * self.t, mu
        wall = Wall(*(ca.SX(value) for value in (self.n, 0.7, K_F, D_f, mu, 1e-2)))
        x, dx = ca.SX(self.x), ca.SX(self.dx)
        self.gap, self.factor = float(wall.gap(x)), float(wall.damping_factor(dx))
        modes = ca.SX(self.gap > 0), ca.SX(self.factor > 0)
        self.F = np.array(ca.DM(wall.force(x, dx, *modes))).ravel()

    @property
    def rounding(self) -> float:
        """N: the gap is known to EPS times 1 m, the force then to K_f times that, factors up to 26 and 1.2."""
        return 100 * EPS * K_F

    @property
    def normal(self) -> float:
        """F_n."""
        return float(self.F @ self.n)

    @property
    def along(self) -> float:
        """F_t."""
        return float(self.F @ self.t)


@PROFILE
@given(angles, depths, speeds)
def test_without_damping_the_wall_is_the_paper_s_spring(angle: float, depth: float, v: float) -> None:
    tip = Tip(angle, depth, (v, 1.0))
    np.testing.assert_allclose(tip.F, K_F * max(depth, 0) * tip.n, rtol=0, atol=tip.rounding)


@PROFILE
@given(angles, depths, speeds, speeds, dampings, frictions)
def test_the_wall_never_pulls(angle: float, depth: float, v: float, slide: float, D_f: float, mu: float) -> None:
    tip = Tip(angle, depth, (v, slide), D_f, mu)
    assert tip.normal >= -tip.rounding
    if tip.gap <= 0 or tip.factor <= 0:
        assert (tip.F == 0).all()
    else:  # K_f gap (1 + D_f v)
        assert abs(tip.normal - K_F * depth * (1 + D_f * v)) <= tip.rounding


@PROFILE
@given(angles, depths, speeds, dampings)
def test_the_wall_gives_back_no_more_than_it_stored(angle: float, depth: float, v: float, D_f: float) -> None:
    """Power into the wall is at least the growth of K_f gap^2 / 2, with equality where D_f = 0."""
    tip = Tip(angle, depth, (v, 0.5), D_f)
    surplus = tip.F @ tip.dx - K_F * max(depth, 0) * v
    assert surplus >= -5 * tip.rounding  # speeds up to 5 m/s
    if D_f == 0:
        assert surplus <= 5 * tip.rounding


@PROFILE
@given(angles, depths, speeds, speeds, dampings, frictions)
def test_friction_opposes_sliding_within_coulomb_s_cone(
    angle: float, depth: float, v: float, slide: float, D_f: float, mu: float
) -> None:
    tip = Tip(angle, depth, (v, slide), D_f, mu)
    assert tip.along * slide >= -5 * tip.rounding  # the tip drags the wall along: power into the wall
    assert abs(tip.along) <= mu * tip.normal + tip.rounding
    if abs(slide) > 0.1:  # ten times friction_velocity: tanh(10) = 1 - 4e-9, so the bound is reached
        assert abs(abs(tip.along) - mu * tip.normal) <= 4.2e-9 * mu * tip.normal + tip.rounding
        assert tip.along * slide >= 0 or abs(tip.along) <= tip.rounding


def test_plant_shows_the_force_of_the_law_at_its_start(open_fmu: Callable[..., Driver]) -> None:
    """Modes follow from the indicators at t0: outside, pushing, and being left faster than 1/D_f."""
    n, D_f, mu = np.array([-0.6, 0.8]), 0.5, 0.3
    q = np.array([2.0, 1.0])
    x = np.array([np.cos(2) + np.cos(3), np.sin(2) + np.sin(3)])
    J = np.array([[-np.sin(2) - np.sin(3), -np.sin(3)], [np.cos(2) + np.cos(3), np.cos(3)]])
    t = np.array([-n[1], n[0]])
    for depth, v, expected in ((-0.01, 1.0, 0), (0.01, 1.0, 1500), (0.01, -1.0, 500), (0.01, -2.5, 0)):
        dq = np.linalg.solve(J, v * n + 0.2 * t)
        start = {"wall_offset": n @ x - depth, "D_f": D_f, "mu": mu, "K_f": K_F}
        for name, values in (("q_start", q), ("dq_start", dq), ("wall_normal", n)):
            start |= {f"{name}[{i + 1}]": values[i] for i in range(2)}
        plant = open_fmu("Plant")
        plant.initialize(start)
        F = expected * (n + mu * t)  # 0.2 m/s is 20 friction velocities
        np.testing.assert_allclose(plant.get("F_ext[1]", "F_ext[2]"), F, rtol=0, atol=100 * EPS * K_F)
        assert abs(plant.get("gap")[0] - depth) <= 10 * EPS
        assert abs(plant.get("penetration")[0] - max(depth, 0)) <= 10 * EPS


@PROFILE
@given(angles, depths, st.floats(-3, 3, allow_subnormal=False))
def test_the_gap_is_the_depth_and_components_make_up_the_vector(angle: float, depth: float, along: float) -> None:
    n = np.array([math.cos(angle), math.sin(angle)])
    half_space = HalfSpace(ca.SX(n), ca.SX(0.7))
    t = np.array(ca.DM(half_space.tangent)).ravel()
    x = (0.7 + depth) * n + along * t
    # n.n and t.t differ from 1 by 2 EPS, n.t from 0 by EPS, and lengths are below 4 m.
    assert abs(float(half_space.gap(ca.SX(x))) - depth) <= 20 * EPS
    components = [float(half_space.along_normal(ca.SX(x))), float(half_space.along_surface(ca.SX(x)))]
    np.testing.assert_allclose(components, [0.7 + depth, along], rtol=0, atol=20 * EPS)


def test_a_wall_in_space_is_that_of_the_plane_for_motions_in_a_plane_of_space() -> None:
    """The plane of the normal and of the sliding, turned anyhow in space: the same force, turned."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        angle, depth, D_f, mu = rng.uniform([0, -0.01, 0, 0], [2 * math.pi, 0.02, 2, 1])
        v, slide = rng.uniform(-2, 2, 2)
        flat = Tip(angle, depth, (v, slide), D_f, mu)
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0][:, :2]
        values = (axes @ flat.n, 0.7, K_F, D_f, mu, 1e-2)
        wall = Wall(*(ca.SX(value) for value in values))
        x, dx = ca.SX(axes @ flat.x), ca.SX(axes @ flat.dx)
        modes = ca.SX(flat.gap > 0), ca.SX(flat.factor > 0)
        F = np.array(ca.DM(wall.force(x, dx, *modes))).ravel()
        np.testing.assert_allclose(F, axes @ flat.F, rtol=0, atol=10 * flat.rounding)


def test_friction_in_space_is_zero_at_rest_and_without_a_coefficient() -> None:
    normal = ca.SX(np.array([0.0, 0.0, -1.0]))
    touching, x = ca.SX(1), ca.SX(np.array([0.3, 0.1, -0.71]))
    for mu, dx in ((0.5, [0.0, 0.0, 0.0]), (0.0, [1.0, 2.0, 0.0])):
        wall = Wall(normal, *(ca.SX(value) for value in (0.7, K_F, 0.0, mu, 1e-2)))
        F = np.array(ca.DM(wall.force(x, ca.SX(np.array(dx)), touching, touching))).ravel()
        np.testing.assert_allclose(F, [0, 0, -K_F * 0.01], rtol=0, atol=100 * EPS * K_F)


def test_a_declared_half_space_in_space_has_three_components() -> None:
    model = SampledModel("Walled", "Has a wall")
    assert declare_half_space(model, size=3).normal.shape == (3, 1)
    assert [v.start for v in model.variables if v.name.startswith("wall_normal")] == [-1.0, 0.0, 0.0]


def test_a_declared_half_space_demands_a_unit_normal() -> None:
    model = SampledModel("Walled", "Has a wall")
    half_space = declare_half_space(model)
    assert [check.sentence for check in model.static_checks] == ["wall_normal must have length 1"]
    miss = ca.Function("miss", [half_space.normal], [model.static_checks[0].value])
    assert [float(miss(normal)) > 0 for normal in ([0.6, 0.8], [0.6, 0.8 + 1e-8], [0.0, 0.0])] == [True, False, False]
