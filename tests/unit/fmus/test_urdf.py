"""What the reader of URDF files makes of an arm, and each sentence by which it refuses one."""

import numpy as np
import pytest

from fmus.mechanics.chain import Chain, JointKind
from fmus.mechanics.rigid_body import RobotError, symmetric
from fmus.robots.urdf import chain_of_urdf, read_urdf

INERTIAL = (
    '<inertial><origin xyz="0.1 0 0"/><mass value="2"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
)
LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'
ARM = f"""<robot name="arm">
<link name="base"/>
<link name="upper">{INERTIAL}</link>
<link name="lower">{INERTIAL}</link>
<link name="tool"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/><axis xyz="0 0 2"/>{LIMIT}<dynamics damping="0.3" friction="0.2"/>
</joint>
<joint name="elbow" type="prismatic"><parent link="upper"/><child link="lower"/>
<origin xyz="1 0 0"/>{LIMIT}
</joint>
<joint name="flange" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="0.2 0 0"/></joint>
</robot>"""


def read(text: str, tip: str = "tool", **options: object) -> Chain:
    return chain_of_urdf(text.encode(), "arm.urdf", tip, **options)  # type: ignore[arg-type]


def changed(old: str, new: str) -> str:
    assert ARM.count(old) >= 1
    return ARM.replace(old, new, 1)


def test_an_arm_is_read_as_it_is_written() -> None:
    chain = read(ARM)
    shoulder, elbow = chain.joints
    assert (chain.name, chain.base_name, chain.tip_name, chain.n) == ("arm", "base", "tool", 2)
    assert (shoulder.kind, elbow.kind) == (JointKind.REVOLUTE, JointKind.PRISMATIC)
    assert (shoulder.axis, elbow.axis) == ((0, 0, 1), (1, 0, 0)), "an axis has length 1, and is x by default"
    assert (shoulder.damping, shoulder.friction, elbow.damping) == (0.3, 0.2, 0.0)
    limits = shoulder.limits
    assert (limits.lower, limits.upper, limits.velocity, limits.effort) == (-1, 2, 3, 4)
    np.testing.assert_allclose(shoulder.placement.R, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert chain.tip.translation == (0.2, 0, 0)
    assert elbow.body.mass == 2
    assert elbow.body.center == (0.1, 0, 0)


def test_what_hangs_rigidly_on_a_link_becomes_part_of_its_body() -> None:
    joint = '<joint name="finger" type="{}"><parent link="tool"/><child link="tip"/><axis xyz="0 0 1"/></joint>'
    finger = f'<link name="tip">{INERTIAL}</link>' + joint
    for kind, angle, center in (("fixed", 0, [0.2, 0, 0]), ("continuous", np.pi / 2, [0.15, 0.05, 0])):
        text = changed("</robot>", finger.format(kind) + "</robot>")
        body = read(text, locked={"finger": angle} if angle else None).joints[-1].body
        assert body.mass == 4
        np.testing.assert_allclose(body.center, center, atol=1e-15)
        # Two spheres of 0.1 kg m2, their centres at a distance d of the common one: 0.2 + 4 kg d^2 across the line.
        d2 = 0.1**2 if kind == "fixed" else 2 * 0.05**2
        assert np.linalg.eigvalsh(symmetric(body.inertia)) == pytest.approx([0.2, 0.2 + 4 * d2, 0.2 + 4 * d2])


def test_a_held_joint_of_the_chain_is_a_fixed_one() -> None:
    chain = read(ARM, locked={"elbow": 0.5})
    assert [joint.name for joint in chain.joints] == ["shoulder"]
    assert chain.joints[0].body.mass == 4
    np.testing.assert_allclose(chain.tip.p, [1.7, 0, 0])


def test_a_branch_that_no_moving_joint_carries_does_not_count() -> None:
    other = '<link name="head"/><joint name="neck" type="floating"><parent link="base"/><child link="head"/></joint>'
    assert read(changed("</robot>", other + "</robot>")) == read(ARM)


MIMIC = '<mimic joint="shoulder"/>'
BRANCH = '<link name="head"/><joint name="neck" type="continuous"><parent link="lower"/><child link="head"/></joint>'
REFUSED = {
    "no XML": ("<robot", "arm.urdf: this is not well-formed XML: "),
    "a document type": (
        '<!DOCTYPE robot [<!ENTITY e "1">]>' + ARM,
        "arm.urdf: the file has a document type (<!DOCTYPE ...>), which a URDF does not need; remove it.",
    ),
    "xacro": (
        changed("<link", '<xacro:macro xmlns:xacro="http://www.ros.org/wiki/xacro"/><link'),
        "arm.urdf, line 2: macro is an element of xacro; make a URDF first: xacro FILE.xacro > FILE.urdf.",
    ),
    "another root": (
        "<sdf/>",
        "arm.urdf: the root element is <sdf>, but that of a URDF is <robot>; choose another file.",
    ),
    "a nameless link": (changed(' name="base"', ""), "arm.urdf, line 2: this link has no name; give it one."),
    "one name twice": (
        changed('name="lower"', 'name="upper"'),
        "arm.urdf, line 4: a second link has the name upper, as that of line 3 has; rename one of them.",
    ),
    "no parent": (
        changed('<parent link="base"/>', ""),
        "arm.urdf, line 6: joint shoulder needs <parent link=...>; add it.",
    ),
    "an unknown child": (
        changed('<child link="tool"/>', '<child link="too"/>'),
        "arm.urdf: there is no link (line 12, joint flange) too; the file has base, upper, lower, tool.",
    ),
    "a mimic joint": (
        changed("</joint>\n<joint name=\"flange\"", MIMIC + "</joint>\n<joint name=\"flange\""),
        "arm.urdf, line 9: joint elbow mimics joint shoulder, but each joint of the chain needs a drive of its own; "
        "remove <mimic>, or hold the joint: locked={'elbow': 0.0}.",
    ),
    "a floating joint": (
        changed('type="prismatic"', 'type="floating"'),
        "arm.urdf, line 9: joint elbow is floating, but joints of the chain are fixed, revolute, continuous, "
        "prismatic; write it as several of these, one behind the other.",
    ),
    "a branch": (
        changed("</robot>", BRANCH + "</robot>"),
        "arm.urdf, line 13: joint neck (continuous) branches off the chain at link lower; hold it, "
        "locked={'neck': 0.0}, so that what it carries becomes part of the link.",
    ),
    "a mimic branch": (
        changed("</robot>", BRANCH.replace("</joint>", MIMIC + "</joint>") + "</robot>"),
        "arm.urdf, line 13: joint neck (continuous) mimics joint shoulder and branches off the chain at link lower; "
        "hold it, locked={'neck': 0.0}, so that what it carries becomes part of the link.",
    ),
    "two parents": (
        changed('<child link="tool"/>', '<child link="upper"/>'),
        "arm.urdf, line 12: link upper is the child of joint shoulder and of joint flange, which closes a loop; a "
        "serial arm has one joint for each link.",
    ),
    "a closed loop": (
        changed('<parent link="base"/>', '<parent link="lower"/>'),
        "arm.urdf, line 6: the joints from lower on lead back to lower (tool <- lower <- upper <- lower): a closed "
        "loop is not a serial arm; remove the joint that closes it.",
    ),
    "no limits": (
        changed(LIMIT, ""),
        "arm.urdf, line 6: joint shoulder is revolute and has no limits; give it <limit lower= upper= velocity= "
        'effort=/>, or type="continuous" if it turns without end.',
    ),
    "exchanged limits": (
        changed('lower="-1"', 'lower="5"'),
        "arm.urdf, line 6: Joint shoulder: the lower limit 5 is above the upper limit 2; exchange or correct them.",
    ),
    "no axis": (
        changed("0 0 2", "0 0 0"),
        "arm.urdf, line 6: the axis of joint shoulder is 0 0 0; give it a direction.",
    ),
    "negative damping": (
        changed("0.3", "-0.3"),
        "arm.urdf, line 6: Joint shoulder: damping is -0.3, but must be finite and at least 0; correct it.",
    ),
    "no inertial": (
        changed(f'"lower">{INERTIAL}', '"lower">'),
        "arm.urdf, line 9: joint elbow moves lower, tool, and none of them has a mass; give one of the links its "
        "<inertial>.",
    ),
    "half an inertial": (
        changed('<mass value="2"/>', ""),
        "arm.urdf, line 3: <inertial> needs <mass value=...>; add it.",
    ),
    "no number": (
        changed('<mass value="2"/>', '<mass value="2 kg"/>'),
        'arm.urdf, line 3: <mass value="2 kg"> must have a finite number; correct it.',
    ),
    "too few numbers": (
        changed('xyz="0 0 0.5"', 'xyz="0.5"'),
        'arm.urdf, line 7: <origin xyz="0.5"> must have 3 finite numbers; correct it.',
    ),
    "not a number": (
        changed('damping="0.3"', 'damping="nan"'),
        'arm.urdf, line 7: <dynamics damping="nan"> must have a finite number; correct it.',
    ),
    "a negative mass": (
        changed('<mass value="2"/>', '<mass value="-2"/>'),
        "arm.urdf, line 3: Body upper: the mass is -2 kg, but a mass is at least 0 kg; correct it.",
    ),
    "inertia without mass": (
        changed('<mass value="2"/>', '<mass value="0"/>'),
        "arm.urdf, line 3: Body upper: the mass is 0 kg, but the largest moment of inertia is 0.1 kg m2; give the "
        "body its mass, or no moments.",
    ),
    "a negative moment": (
        changed('ixy="0"', 'ixy="0.3"'),
        "arm.urdf, line 3: Body upper: the principal moments of inertia about the centre of mass are -0.2, 0.1 and "
        "0.4 kg m2, but none can be negative; correct the moments, or the signs of the products of inertia.",
    ),
    "no triangle": (
        changed('ixx="0.1"', 'ixx="0.3"'),
        "arm.urdf, line 3: Body upper: the principal moments of inertia about the centre of mass are 0.1, 0.1 and "
        "0.3 kg m2, but two of them make at least the third, and 0.1 + 0.1 = 0.2 < 0.3; correct the moments.",
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", REFUSED)
def test_what_is_no_arm_is_refused_by_a_sentence(fault: str) -> None:
    text, sentence = REFUSED[fault]
    with pytest.raises(RobotError) as caught:
        read(text)
    assert str(caught.value).startswith(sentence)


def test_names_that_the_file_does_not_have_are_refused() -> None:
    for options, sentence in (
        ({"tip": "tol"}, "arm.urdf: there is no tip link tol; the file has base, upper, lower, tool."),
        ({"base": "bas"}, "arm.urdf: there is no base link bas; the file has base, upper, lower, tool."),
        (
            {"locked": {"elbo": 0.0}},
            "arm.urdf: there is no joint elbo; the file has shoulder, elbow, flange.",
        ),
        (
            {"base": "tool", "tip": "lower"},
            "arm.urdf: link lower does not hang on link tool: the way up ends at link base. Choose a base among base, "
            "upper, lower.",
        ),
        (
            {"locked": {"flange": 0.3}},
            "arm.urdf, line 12: joint flange is fixed and cannot be held at 0.3; only revolute, continuous, prismatic "
            "joints are held at finite numbers, and others at 0.",
        ),
        (
            {"locked": {"elbow": np.inf}},
            "arm.urdf, line 9: joint elbow is prismatic and cannot be held at inf; only revolute, continuous, "
            "prismatic joints are held at finite numbers, and others at 0.",
        ),
        (
            {"base": "lower"},
            "Robot arm: no joint moves between lower and tool, so there is nothing to control; choose another base or "
            "tip.",
        ),
    ):
        with pytest.raises(RobotError) as caught:
            read(ARM, **options)  # type: ignore[arg-type]
        assert str(caught.value) == sentence


def test_of_many_names_the_nearest_are_listed() -> None:
    links = "".join(f'<link name="part{k}"/>' for k in range(40))
    with pytest.raises(RobotError, match=r"no tip link tol; the file has tool, .* and 32 others\.$"):
        read(changed("<link", links + "<link"), tip="tol", base="base")


def test_two_roots_need_the_name_of_the_base() -> None:
    text = changed("<link", '<link name="lamp"/><link')
    with pytest.raises(RobotError, match=r"2 links are no child of a joint \(lamp, base\)"):
        read(text)
    assert read(text, base="base").n == 2


def test_a_file_is_read_by_its_path(tmp_path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "arm.urdf").write_text(ARM, encoding="utf-8")
    assert read_urdf(tmp_path / "arm.urdf", "tool") == read(ARM)
    (tmp_path / "arm.urdf").write_text("<sdf/>", encoding="utf-8")
    with pytest.raises(RobotError, match=r"^arm\.urdf: the root element is <sdf>"):
        read_urdf(tmp_path / "arm.urdf", "tool")
