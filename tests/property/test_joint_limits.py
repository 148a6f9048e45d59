"""Repulsion of the joints from the ends of their ranges: it pushes inside, is bounded, has no jump, and starts off.

All of the controllers in space have it; its torque is what they command more than without it.
"""

from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import SampledModel
from fmus.control.impedance import Measured
from fmus.control.joint_limits import declare_repulsion
from fmus.mechanics.chain import JointLimits
from fmus.mechanics.joints import Joints
from fmus.robots.puma560 import PUMA
from tests.property.definitions import evaluator
from tests.property.meeting import CRAIG, HOGAN, LAWS, SLOTINE_LI
from tests.property.samples import EPS

LOWER, UPPER, MARGIN = -1.0, 2.0, 0.2  # rad
STIFFNESS, DAMPING, LARGEST = 400.0, 30.0, 50.0  # N.m/rad, N.m.s/rad, N.m
JOINTS = replace(Joints.numbered(1), limits=(JointLimits(LOWER, UPPER, effort=LARGEST),))


@cache
def torque() -> ca.Function:
    """The torque of one joint, for q, dq and all parameters."""
    model = SampledModel("Limits", "Limits of a joint")
    q, dq = ca.SX.sym("q"), ca.SX.sym("dq")
    repulsion = declare_repulsion(model, JOINTS)
    given = {"limit_margin": MARGIN, "limit_stiffness": STIFFNESS, "limit_damping": DAMPING}
    names = [variable.name.partition("[")[0] for variable in model.variables]
    starts = [given.get(name, variable.start) or 0.0 for name, variable in zip(names, model.variables, strict=True)]
    value = repulsion.torque(Measured(q, dq, ca.SX(0, 1)))
    return ca.Function("torque", [q, dq], [ca.substitute(value, ca.vertcat(*model.parameter_symbols), starts)])


def at(q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """Torques, shape of q."""
    return np.array(torque()(q.reshape(1, -1), dq.reshape(1, -1))).reshape(q.shape)


def test_the_torque_pushes_inside_is_bounded_and_zero_outside_of_the_margins() -> None:
    rng = np.random.default_rng(3)
    q, dq = rng.uniform(LOWER - 0.5, UPPER + 0.5, 20_000), rng.normal(0, 3, 20_000)
    tau = at(q, dq)
    low, high = q < LOWER + MARGIN, q > UPPER - MARGIN
    assert (tau[~low & ~high] == 0).all()
    assert (tau[low] >= 0).all()
    assert (tau[high] <= 0).all()
    assert np.abs(tau).max() == LARGEST
    for inside in (low, high):
        assert (np.abs(tau[inside]) == LARGEST).any()
        assert (tau[inside] == 0).any()  # a joint that comes back fast needs no push
        assert ((np.abs(tau[inside]) > 0) & (np.abs(tau[inside]) < LARGEST)).any()


def test_the_torque_is_a_spring_with_a_damper_that_grows_within_the_margin() -> None:
    depth = np.linspace(0, 0.1, 11)
    np.testing.assert_allclose(at(LOWER + MARGIN - depth, 0 * depth), STIFFNESS * depth, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(at(UPPER - MARGIN + depth, 0 * depth), -STIFFNESS * depth, rtol=1e-12, atol=1e-12)
    outwards = 0.2 + 0 * depth  # rad/s
    expected = STIFFNESS * depth + DAMPING * depth / MARGIN * 0.2
    np.testing.assert_allclose(-at(UPPER - MARGIN + depth, outwards), expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(at(LOWER + MARGIN - depth, -outwards), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("rate", [-20.0, -1.0, 0.0, 1.0, 20.0])
def test_the_torque_has_no_jump(rate: float) -> None:
    step = 1e-4
    q = np.arange(LOWER - 0.3, UPPER + 0.3, step)
    change = np.abs(np.diff(at(q, np.full_like(q, rate)))).max()
    assert change <= (STIFFNESS + DAMPING * abs(rate) / MARGIN) * step * (1 + 1e-6) + 100 * EPS * LARGEST


def near_an_end() -> dict[str, np.ndarray]:
    """The PUMA at its start, and limits that leave joint 2 a hundredth of a radian."""
    begin = PUMA.start
    given = {name: np.array(getattr(begin, name))[:, None] for name in ("q", "dq", "x_v", "dx_v", "ddx_v")}
    upper = np.full((6, 1), 1e9)
    upper[1] = begin.q[1] + 0.01
    return given | {"x_t": given["x_v"] + 0.01, "dx_t": given["dx_v"], "q_max": upper, "q_min": -np.full((6, 1), 1e9)}


@pytest.mark.parametrize("law", [HOGAN, CRAIG, SLOTINE_LI])
def test_a_controller_adds_the_torque_and_pauses_its_adaptation(law: str) -> None:
    run = evaluator(LAWS[law](PUMA))
    state = {} if law == HOGAN else {"p_hat": np.array(PUMA.p_start)[:, None]}
    given = near_an_end() | state
    stiffness = {"limit_stiffness": np.full((6, 1), 100.0)}
    free, pushed = run(**given), run(**given, **stiffness)
    # The margin starts at 0.1 rad: its depth is 0.09 rad.
    expected = np.array([0, -100.0 * 0.09, 0, 0, 0, 0])
    np.testing.assert_allclose((pushed["tau_cmd"] - free["tau_cmd"])[0], expected, rtol=0, atol=1e-11)
    away = {name: values for name, values in given.items() if name != "q_max"}
    bits = [run(**away, **more)["tau_cmd"] for more in ({}, stiffness)]
    np.testing.assert_array_equal(bits[0], bits[1])  # inside the ranges of the robot nothing is added
    if law != HOGAN:
        assert np.any(free["p_hat_next"] != state["p_hat"].T)
        np.testing.assert_array_equal(pushed["p_hat_next"], state["p_hat"].T)


def test_limits_start_at_those_of_the_robot_and_are_off() -> None:
    model = LAWS[HOGAN](PUMA)
    starts = {variable.name: variable.start for variable in model.variables}
    units = {variable.name: variable.unit for variable in model.variables}
    assert [starts[f"q_max[{i + 1}]"] for i in range(6)] == pytest.approx(PUMA.joints.ranges[1])
    assert [starts[f"limit_torque[{i + 1}]"] for i in range(6)] == PUMA.joints.efforts
    assert starts["limit_stiffness[1]"] == starts["limit_damping[1]"] == 0
    assert starts["limit_margin[1]"] == 0.1
    assert (units["limit_stiffness[1]"], units["limit_damping[1]"]) == ("N.m/rad", "N.m.s/rad")
    sentences = [check.sentence for check in model.static_checks]
    assert any(s.startswith("q_min[2] must not exceed q_max[2], the range of joint") for s in sentences)


def test_a_short_range_has_a_short_margin_and_a_slide_its_units() -> None:
    joints = Joints(
        ("joint lift", "joint lock"), (False, True), (JointLimits(0.0, 0.3, effort=200.0), JointLimits(0.5, 0.5))
    )
    model = SampledModel("Limits", "Limits of two joints")
    declare_repulsion(model, joints)
    found = {variable.name: (variable.start, variable.unit) for variable in model.variables}
    assert found["limit_margin[1]"] == (0.03, "m")
    assert found["limit_margin[2]"] == (0.1, "rad")
    assert found["limit_stiffness[1]"] == (0.0, "N/m")
    assert found["limit_torque[1]"] == (200.0, "N")
    assert found["limit_torque[2]"] == (1e9, "N.m")
