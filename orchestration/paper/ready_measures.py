"""Ready measures of the paper's loops: names for what is asked of a run most often.

The formulas name variables of the interface that all arms and controllers share. So the measures work for every
scenario, and for every system whose components ``plant``, ``controller``, ``actuator``, ``sensor`` and
``trajectory`` have these variables. In contact means that the wall exerts a force. Arms in space have measures of their
own, since a norm of all coordinates would add metres and radians.
"""

from collections.abc import Iterator, Mapping

from orchestration.paper.measure import SETTLED
from orchestration.paper.spatial_numbers import FIRST_OF_PAYLOAD

_TOUCHING = "norm(plant.F_ext) > 0"
_BEFORE = f"before({_TOUCHING})"
_E = "norm(controller.e)"
_M2_ERROR = "abs(controller.p_hat[2] - plant.m[2])"
_PAYLOAD = f"controller.p_hat[{FIRST_OF_PAYLOAD}]"
_ERRORS = {
    "position": ("controller.e", (1, 2, 3), "error of the tip's position in space"),
    "angle": ("controller.e", (4, 5, 6), "error of the tip's orientation in space, by roll, pitch and yaw"),
}
_WHERE = {"free": (f"not {_TOUCHING}", "out of contact"), "contact": (_TOUCHING, "in contact")}
_SIZES = {"max": "largest", "rms": "root mean square of the"}


def _norm(name: str, elements: tuple[int, ...]) -> str:
    return f"norm({', '.join(f'{name}[{i}]' for i in elements)})"


def _measures_in_space() -> Iterator[tuple[str, tuple[str, str]]]:
    """Yield measures of arms in space, whose norms join no metre with a radian."""
    for what, (array, elements, text) in _ERRORS.items():
        for size, begin in _SIZES.items():
            for where, (condition, place) in _WHERE.items():
                formula = f"{size}({_norm(array, elements)}, where={condition})"
                yield f"{size}_{what}_{where}", (formula, f"{begin} {text}, {place}")
    yield "peak_push", (f"max({_norm('plant.F_ext', (1, 2, 3))})", "largest force of the wall on an arm in space")
    yield "payload_hat", (f"final({_PAYLOAD})", "estimate of the payload's mass at the end, of an arm of six joints")
    yield (
        "payload_error",
        (f"final(abs({_PAYLOAD} - plant.payload_mass))", "error of this estimate at the end"),
    )


IN_SPACE: Mapping[str, tuple[str, str]] = dict(_measures_in_space())
"""Measures of arms in space, as in `READY`."""

READY: Mapping[str, tuple[str, str]] = {
    "peak_force": ("max(norm(plant.F_ext))", "largest force of the wall"),
    "rms_force": (f"rms(norm(plant.F_ext), where={_TOUCHING})", "root mean square of the force in contact"),
    "impulse": ("integral(norm(plant.F_ext))", "force of the wall, summed over time"),
    "peak_penetration": ("max(plant.penetration)", "largest depth of the tip in the wall"),
    "contact_time": (f"duration({_TOUCHING})", "time in contact, without the time between bounces"),
    "first_contact": (f"first_time({_TOUCHING})", "time of the first contact"),
    "last_contact": (f"last_time({_TOUCHING})", "time of the last contact"),
    "force_error": ("max(norm(sensor.F_hat - plant.F_ext))", "largest error of the measured force"),
    "max_e": (f"max({_E})", "largest error of the tip from its target, which the impedance moves"),
    "rms_e": (f"rms({_E})", "root mean square of this error"),
    "max_e_contact": (f"max({_E}, where={_TOUCHING})", "largest error in contact"),
    "rms_e_contact": (f"rms({_E}, where={_TOUCHING})", "root mean square of the error in contact"),
    "max_e_free": (f"max({_E}, where=not {_TOUCHING})", "largest error out of contact"),
    "rms_e_free": (f"rms({_E}, where=not {_TOUCHING})", "root mean square of the error out of contact"),
    "max_e_before": (f"max({_E}, where={_BEFORE})", "largest error before the first contact"),
    "max_deviation": ("max(norm(plant.x - trajectory.x_v))", "largest distance of the tip from the commanded path"),
    "end_error": ("norm(final(plant.x) - initial(plant.x))", "distance of the tip at the end from where it began"),
    "m2_hat": ("final(controller.p_hat[2])", "estimate of the second mass at the end"),
    "m2_error": (f"final({_M2_ERROR})", "error of this estimate at the end"),
    "m2_at_contact": (f"final({_M2_ERROR}, where={_BEFORE})", "error of the estimate just before the first contact"),
    "m2_in_contact": (f"max({_M2_ERROR}, where={_TOUCHING})", "largest error of the estimate in contact"),
    "m2_settled": (
        f"last_time({_M2_ERROR} > {SETTLED}, where={_BEFORE})",
        f"time from which on the error of the estimate stays within {SETTLED} kg until the first contact",
    ),
    "max_torque_1": ("max(abs(controller.tau_cmd[1]))", "largest torque that the first joint is told"),
    "max_torque_2": ("max(abs(controller.tau_cmd[2]))", "largest torque that the second joint is told"),
    "rms_torque_1": ("rms(actuator.tau[1])", "root mean square of the torque of the first joint"),
    "rms_torque_2": ("rms(actuator.tau[2])", "root mean square of the torque of the second joint"),
    "share_saturated": ("share(norm(actuator.saturated) > 0)", "share of the ticks at which a torque is limited"),
    **IN_SPACE,
}
"""Formula of each measure, as `orchestration.results.measures.parser.parse_formula` reads it, and what it says."""


def as_markdown(units: Mapping[str, str]) -> str:
    """Return the table of the ready measures for a page.

    Parameters
    ----------
    units
        Unit of each measure, by its name.
    """
    rows = (
        f"| `{name}` | {description}{f', {units[name]}' if units[name] else ''} | `{formula}` |"
        for name, (formula, description) in READY.items()
    )
    return "\n".join(("| name | says | formula |", "|---|---|---|", *rows)) + "\n"
