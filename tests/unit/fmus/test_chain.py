"""Numbers of bodies, joints and chains: what they derive, and the sentences by which impossible ones are refused."""

from collections.abc import Callable

import numpy as np
import pytest

from fmus.mechanics.chain import Chain, Joint, JointKind, JointLimits
from fmus.mechanics.rigid_body import Body, Placement, RobotError, merged, symmetric
from fmus.robots.puma560 import puma560

SPHERE = Body("ball", 2.0, (0.1, 0.0, 0.0), (0.1, 0.0, 0.1, 0.0, 0.0, 0.1))
AXIAL = Body("turret", 0.0, inertia=(0, 0, 0, 0, 0, 0.35), axial_only=True)


def chain(*joints: Joint) -> Chain:
    return Chain("arm", joints)


def test_parameters_are_about_the_origin_of_the_frame() -> None:
    """Two kilograms at 0.1 m along axis 1: steiner's part, 0.02 kg m2, about axes 2 and 3."""
    np.testing.assert_allclose(SPHERE.parameters, [2, 0.2, 0, 0, 0.1, 0, 0.12, 0, 0, 0.12], rtol=1e-15)


def test_a_placed_body_turns_and_shifts() -> None:
    rod = Body("rod", 1.0, (1.0, 0.0, 0.0), (0.0, 0.0, 0.2, 0.0, 0.0, 0.2))
    placed = rod.placed(Placement.from_rpy((0, 0, 3), (0, 0, np.pi / 2)))
    np.testing.assert_allclose(placed.center, (0, 1, 3), atol=1e-15)
    np.testing.assert_allclose(symmetric(placed.inertia), np.diag([0.2, 0, 0.2]), atol=1e-15)


def test_bodies_merge_about_their_common_centre() -> None:
    twins = [Body(f"twin{k}", 1.0, (x, 0.0, 0.0)) for k, x in enumerate((-1.0, 1.0))]
    whole = merged("dumbbell", twins)
    assert whole == Body("dumbbell", 2.0, (0.0, 0.0, 0.0), (0.0, 0.0, 2.0, 0.0, 0.0, 2.0))
    assert merged("nothing", []).mass == 0


def test_a_quarter_turn_has_no_rounding_errors() -> None:
    R = Placement.from_rpy((0, 0, 0), (np.pi / 2, 0, -np.pi / 2)).R
    assert np.count_nonzero(R) == 3


def test_parameters_of_a_chain_are_bodies_then_friction_then_rotors() -> None:
    numbers = chain(
        Joint("one", SPHERE, damping=1.0, friction=2.0, rotor_inertia=3.0), Joint("two", SPHERE, damping=4.0)
    )
    np.testing.assert_array_equal(numbers.p[:20], np.tile(SPHERE.parameters, 2))
    np.testing.assert_array_equal(numbers.p[20:], [1, 4, 2, 0, 3, 0])


def test_puma_says_that_its_first_body_is_known_about_its_axis_only() -> None:
    bodies = [joint.body for joint in puma560().joints]
    assert [body.axial_only for body in bodies] == [True] + [False] * 5


REFUSED: dict[str, tuple[Callable[[], object], str]] = {
    "a mass that is no number": (
        lambda: Body("b", np.nan),
        "Body b: mass, centre and moments of inertia must be finite numbers; correct them.",
    ),
    "axial with a mass": (
        lambda: Body("b", 1.0, inertia=(0, 0, 0, 0, 0, 0.35), axial_only=True),
        "Body b: with axial_only it has I33 > 0 and nothing else, but I33 is 0.35 kg m2 and the mass is 1 kg; give "
        "the body all ten numbers, or I33 alone.",
    ),
    "axial in the wrong place": (
        lambda: chain(Joint("one", SPHERE), Joint("two", AXIAL)),
        "Body turret of joint two (number 2, revolute, axis (0.0, 0.0, 1.0)): axial_only is enough for the first "
        "joint alone, if it turns about (0, 0, 1); give the body all ten numbers.",
    ),
    "axial on a slide": (
        lambda: chain(Joint("one", AXIAL, kind=JointKind.PRISMATIC)),
        "Body turret of joint one (number 1, prismatic, axis (0.0, 0.0, 1.0)): axial_only is enough for the first "
        "joint alone, if it turns about (0, 0, 1); give the body all ten numbers.",
    ),
    "a long axis": (
        lambda: Joint("j", SPHERE, axis=(0.0, 3.0, 4.0)),
        "Joint j: the axis (0.0, 3.0, 4.0) has length 5, not 1; divide it by its length.",
    ),
    "negative friction": (
        lambda: Joint("j", SPHERE, friction=-1.0),
        "Joint j: friction is -1, but must be finite and at least 0; correct it.",
    ),
    "an infinite rotor": (
        lambda: Joint("j", SPHERE, rotor_inertia=np.inf),
        "Joint j: rotor_inertia is inf, but must be finite and at least 0; correct it.",
    ),
    "limits that are no numbers": (
        lambda: Joint("j", SPHERE, limits=JointLimits(np.nan, 1.0)),
        "Joint j: the lower limit nan is above the upper limit 1; exchange or correct them.",
    ),
    "no joints": (
        lambda: chain(),
        "Robot arm: no joint moves between base and tip, so there is nothing to control; choose another base or tip.",
    ),
    "one name twice": (
        lambda: chain(Joint("j", SPHERE), Joint("j", SPHERE)),
        "Robot arm: 2 joints have the name j; rename all but one.",
    ),
    "a last body without resistance": (
        lambda: chain(Joint("j", Body("point", 1.0))),
        "Joint j: its body point has an inertia of 0 kg m2 against its motion, and the rotor has 0 kg m2, so that any "
        "torque accelerates it without limit; give the body its mass and inertia, or the joint its rotor's.",
    ),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_numbers_that_cannot_be_are_refused_by_a_sentence(fault: str) -> None:
    make, sentence = REFUSED[fault]
    with pytest.raises(RobotError) as caught:
        make()
    assert str(caught.value) == sentence


def test_rounded_moments_are_accepted() -> None:
    """A rod whose moments a file gives with six digits misses the triangle inequality by one in the last place."""
    assert Body("rod", 1.0, inertia=(0.100000, 0, 0.0, 0, 0, 0.1000001)).mass == 1
    with pytest.raises(RobotError, match="two of them make at least the third"):
        Body("rod", 1.0, inertia=(0.100000, 0, 0.0, 0, 0, 0.100001))


def test_moments_that_are_only_rounding_are_those_of_a_point() -> None:
    """The parts of iCub's head, put into one frame, leave 2e-35 kg m2 of both signs."""
    assert Body("head", 1.0, inertia=(-2.4e-35, 0.0, 0.0, 0.0, 0.0, 2.4e-35)).mass == 1
    with pytest.raises(RobotError, match="none can be negative"):
        Body("head", 1.0, inertia=(-1e-12, 0.0, 0.0, 0.0, 0.0, 1e-12))
