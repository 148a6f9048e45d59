"""The interface of each role in the paper's loop: names, units, types and causality of its signals.

A unit that takes a role must have the outputs that others live on. It may leave out inputs that it does
not use; other outputs, and parameters that scenarios set, are missed by figures and claims alone.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from orchestration.check.findings import ROLE, Finding, error, note, shown, warning
from orchestration.fmi.codes import BOOLEAN, REAL
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.fmi.document import Declared, Document
from orchestration.fmi.units import Unit

JOINT, PLANE, SCALAR, OPEN = "joint", "plane", "scalar", "open"  # how many elements a signal has
_VECTOR = re.compile(r"(.+)\[(\d{1,9})\]")

UNITS: Mapping[str, Unit] = {
    "": Unit(),
    "m": Unit((("m", 1),)),
    "m/s": Unit((("m", 1), ("s", -1))),
    "m/s2": Unit((("m", 1), ("s", -2))),
    "rad": Unit((("rad", 1),)),
    "rad/s": Unit((("s", -1), ("rad", 1))),
    "rad/s2": Unit((("s", -2), ("rad", 1))),
    "N": Unit((("kg", 1), ("m", 1), ("s", -2))),
    "N.m": Unit((("kg", 1), ("m", 2), ("s", -2))),
    "s": Unit((("s", 1),)),
}


@dataclass(frozen=True)
class Signal:
    """A signal of a role's interface; its unit is None where each element has another."""

    unit: str | None
    size: str = JOINT
    type: str = REAL


@dataclass(frozen=True)
class Role:
    """What a unit in a role shows.

    Attributes
    ----------
    defining
        The output that tells the role, and whose elements count the joints if it has one per joint.
    required, expected
        Outputs without which the loop does not close; outputs that figures and claims read.
    inputs
        Inputs that the loop can serve.
    optional
        Inputs that only some units of the role have.
    """

    defining: str
    required: Mapping[str, Signal]
    expected: Mapping[str, Signal] = field(default_factory=dict)
    inputs: Mapping[str, Signal] = field(default_factory=dict)
    optional: frozenset[str] = frozenset()
    sampled: bool = True


_MOTION = {"q": Signal("rad"), "dq": Signal("rad/s"), "ddq": Signal("rad/s2")}
_VIRTUAL = {"x_v": Signal("m", PLANE), "dx_v": Signal("m/s", PLANE), "ddx_v": Signal("m/s2", PLANE)}
_SATURATED = {"saturated": Signal("", JOINT, BOOLEAN)}

ROLES: Mapping[str, Role] = {
    "controller": Role(
        "tau_cmd",
        {"tau_cmd": Signal("N.m")},
        {
            "x_t": Signal("m", PLANE),
            "dx_t": Signal("m/s", PLANE),
            "e": Signal("m", PLANE),
            "p_hat": Signal(None, OPEN),
        },
        {**_MOTION, "F_hat": Signal("N", PLANE), **_VIRTUAL, **_SATURATED},
        frozenset(_SATURATED),
    ),
    "actuator": Role("tau", {"tau": Signal("N.m")}, _SATURATED, {"tau_cmd": Signal("N.m")}),
    "sensor": Role("F_hat", {"F_hat": Signal("N", PLANE)}, {}, {"F_ext": Signal("N", PLANE)}),
    "trajectory": Role("x_v", _VIRTUAL),
    "plant": Role(
        "q",
        {**_MOTION, "x": Signal("m", PLANE), "dx": Signal("m/s", PLANE), "F_ext": Signal("N", PLANE)},
        {"gap": Signal("m", SCALAR), "penetration": Signal("m", SCALAR)},
        {"tau": Signal("N.m")},
        sampled=False,
    ),
}


def guess(document: Document) -> str | None:
    """The role whose defining output the unit has; None if that is none or several."""
    outputs = {_base(variable.name) for variable in document.of_causality("output")}
    fitting = [name for name, role in ROLES.items() if role.defining in outputs]
    return fitting[0] if len(fitting) == 1 else None


def joints(document: Document, role: Role) -> int:
    """Number of joints of the arm, at least 2."""
    signals = {**role.inputs, **role.required}
    names = [v.name for v in document.variables if (s := signals.get(_base(v.name))) and s.size == JOINT]
    defining = [name for name in names if _base(name) == role.defining] or names
    return max(2, *(int(match[2]) for name in defining if (match := _VECTOR.fullmatch(name))), 0) if defining else 2


def mapping_finds(document: Document, mapping: Mapping[str, str]) -> Iterator[Finding]:
    """Every name that is given for one of ours is that of a variable or an array."""
    names = {name for variable in document.variables for name in (variable.name, _base(variable.name))}
    for our, their in mapping.items():
        if their not in names:
            yield error(ROLE, f"There is no variable {shown(their)}, which should be the {shown(our)}.")


def interface_is_kept(document: Document, name: str) -> Iterator[Finding]:
    """Compare a unit with its role."""
    role = ROLES[name]
    n = joints(document, role)
    if n > 99:  # an index, not a number of joints
        yield error(ROLE, f"{role.defining} has an element {n}; the {name} has one for each joint.")
        return
    known = {variable.name: variable for variable in document.variables}
    for group, causality in ((role.required, "output"), (role.expected, "output"), (role.inputs, "input")):
        for base, signal in group.items():
            elements = _elements(base, signal, n, known)
            present = [known[e] for e in elements if e in known]
            for variable in present:
                yield from _compare(variable, signal, causality, document, name)
            missing = [element for element in elements if element not in known]
            if missing:
                yield from _missing(missing, present, signal, role, name)
    yield from _strangers(document, role, n, name)
    yield from _sampling(document, role, name)


def _elements(base: str, signal: Signal, n: int, known: Mapping[str, Declared]) -> list[str]:
    """Names of a signal's scalars."""
    if signal.size == SCALAR:
        return [base]
    if signal.size == OPEN:
        return [name for name in known if _base(name) == base] or [f"{base}[1]"]
    return [f"{base}[{i + 1}]" for i in range(n if signal.size == JOINT else 2)]


def _missing(missing: list[str], present: list[Declared], signal: Signal, role: Role, name: str) -> Iterator[Finding]:
    """What the lack of some elements means."""
    base, unit = _base(missing[0]), f" in {signal.unit}" if signal.unit else ""
    what = ", ".join(missing)
    if base in role.required:
        yield error(ROLE, f"The output {what}{unit} of the {name} is missing.")
    elif present:
        yield error(ROLE, f"{present[0].name} is there, but {what} of the {name}'s {base} is missing.")
    elif base in role.expected:
        yield note(ROLE, f"The output {what}{unit} of the {name} is missing; figures and claims that read it cannot.")
    elif base not in role.optional:
        yield note(ROLE, f"The input {what}{unit} of the {name} is missing; its connection is dropped.")


def _compare(variable: Declared, signal: Signal, causality: str, document: Document, name: str) -> Iterator[Finding]:
    """One scalar against its signal."""
    what = f"{variable.name} of the {name}"
    if variable.causality != causality:
        yield error(ROLE, f"{what} has causality {variable.causality}; {causality} is needed.")
    if variable.type != signal.type:
        yield error(ROLE, f"{what} is of type {variable.type}; {signal.type} is needed.")
    elif signal.unit is not None and signal.type == REAL:
        yield from _compare_units(variable, signal.unit, document, what)


def _compare_units(variable: Declared, needed: str, document: Document, what: str) -> Iterator[Finding]:
    wanted, name = UNITS[needed], shown(variable.unit)
    found = document.units.get(variable.unit)
    if not variable.unit:
        if needed:
            yield warning(ROLE, f"{what} declares no unit; {needed} is needed, and cannot be compared.")
    elif found is None and variable.unit == needed:
        yield warning(ROLE, f"{what} has the unit {needed} without a BaseUnit; it cannot be compared.")
    elif found is None:
        yield error(ROLE, f"{what} has the unit {name}; {needed or 'none'} is needed.")
    elif found != wanted:
        both = f"{what} has the unit {name} ({found}); {needed or 'none'} ({wanted}) is needed"
        if variable.unit == needed and found.without_angle() == wanted.without_angle():
            yield warning(ROLE, f"{both}: they differ in rad alone.")
        elif variable.unit != needed and found.exponents == wanted.exponents:
            yield note(ROLE, f"{what} is in {name} ({found}), not {needed}; adaptimp converts it, others may not.")
        else:
            yield error(ROLE, f"{both}.")


def _strangers(document: Document, role: Role, n: int, name: str) -> Iterator[Finding]:
    """Inputs that nothing in the loop drives."""
    served = {element for base, signal in role.inputs.items() for element in _elements(base, signal, n, {})}
    for variable in document.of_causality("input"):
        if variable.name not in served:
            why = f"no signal of the {name}'s loop has that name"
            yield warning(ROLE, f"The input {shown(variable.name)} keeps its start value: {why}.")


def _sampling(document: Document, role: Role, name: str) -> Iterator[Finding]:
    """The sampling period is a parameter in s, where there is one."""
    found = [variable for variable in document.variables if variable.name == SAMPLE_TIME]
    if role.sampled and found:
        yield from _compare(found[0], Signal("s", SCALAR), "parameter", document, name)
    elif role.sampled and any(v.variability == "continuous" for v in document.of_causality("output")):
        why = "and outputs that are not discrete: masters take it for continuous, and cannot set its period"
        yield warning(ROLE, f"The {name} has no parameter {SAMPLE_TIME} {why}.")


def _base(name: str) -> str:
    match = _VECTOR.fullmatch(name)
    return match[1] if match else name
