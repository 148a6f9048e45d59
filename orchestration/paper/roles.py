"""The interface of each role in the paper's control loop: names, units, types and causality of its signals.

An FMU that takes a role must have the outputs that other components need. It may leave out inputs that it does
not use; other outputs, and parameters that scenarios set, are missed by figures and claims alone.
"""

from collections.abc import Mapping

from orchestration.check.interface import COUNTED, OPEN, SCALAR, Role, Signal
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import BOOLEAN
from orchestration.fmi.names import suggestion

JOINT, PLANE = COUNTED, 2  # elements of a signal: one per joint of the arm, one per axis of the plane


def _task(position: str, angle: str) -> Signal:
    """A signal of the tip: one element per axis of the plane, and one for its angle if the task has it."""
    return Signal(position, PLANE, more=(angle,))


_MOTION = {"q": Signal("rad", JOINT), "dq": Signal("rad/s", JOINT), "ddq": Signal("rad/s2", JOINT)}
_VIRTUAL = {"x_v": _task("m", "rad"), "dx_v": _task("m/s", "rad/s"), "ddx_v": _task("m/s2", "rad/s2")}
_SATURATED = {"saturated": Signal("", JOINT, BOOLEAN)}


def _role(name: str, defining: str, required: Mapping[str, Signal], **further) -> Role:
    """A role of the paper's arm, which has two joints or more."""
    return Role(name, defining, required, counted="joint", fewest=2, readers="figures and claims", **further)


ROLES: Mapping[str, Role] = {
    role.name: role
    for role in (
        _role(
            "controller",
            "tau_cmd",
            {"tau_cmd": Signal("N.m", JOINT)},
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
            {"tau": Signal("N.m", JOINT)},
            expected=_SATURATED,
            inputs={"tau_cmd": Signal("N.m", JOINT)},
        ),
        _role("sensor", "F_hat", {"F_hat": _task("N", "N.m")}, inputs={"F_ext": _task("N", "N.m")}),
        _role("trajectory", "x_v", _VIRTUAL),
        _role(
            "plant",
            "q",
            {**_MOTION, "x": _task("m", "rad"), "dx": _task("m/s", "rad/s"), "F_ext": _task("N", "N.m")},
            expected={"gap": Signal("m", SCALAR), "penetration": Signal("m", SCALAR)},
            inputs={"tau": Signal("N.m", JOINT)},
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
