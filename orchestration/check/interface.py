"""Compares the variables of an FMU with a role: the names, units, types and causalities that a system asks for.

A role names the outputs that other components need. An FMU that lacks such an output is an error. An FMU may leave
out inputs that it does not use. If an output is missing that is only read after a run, that is a note.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from orchestration.check.findings import ROLE, Finding, error, note, shown, warning
from orchestration.fmi.codes import REAL
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.fmi.document import Declared, Document
from orchestration.fmi.units import Unit

SCALAR, COUNTED, OPEN, FORMED = 0, -1, -2, -3  # sizes of a signal that are no number of elements
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
        Name of the signal's unit in `UNITS`. The name is empty for a number without a unit. None means that
        elements have different units.
    size
        Number of elements of an array. `SCALAR` is a scalar, `COUNTED` an array with one element for each thing that
        the role counts, `OPEN` an array of any length, and `FORMED` an array in one of its `forms`.
    type
        FMI type of the signal.
    forms
        Units of all elements, for each length that the array may have, the shortest first. Such a signal has no other
        unit. All `FORMED` arrays of an FMU have the same length.
    other
        Name of a unit that elements of a `COUNTED` array may have instead, such as that of a joint that slides. It is
        allowed in an FMU with `Role.others_from` elements or more.
    """

    unit: str | None
    size: int
    type: str = REAL
    forms: tuple[tuple[str, ...], ...] = ()
    other: str | None = None


@dataclass(frozen=True)
class Role:
    """The interface that an FMU must have to take a certain place in a system.

    Attributes
    ----------
    name
        Name of the role in messages.
    defining
        Name of the output that only FMUs in this role have. Its elements are counted if its size is `COUNTED`.
    required, expected
        Outputs that other components need, and outputs that are only read after a run.
    inputs
        Inputs that the system can connect.
    optional
        Inputs that only some FMUs in the role have.
    sampled
        Whether the FMU works at a sampling period of its own, the parameter ``sample_time``.
    counted
        Name of the thing that an element of a `COUNTED` signal stands for, such as a joint.
    fewest
        Smallest allowed number of elements of a `COUNTED` signal.
    others_from
        Smallest number of elements at which an element may have the unit `Signal.other`; None allows it never.
    readers
        Readers of the expected outputs, a noun in the plural.

    Examples
    --------
    A brake must have one output, and may have one input:

    >>> from orchestration.check import Role
    >>> from orchestration.check.interface import SCALAR, Signal
    >>> brake = Role("brake", "tau", {"tau": Signal("N.m", SCALAR)}, inputs={"dq": Signal("rad/s", SCALAR)})
    >>> brake.name, brake.required["tau"].unit
    ('brake', 'N.m')
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
    others_from: int | None = None
    readers: str = "results and reports"


def told_role(document: Document, roles: Iterable[Role]) -> Role | None:
    """Return the role whose defining output an FMU has; None if the FMU fits none of the roles, or several."""
    outputs = {_base(variable.name) for variable in document.of_causality("output")}
    fitting = [role for role in roles if role.defining in outputs]
    return fitting[0] if len(fitting) == 1 else None


def count(document: Document, role: Role) -> int:
    """Return the number of elements of the FMU's `COUNTED` signals, at least `Role.fewest`."""
    signals = {**role.inputs, **role.required}
    names = [v.name for v in document.variables if (s := signals.get(_base(v.name))) and s.size == COUNTED]
    defining = [name for name in names if _base(name) == role.defining] or names
    return max([role.fewest, *(int(match[2]) for name in defining if (match := _VECTOR.fullmatch(name)))])


def form(document: Document, role: Role) -> int:
    """Return the number of elements of the FMU's `FORMED` signals: the shortest form that holds all of them.

    Arrays that are longer than every form take the longest. A role without such signals has 0.
    """
    signals = {**role.inputs, **role.required}
    lengths = sorted({len(units) for signal in signals.values() for units in signal.forms})
    found = 0
    for variable in document.variables:
        match = _VECTOR.fullmatch(variable.name)
        if match and match[1] in signals and signals[match[1]].size == FORMED:
            found = max(found, int(match[2]))
    return next((length for length in lengths if length >= found), max(lengths, default=0))


def mapping_finds(document: Document, mapping: Mapping[str, str]) -> Iterator[Finding]:
    """Report every name in a mapping that the FMU has neither for a variable nor for an array."""
    names = {name for variable in document.variables for name in (variable.name, _base(variable.name))}
    for our, their in mapping.items():
        if their not in names:
            yield error(ROLE, f"There is no variable {shown(their)}, which should be the {shown(our)}.")


def interface_is_kept(document: Document, role: Role) -> Iterator[Finding]:
    """Compare the variables of an FMU with its role and report what differs."""
    n = count(document, role)
    if n > LARGEST_COUNT:
        yield error(ROLE, f"{role.defining} has an element {n}; the {role.name} has one for each {role.counted}.")
        return
    known = {variable.name: variable for variable in document.variables}
    sizes = _Sizes(n, form(document, role))
    mixed = role.others_from is not None and n >= role.others_from
    for group, causality in ((role.required, "output"), (role.expected, "output"), (role.inputs, "input")):
        for base, signal in group.items():
            elements = _elements(base, signal, sizes, known)
            present = [known[e] for e in elements if e in known]
            for variable in present:
                alike = _element_of(signal, variable, sizes, document if mixed else None)
                yield from _compare(variable, alike, causality, document, role.name)
            missing = [element for element in elements if element not in known]
            if missing:
                yield from _missing(missing, present, [_unit_of(signal, element, sizes) for element in missing], role)
    yield from _strangers(document, role, sizes)
    yield from _sampling(document, role)


@dataclass(frozen=True)
class _Sizes:
    """Number of counted things, and of elements of `FORMED` signals."""

    counted: int
    formed: int


def _unit_of(signal: Signal, name: str, sizes: _Sizes) -> str | None:
    """The unit of one of the elements of a signal."""
    match = _VECTOR.fullmatch(name)
    units = next((units for units in signal.forms if len(units) == sizes.formed), ())
    index = int(match[2]) - 1 if match else len(units)
    return units[index] if index < len(units) else signal.unit


def _element_of(signal: Signal, variable: Declared, sizes: _Sizes, mixed: Document | None) -> Signal:
    """The signal with the unit of one of its elements; `mixed` is the FMU if the other unit is allowed, too."""
    if mixed is not None and signal.other is not None:
        found = mixed.units.get(variable.unit)
        if found is not None and found.exponents == UNITS[signal.other].exponents:
            return replace(signal, unit=signal.other)
    return replace(signal, unit=_unit_of(signal, variable.name, sizes))


def _elements(base: str, signal: Signal, sizes: _Sizes, known: Mapping[str, Declared]) -> list[str]:
    """Return the names of the scalar variables of a signal."""
    if signal.size == SCALAR:
        return [base]
    if signal.size == OPEN:
        return [name for name in known if _base(name) == base] or [f"{base}[1]"]
    size = {COUNTED: sizes.counted, FORMED: sizes.formed}.get(signal.size, signal.size)
    return [f"{base}[{i + 1}]" for i in range(size)]


def _missing(
    missing: list[str], present: list[Declared], needed: Iterable[str | None], role: Role
) -> Iterator[Finding]:
    """Report elements of a signal that the FMU lacks; `needed` are their units."""
    base, name = _base(missing[0]), role.name
    units = dict.fromkeys(unit for unit in needed if unit)
    unit = f" in {' and '.join(units)}" if units else ""
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
    """Compare a scalar variable with the signal that it belongs to."""
    what = f"{variable.name} of the {name}"
    if variable.causality != causality:
        yield error(ROLE, f"{what} has causality {variable.causality}; {causality} is needed.")
    if signal.type not in (variable.type, variable.stands_for):
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


def _strangers(document: Document, role: Role, sizes: _Sizes) -> Iterator[Finding]:
    """Report inputs that nothing in the system drives."""
    served = {element for base, signal in role.inputs.items() for element in _elements(base, signal, sizes, {})}
    for variable in document.of_causality("input"):
        if variable.name not in served:
            why = f"no signal of the {role.name}'s loop has that name"
            yield warning(ROLE, f"The input {shown(variable.name)} keeps its start value: {why}.")


def _sampling(document: Document, role: Role) -> Iterator[Finding]:
    """Report a sampled FMU whose sampling period is not a parameter in s."""
    found = [variable for variable in document.variables if variable.name == SAMPLE_TIME]
    if role.sampled and found:
        yield from _compare(found[0], Signal("s", SCALAR), "parameter", document, role.name)
    elif role.sampled and any(v.variability == "continuous" for v in document.of_causality("output")):
        why = "and outputs that are not discrete: masters take it for continuous, and cannot set its period"
        yield warning(ROLE, f"The {role.name} has no parameter {SAMPLE_TIME} {why}.")


def _base(name: str) -> str:
    match = _VECTOR.fullmatch(name)
    return match[1] if match else name
