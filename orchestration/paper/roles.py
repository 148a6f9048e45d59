"""The interface of each role in the paper's control loop: names, units, types and causality of its signals.

An FMU that takes a role must have the outputs that other components need. It may leave out inputs that it does
not use; other outputs, and parameters that scenarios set, are missed by figures and claims alone.
"""

from collections.abc import Mapping

from orchestration.check.interface import COUNTED, FORMED, OPEN, SCALAR, Role, Signal
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import BOOLEAN
from orchestration.fmi.names import suggestion

JOINT = COUNTED  # elements of a signal: one per joint of the arm
PLANE, SPACE = 2, 3  # positions of the tip
SLIDING_FROM = 6  # joints: arms in the plane turn about all of theirs


def _task(position: str, angle: str) -> Signal:
    """A signal of the tip: positions in the plane, with an angle or without, or positions and angles in space."""
    plane = (position,) * PLANE
    return Signal(position, FORMED, forms=(plane, (*plane, angle), (*(position,) * SPACE, *(angle,) * SPACE)))


def _joint(turning: str, sliding: str) -> Signal:
    """A signal of the joints, some of which may slide."""
    return Signal(turning, JOINT, other=sliding)


_MOTION = {"q": _joint("rad", "m"), "dq": _joint("rad/s", "m/s"), "ddq": _joint("rad/s2", "m/s2")}
_TORQUE = _joint("N.m", "N")
_VIRTUAL = {"x_v": _task("m", "rad"), "dx_v": _task("m/s", "rad/s"), "ddx_v": _task("m/s2", "rad/s2")}
_SATURATED = {"saturated": Signal("", JOINT, BOOLEAN)}
_IN_SPACE = {"x": _task("m", "rad")}  # of a sensor whose frame turns with the tip


def _role(name: str, defining: str, required: Mapping[str, Signal], **further) -> Role:
    """A role of the paper's arm, which has two joints or more."""
    return Role(
        name,
        defining,
        required,
        counted="joint",
        fewest=2,
        others_from=SLIDING_FROM,
        readers="figures and claims",
        **further,
    )


ROLES: Mapping[str, Role] = {
    role.name: role
    for role in (
        _role(
            "controller",
            "tau_cmd",
            {"tau_cmd": _TORQUE},
            expected={
                "x_t": _task("m", "rad"),
                "dx_t": _task("m/s", "rad/s"),
                "e": _task("m", "rad"),
                "p_hat": Signal(None, OPEN),
            },
            inputs={**_MOTION, "F_hat": _task("N", "N.m"), **_VIRTUAL, **_SATURATED},
            optional=frozenset(_SATURATED),
        ),
        _role(
            "actuator",
            "tau",
            {"tau": _TORQUE},
            expected=_SATURATED,
            inputs={"tau_cmd": _TORQUE},
        ),
        _role(
            "sensor",
            "F_hat",
            {"F_hat": _task("N", "N.m")},
            inputs={"F_ext": _task("N", "N.m"), **_IN_SPACE},
            optional=frozenset(_IN_SPACE),
        ),
        _role("trajectory", "x_v", _VIRTUAL),
        _role(
            "plant",
            "q",
            {**_MOTION, "x": _task("m", "rad"), "dx": _task("m/s", "rad/s"), "F_ext": _task("N", "N.m")},
            expected={"gap": Signal("m", SCALAR), "penetration": Signal("m", SCALAR)},
            inputs={"tau": _TORQUE},
            sampled=False,
        ),
    )
}


def role_named(name: str) -> Role:
    """A role by name.

    Raises
    ------
    SystemDescriptionError
        Giving near names.
    """
    if name not in ROLES:
        msg = f"There is no role {name}; {suggestion(name, ROLES)}"
        raise SystemDescriptionError(msg)
    return ROLES[name]
