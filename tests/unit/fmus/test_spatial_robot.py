"""A spatial arm in FMUs: its motion at the start, the payload of plant and controller, and what is refused."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from adaptimp_fmu import SampledModel
from fmus.mechanics.rigid_body import Body, RobotError
from fmus.mechanics.spatial_arm import SpatialArm
from fmus.robots.puma560 import PUMA, puma560
from tests.property.samples import EPS

PRINTED = 1e-9  # start values have ten decimals


def test_the_tip_begins_on_the_ellipse_and_moves_with_it() -> None:
    arm, begin, path = SpatialArm(PUMA.chain), PUMA.start, PUMA.path
    R, position = (np.array(value) for value in arm.tip_frame(begin.q))
    first, second, _ = Rotation.from_euler("xyz", path.plane).as_matrix().T
    np.testing.assert_allclose(position.ravel(), path.center + path.semi_axis[0] * first, rtol=0, atol=PRINTED)
    np.testing.assert_allclose(R, Rotation.from_euler("xyz", path.reference).as_matrix(), rtol=0, atol=PRINTED)
    velocity = np.array(arm.jacobian(begin.q)) @ begin.dq
    expected = np.concatenate([path.semi_axis[1] * np.pi * second, np.zeros(3)])
    np.testing.assert_allclose(velocity, expected, rtol=0, atol=10 * PRINTED)
    np.testing.assert_allclose([*begin.x_v[:3], *begin.dx_v], [*position.ravel(), *expected], rtol=0, atol=10 * PRINTED)


def test_the_arm_begins_without_torque() -> None:
    """The acceleration at the start is what the arm with its payload does when no torque acts."""
    begin, last = PUMA.start, PUMA.chain.joints[-1]
    mass = last.body.mass + PUMA.payload.mass
    placed = PUMA.payload.placed(PUMA.chain.tip)
    center = (last.body.mass * np.array(last.body.center) + placed.mass * np.array(placed.center)) / mass
    moments = last.body.parameters + placed.parameters  # about the origin of the frame, so that they add up
    whole = np.concatenate([PUMA.chain.p[:50], moments, PUMA.chain.p[60:]])
    np.testing.assert_allclose(moments[:4], [mass, *(mass * center)], rtol=1e-14)
    arm = SpatialArm(PUMA.chain)
    ddq = np.array(arm.acceleration(begin.q, begin.dq, np.zeros(6), whole, [0, 0, -9.81], 0.01)).ravel()
    np.testing.assert_allclose(begin.ddq, ddq, rtol=0, atol=1e-6)


def test_plant_and_controller_have_the_same_arm_but_for_the_payload() -> None:
    """The plant's mass, centre and moments are the ten parameters that a controller would have to find."""
    plant = SampledModel("Plant", "Numbers of a plant")
    _, p = PUMA.declare_true(plant)
    starts = [variable.start for variable in plant.variables if variable.role.is_parameter]
    value = ca.Function("p", [*plant.parameter_symbols], [p])
    columns, k = [], 0
    for symbol in plant.parameter_symbols:
        columns.append(starts[k : k + symbol.numel()])
        k += symbol.numel()
    found = np.array(value(*columns)).ravel()
    np.testing.assert_allclose(found[:78], PUMA.p_start[:78], rtol=0, atol=0)
    np.testing.assert_allclose(found[78:], PUMA.payload.parameters, rtol=0, atol=4 * EPS)
    assert not any(PUMA.p_start[78:])
    assert list(PUMA.uncertain) == [False] * 78 + [True] * 10


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        (
            {"path": replace(PUMA.path, center=(2.0, 0.15, 0.1))},
            "Robot PUMA 560: the tip does not reach the beginning of the ellipse, position [2.0, 0.15, 0.175] m, from"
            " the joint coordinates [0.0, -1.335, 3.355, 0.0, 1.122, 0.0]; choose others, or another ellipse.",
        ),
        ({"near": (0.0, 1.0)}, "Robot PUMA 560: 2 joint coordinates are given for 6 joints."),
        (
            {"chain": replace(puma560(), joints=puma560().joints[:5]), "near": (0.0,) * 5},
            "Robot PUMA 560: position and orientation of the tip are 6 task coordinates, but the arm has 5 joints; use"
            " an arm of at least 6 joints, or hold fewer joints.",
        ),
    ],
)
def test_an_arm_that_cannot_follow_is_refused(changed: dict, sentence: str) -> None:
    with pytest.raises(RobotError) as caught:
        replace(PUMA, **changed)
    assert str(caught.value) == sentence


def test_a_payload_can_be_chosen() -> None:
    heavy = replace(PUMA, payload=Body("tool", 2.5, (0.0, 0.0, 0.02)))
    assert heavy.start.q == PUMA.start.q
    assert heavy.start.ddq != PUMA.start.ddq
