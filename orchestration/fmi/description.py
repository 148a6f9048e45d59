"""Reads the variables, units and capabilities of an FMU that a co-simulation needs.

`read_description` refuses an FMU that cannot be stepped safely. Errors of form that do not change a value are left
to `orchestration.check`.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np

from orchestration.errors import ArchiveError, SystemDescriptionError
from orchestration.fmi.codes import BOOLEAN, CAPABILITIES, INTEGER, REAL, STRING
from orchestration.fmi.document import (
    APPROX,
    DERIVATIVES,
    EXACT,
    INITIAL_UNKNOWNS,
    OUTPUTS,
    Declared,
    Document,
    DocumentError,
    parsed,
    read_bytes,
    require_valid,
)
from orchestration.fmi.experiment import UNKNOWN, Experiment
from orchestration.fmi.formalities import RULES
from orchestration.fmi.names import arrays
from orchestration.fmi.units import UnitDefinition, defined
from orchestration.sandbox.archive import screen
from orchestration.sandbox.missing import require_file
from orchestration.sandbox.xml import printed

SAMPLE_TIME = "sample_time"
"""Name of the parameter that tells a sampled component's period, s."""
LONGEST_SHOWN = 60  # characters of a name or version in a message
_VERSION = re.compile(r"1\.0|2\.0|3\.\d+([.-].*)?")  # those of FMI 3 may have a patch, or name a draft


class _Typed(Protocol):
    """What tells whether a variable is the sampling period, or a discrete output."""

    @property
    def name(self) -> str: ...
    @property
    def type(self) -> str: ...
    @property
    def causality(self) -> str: ...
    @property
    def variability(self) -> str: ...
    @property
    def unit(self) -> str: ...


_Kind = TypeVar("_Kind", bound=_Typed)


def only_discrete(outputs: Iterable[_Typed]) -> bool:
    """Return whether there are no outputs but discrete ones, Strings aside; also true without any output."""
    return all(v.type == STRING or _variability(v) == "discrete" for v in outputs)


def sampling_period(variables: Sequence[_Kind]) -> _Kind | None:
    """Return the parameter that tells the sampling period, s, of an FMU; None if the FMU is not sampled.

    An FMU is sampled if all of its outputs are discrete and it has a Real parameter ``sample_time`` in s. A parameter
    of that name with another type or unit, or beside continuous outputs, means something else.
    """
    period = (SAMPLE_TIME, "parameter", REAL, "s")
    found = next((v for v in variables if (v.name, v.causality, v.type, v.unit) == period), None)
    return found if found is None or only_discrete(v for v in variables if v.causality == "output") else None


def _variability(variable: _Typed) -> str:
    """Variability for use by a master: only a Real is continuous, whatever the default of the standard is."""
    unfit = variable.type != REAL and variable.variability == "continuous"
    return "discrete" if unfit else variable.variability


@dataclass(frozen=True)
class Variable:
    """A scalar variable of an FMU; `unit` is empty where none is declared.

    Attributes
    ----------
    start
        Start value that the FMU declares: a number, or the text of a String; None if it declares none.
    direct
        Whether an output depends on an input at the same instant. An output whose dependencies are not
        declared depends on all inputs (FMI 2.0.4, section 2.2.8).
    relative
        Whether the value is a difference, to which the offset of its unit does not apply.
    declared
        Name in the FMU, if the variable has another name in the system; see `Description.renamed`.
    initial
        How the FMU begins with the variable: exact, approx or calculated; None for an input.
    items
        Numbers by name of an Enumeration's items; empty for other types.
    stands_for
        Type whose values a Real may have: Boolean for 0 and 1, or Integer for whole numbers; empty for all others.
    """

    name: str
    reference: int
    type: str
    causality: str
    variability: str
    unit: str
    start: float | str | None
    description: str = ""
    direct: bool = False
    relative: bool = False
    declared: str = ""
    initial: str | None = None
    items: Mapping[str, int] = field(default_factory=dict)
    stands_for: str = ""

    @property
    def fmu_name(self) -> str:
        """The variable's name in the FMU."""
        return self.declared or self.name

    @property
    def can_start(self) -> bool:
        """Whether a start value can be set: of an input, or where the FMU's own is exact or approx (section 4.2.4)."""
        return self.causality == "input" or (self.variability != "constant" and self.initial in (EXACT, APPROX))


@dataclass(frozen=True, repr=False)
class Description:
    """The description of an FMU: the parts of its modelDescription.xml that a co-simulation needs.

    Attributes
    ----------
    capabilities
        Names of the flags of the co-simulation element that are true.
    formalities
        Sentences on rules of form that the FMU breaks; see `orchestration.fmi.formalities`.
    experiment
        Default experiment that the FMU suggests.
    """

    path: Path
    model_name: str
    identifier: str
    guid: str
    variables: Mapping[str, Variable]
    units: Mapping[str, UnitDefinition]
    capabilities: frozenset[str] = frozenset()
    formalities: tuple[str, ...] = ()
    experiment: Experiment = UNKNOWN

    def __repr__(self) -> str:
        """Model name, file and number of variables."""
        return f"<Description of {self.model_name}: {self.path.name}, {len(self.variables)} variables>"

    def can(self, capability: str) -> bool:
        """Whether a capability flag of the co-simulation element, such as `SAVES_STATE`, is true."""
        return capability in self.capabilities

    def of_causality(self, causality: str) -> list[Variable]:
        """Variables of a causality, in their order, without strings."""
        return list(self._by_causality.get(causality, ()))

    def elements(self, name: str) -> list[str] | None:
        """Names of the elements of an array, row by row; None if the name is not that of an array."""
        positions = None if name in self.variables else self.arrays.get(name)
        return None if positions is None else [self._names[i] for i in positions.ravel()]

    @cached_property
    def _names(self) -> tuple[str, ...]:
        return tuple(self.variables)

    @cached_property
    def arrays(self) -> Mapping[str, np.ndarray]:
        """Positions among the variables of the elements of each array, integers of its shape."""
        return arrays(self._names)

    @cached_property
    def discrete_outputs(self) -> bool:
        """Whether there are no outputs but discrete ones; also true without any output."""
        return only_discrete(self._by_causality.get("output", ()))

    @cached_property
    def sampling_period(self) -> Variable | None:
        """The parameter that tells the sampling period, s; None if the FMU is not sampled; see `sampling_period`."""
        return sampling_period(tuple(self.variables.values()))

    @cached_property
    def _by_causality(self) -> Mapping[str, Sequence[Variable]]:
        """Variables without strings, in their order, by causality."""
        found: dict[str, list[Variable]] = {}
        for variable in self.variables.values():
            if variable.type != STRING:
                found.setdefault(variable.causality, []).append(variable)
        return found

    def texts(self, causality: str) -> list[Variable]:
        """Strings of a causality, in their order."""
        return [v for v in self.variables.values() if v.causality == causality and v.type == STRING]

    def unit(self, variable: Variable) -> UnitDefinition | None:
        """The unit of a variable; None if it declares none."""
        return defined(variable.unit, self.units)

    def renamed(self, names: Mapping[str, str]) -> "Description":
        """Return the description with other names of variables, given by the names in the FMU.

        Raises
        ------
        SystemDescriptionError
            If two variables get the same name.
        """
        if not names:
            return self
        variables: dict[str, Variable] = {}
        for variable in self.variables.values():
            name = names.get(variable.fmu_name, variable.fmu_name)
            if name in variables:
                both = f"{variables[name].fmu_name} and {variable.fmu_name}"
                msg = f"{self.model_name}: {both} would both be called {name}; map the other one too."
                raise SystemDescriptionError(msg)
            declared = "" if name == variable.fmu_name else variable.fmu_name
            variables[name] = replace(variable, name=name, declared=declared)
        return replace(self, variables=variables)


def read_description(path: Path) -> Description:
    """Screen an FMU and read its description; the file is read again only when it has changed.

    Raises
    ------
    ArchiveError
        If the archive is unsafe, or not an FMI 2.0 FMU for co-simulation.
    """
    require_file(path, "FMU")
    path = path.resolve()
    status = path.stat()
    return _read_description(path, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=256)
def _read_description(path: Path, modified: int, size: int) -> Description:  # noqa: ARG001 - the cache's key
    formalities = list(screen(path))
    try:
        document = _document(path)
        _require_consistent(document)
    except DocumentError as error:
        msg = f"{path} is not a valid FMU: {error}"
        raise ArchiveError(msg) from error
    if not _names_a_file(document.identifier):
        msg = f"{path}: the model identifier {document.identifier!r} is not the name of a library."
        raise ArchiveError(msg)
    formalities += [sentence for rule in RULES for sentence in rule(document)]
    direct = _direct(document)
    return Description(
        path,
        document.model_name,
        document.identifier,
        document.guid,
        {v.name: _variable(v, direct=v.index in direct) for v in document.variables},
        {name: UnitDefinition(name, u if u and u.convertible else None) for name, u in document.units.items()},
        frozenset(filter(document.flag, CAPABILITIES)),
        tuple(formalities),
        Experiment(*(document.experiment(name) for name in ("startTime", "stopTime", "tolerance", "stepSize"))),
    )


def _names_a_file(identifier: str) -> bool:
    """Whether an identifier with an extension is a file in a given folder, on every platform."""
    return identifier.isprintable() and identifier.strip(". ") != "" and not set(identifier) & set('/\\:*?"<>|')


def _document(path: Path) -> Document:
    """The document of an FMU of the right kind, valid against the schema."""
    root = parsed(read_bytes(path))
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or not _VERSION.fullmatch(version or ""):
        found = f"{printed(root.tag, LONGEST_SHOWN)} with the fmiVersion {printed(version, LONGEST_SHOWN)}"
        msg = f"the root element is {found}, which is not a version of FMI."
        raise DocumentError(msg)
    exchange = root.find("CoSimulation") is None and root.find("Implementation") is None
    if version != "2.0" or exchange:
        scheduled = exchange and root.find("ScheduledExecution") is not None and root.find("ModelExchange") is None
        kind = "scheduled execution" if scheduled else "model exchange" if exchange else "co-simulation"
        msg = f"{path} is an FMI {version} FMU for {kind}; one of FMI 2.0 for co-simulation is needed."
        raise ArchiveError(msg)
    require_valid(root)
    return Document(root)


def _require_consistent(document: Document) -> None:
    """Require that names are unique, and that every reference to a variable or a type has a target.

    Raises
    ------
    DocumentError
    """
    seen: set[str] = set()
    n = len(document.variables)
    for variable in document.variables:
        if variable.name in seen:
            msg = f"the variable name {printed(variable.name, LONGEST_SHOWN)!r} is used more than once."
            raise DocumentError(msg)
        seen.add(variable.name)
        if variable.declared_type and variable.declared_type not in document.types:
            msg = f"{variable.name}: the type {variable.declared_type!r} is not declared."
            raise DocumentError(msg)
        if variable.derivative is not None and not 1 <= variable.derivative <= n:
            msg = f"{variable.name}: derivative {variable.derivative} is not the index of a variable; there are {n}."
            raise DocumentError(msg)
    period = sampling_period(document.variables)
    if period is not None and period.number is None:
        msg = f"the parameter {SAMPLE_TIME} has no start value, so the sampling period is unknown."
        raise DocumentError(msg)
    for listing in (OUTPUTS, DERIVATIVES, INITIAL_UNKNOWNS):
        for row in document.unknowns(listing):
            for index in (row.index, *(row.dependencies or ())):
                if not 1 <= index <= n:
                    msg = f"{listing}: the index {index} is not that of a variable; there are {n}."
                    raise DocumentError(msg)


def _direct(document: Document) -> set[int]:
    """Indices of outputs that depend on an input at the same instant."""
    inputs = {v.index for v in document.of_causality("input")}
    declared = {row.index: row.dependencies for row in document.unknowns(OUTPUTS)}
    outputs = (v.index for v in document.of_causality("output"))
    dependencies = {index: declared.get(index) for index in outputs}
    return {i for i, found in dependencies.items() if inputs and (found is None or not inputs.isdisjoint(found))}


def _variable(declared: Declared, *, direct: bool) -> Variable:
    """Return a variable for use by a master."""
    return Variable(
        name=declared.name,
        reference=declared.reference,
        type=declared.type,
        causality=declared.causality,
        variability=_variability(declared),
        unit=declared.unit,
        start=declared.start if declared.type == STRING else declared.number,
        description=declared.description,
        direct=direct,
        relative=declared.relative,
        initial=declared.initial,
        items=declared.items,
        stands_for=declared.stands_for if declared.stands_for != declared.type else "",
    )


def parse_value(text: str | float, kind: str) -> float:
    """Convert the text of a start value to a number; Booleans are 0 or 1.

    Raises
    ------
    ValueError
        If the text is not a value of that type.
    KeyError
        If the text is not a Boolean.
    """
    if kind == BOOLEAN:
        values = {"true": 1.0, "1": 1.0, "1.0": 1.0, "false": 0.0, "0": 0.0, "0.0": 0.0}
        return values[str(text).strip().lower()]
    number = float(text)
    if kind == INTEGER and not (number.is_integer() and -(2**31) <= number < 2**31):
        msg = f"{text!r} is not an integer of 32 bits"  # ctypes would wrap a longer one
        raise ValueError(msg)
    return number
