"""The numbers of a run that are looked at first: contact, tracking error, estimate and saturation.

Each of them is a measure of `orchestration.paper.ready_measures`. The payload's mass follows the parameters of all
joints, so that its column depends on their number. A number is left out if the run lacks its columns.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from orchestration.paper.ready_measures import READY
from orchestration.paper.task_shape import COMMAND, ESTIMATES, SPATIAL, payload_number, shape_of
from orchestration.results.measures.parser import parse_formula
from orchestration.results.result import Result

SIZES = ("max", "rms")
PAYLOAD = "payload_hat"
MOST_JOINTS = 16  # of an arm whose estimate is looked for in a file
CHOSEN = (
    "peak_force",
    "first_contact",
    "last_contact",
    "max_e_free",
    "rms_e_free",
    "max_e_contact",
    "rms_e_contact",
    "m2_hat",
    "share_saturated",
)
"""Names of the measures of an arm in the plane."""
IN_SPACE = (
    "peak_push",
    "first_contact",
    "last_contact",
    *(f"{size}_{what}_{where}" for where in ("free", "contact") for what in ("position", "angle") for size in SIZES),
    PAYLOAD,
    "share_saturated",
)
"""Names of the measures of an arm in space."""


@dataclass(frozen=True)
class RunNumber:
    """A measure of a run.

    Attributes
    ----------
    value
        None if there is none, such as the time of the first contact in a run without a contact.
    unit
        Empty for a pure number, and where a file has no units.
    """

    value: float | None
    unit: str


def columns_needed(names: Sequence[str] = CHOSEN) -> tuple[str, ...]:
    """Return the names of the columns and arrays that some numbers are computed from, by default those in the plane."""
    formulas = [parse_formula(READY[name][0]) for name in names]
    return tuple(dict.fromkeys(column for formula in formulas for column in formula.columns))


def columns_to_read() -> tuple[str, ...]:
    """Return the names of all that the numbers of any arm may be computed from; a file has some of them."""
    estimates = (f"{ESTIMATES}[{payload_number(joints)}]" for joints in range(SPATIAL, MOST_JOINTS + 1))
    return (*columns_needed(), *columns_needed(IN_SPACE), COMMAND, *estimates)


def run_numbers(result: Result) -> dict[str, RunNumber]:
    """Compute the numbers of a run whose columns were recorded, by the names of `CHOSEN` or `IN_SPACE`."""
    found: dict[str, RunNumber] = {}
    shape = shape_of(result)
    for name in IN_SPACE if shape.size == SPATIAL else CHOSEN:
        formula = parse_formula(f"final({shape.estimate})" if name == PAYLOAD else READY[name][0])
        if len(result.time) and all(column in result for column in formula.columns):
            value = formula.evaluate(result)
            found[name] = RunNumber(value if math.isfinite(value) else None, formula.unit(result.unit))
    return found


def sentences(numbers: Mapping[str, RunNumber]) -> list[str]:
    """Say the numbers in a few lines, without those that there are not."""
    return [line for line in (_force(numbers), *_errors(numbers), _estimate(numbers), _saturated(numbers)) if line]


def _force(numbers: Mapping[str, RunNumber]) -> str:
    peak = numbers.get("peak_force") or numbers.get("peak_push")
    if peak is None or "first_contact" not in numbers:
        return ""
    if numbers["first_contact"].value is None:
        return "contact: none"
    times = " to ".join(_said(numbers[name]) for name in ("first_contact", "last_contact"))
    return f"contact: from {times}, peak force {_said(peak)}"


def _errors(numbers: Mapping[str, RunNumber]) -> list[str]:
    places = {"free": "in free motion", "contact": "in contact"}
    kinds = {"e": "", "position": " of the position", "angle": " of the orientation"}
    return [
        f"tracking error{of} {where}: at most {_said(largest)}, rms {_said(numbers[f'rms_{kind}_{place}'])}"
        for place, where in places.items()
        for kind, of in kinds.items()
        if (largest := numbers.get(f"max_{kind}_{place}")) is not None and largest.value is not None
    ]


def _estimate(numbers: Mapping[str, RunNumber]) -> str:
    for name, what in (("m2_hat", "m2"), (PAYLOAD, "the payload's mass")):
        if name in numbers:
            return f"estimate of {what} at the end: {_said(numbers[name])}"
    return ""


def _saturated(numbers: Mapping[str, RunNumber]) -> str:
    share = numbers.get("share_saturated")
    if share is None or share.value is None:
        return ""
    return f"actuators saturated: {100 * share.value:.3g} % of the ticks"


def _said(number: RunNumber) -> str:
    value = "no number" if number.value is None else f"{number.value:.4g}"
    return f"{value} {number.unit}".rstrip()
