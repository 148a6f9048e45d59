"""Compares an FMU with a role, the interface that its place in a system asks for: names, units, types, causality.

A role names the outputs that other components live on; an FMU without them is an error. An FMU may leave
out inputs that it does not use. A lack of outputs that are merely read afterwards is worth a note.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from orchestration.check.findings import ROLE, Finding, error, note, shown, warning
from orchestration.fmi.codes import REAL
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.fmi.document import Declared, Document
from orchestration.fmi.units import Unit

SCALAR, COUNTED, OPEN = 0, -1, -2  # sizes of a signal that are no number of elements
LARGEST_COUNT = 99  # above it an index is a slip of the pen, not a number of elements
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
    """A signal of a role's interface.

    Attributes
    ----------
    unit
        Its unit, a name in `UNITS`; empty for a number without a unit, None where each element has another.
    size
        Number of elements of an array; or `SCALAR`, no array; `COUNTED`, an array with as many elements as
        the FMU has of what its role counts; `OPEN`, an array of any length.
    type
        Its FMI type.
    """

    unit: str | None
    size: int
    type: str = REAL


@dataclass(frozen=True)
class Role:
    """The interface that a place in a system asks for.

    Attributes
    ----------
    name
        What messages call an FMU in this role.
    defining
        The output that tells the role, and whose elements are counted if its size is `COUNTED`.
    required, expected
        Outputs without which the system does not close; outputs that are read afterwards.
    inputs
        Inputs that the system can serve.
    optional
        Inputs that only some FMUs in the role have.
    sampled
        Whether the FMU works at a sampling period of its own, the parameter ``sample_time``.
    counted
        What an element of a `COUNTED` signal stands for, such as a joint.
    fewest
        Fewest elements of a `COUNTED` signal.
    readers
        Who reads the expected outputs, in the plural.
    """

    name: str
    defining: str
    required: Mapping[str, Signal]
    expected: Mapping[str, Signal] = field(default_factory=dict)
    inputs: Mapping[str, Signal] = field(default_factory=dict)
    optional: frozenset[str] = frozenset()
    sampled: bool = True
    counted: str = "element"
    fewest: int = 1
    readers: str = "results and reports"


def told_role(document: Document, roles: Iterable[Role]) -> Role | None:
    """The role whose defining output an FMU has; None if it has that of no role or of several."""
    outputs = {_base(variable.name) for variable in document.of_causality("output")}
    fitting = [role for role in roles if role.defining in outputs]
    return fitting[0] if len(fitting) == 1 else None


def count(document: Document, role: Role) -> int:
    """How many elements the FMU's `COUNTED` signals have, at least `Role.fewest`."""
    signals = {**role.inputs, **role.required}
    names = [v.name for v in document.variables if (s := signals.get(_base(v.name))) and s.size == COUNTED]
    defining = [name for name in names if _base(name) == role.defining] or names
    return max([role.fewest, *(int(match[2]) for name in defining if (match := _VECTOR.fullmatch(name)))])


def mapping_finds(document: Document, mapping: Mapping[str, str]) -> Iterator[Finding]:
    """Every name that is given for one of ours is that of a variable or an array."""
    names = {name for variable in document.variables for name in (variable.name, _base(variable.name))}
    for our, their in mapping.items():
        if their not in names:
            yield error(ROLE, f"There is no variable {shown(their)}, which should be the {shown(our)}.")


def interface_is_kept(document: Document, role: Role) -> Iterator[Finding]:
    """Compare an FMU with its role."""
    n = count(document, role)
    if n > LARGEST_COUNT:
        yield error(ROLE, f"{role.defining} has an element {n}; the {role.name} has one for each {role.counted}.")
        return
    known = {variable.name: variable for variable in document.variables}
    for group, causality in ((role.required, "output"), (role.expected, "output"), (role.inputs, "input")):
        for base, signal in group.items():
            elements = _elements(base, signal, n, known)
            present = [known[e] for e in elements if e in known]
            for variable in present:
                yield from _compare(variable, signal, causality, document, role.name)
            missing = [element for element in elements if element not in known]
            if missing:
                yield from _missing(missing, present, signal, role)
    yield from _strangers(document, role, n)
    yield from _sampling(document, role)


def _elements(base: str, signal: Signal, n: int, known: Mapping[str, Declared]) -> list[str]:
    """Names of a signal's scalars."""
    if signal.size == SCALAR:
        return [base]
    if signal.size == OPEN:
        return [name for name in known if _base(name) == base] or [f"{base}[1]"]
    return [f"{base}[{i + 1}]" for i in range(n if signal.size == COUNTED else signal.size)]


def _missing(missing: list[str], present: list[Declared], signal: Signal, role: Role) -> Iterator[Finding]:
    """What the lack of some elements means."""
    base, name, unit = _base(missing[0]), role.name, f" in {signal.unit}" if signal.unit else ""
    what = ", ".join(missing)
    if base in role.required:
        yield error(ROLE, f"The output {what}{unit} of the {name} is missing.")
    elif present:
        yield error(ROLE, f"{present[0].name} is there, but {what} of the {name}'s {base} is missing.")
    elif base in role.expected:
        yield note(ROLE, f"The output {what}{unit} of the {name} is missing; {role.readers} that read it cannot.")
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


def _strangers(document: Document, role: Role, n: int) -> Iterator[Finding]:
    """Inputs that nothing in the system drives."""
    served = {element for base, signal in role.inputs.items() for element in _elements(base, signal, n, {})}
    for variable in document.of_causality("input"):
        if variable.name not in served:
            why = f"no signal of the {role.name}'s loop has that name"
            yield warning(ROLE, f"The input {shown(variable.name)} keeps its start value: {why}.")


def _sampling(document: Document, role: Role) -> Iterator[Finding]:
    """The sampling period is a parameter in s, where there is one."""
    found = [variable for variable in document.variables if variable.name == SAMPLE_TIME]
    if role.sampled and found:
        yield from _compare(found[0], Signal("s", SCALAR), "parameter", document, role.name)
    elif role.sampled and any(v.variability == "continuous" for v in document.of_causality("output")):
        why = "and outputs that are not discrete: masters take it for continuous, and cannot set its period"
        yield warning(ROLE, f"The {role.name} has no parameter {SAMPLE_TIME} {why}.")


def _base(name: str) -> str:
    match = _VECTOR.fullmatch(name)
    return match[1] if match else name
