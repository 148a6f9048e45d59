"""Reads modelDescription.xml of an FMU and adds the defaults of the standard, without judging the contents.

`orchestration.fmi.description` takes what a master needs from a `Document`, and the rules of `orchestration.check`
judge it. Attributes have their types only if the XML is valid against FMI's schema.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from adaptimp_fmu.files.standards import standard_file
from orchestration.errors import ArchiveError
from orchestration.fmi.codes import BOOLEAN, ENUMERATION, INTEGER, REAL, STANDS_FOR, STRING
from orchestration.fmi.units import BASE_UNITS, Unit
from orchestration.sandbox.archive import entry_names, read_entries
from orchestration.sandbox.xml import LARGEST, XmlError, parse_xml, violation

SSP_FILE = "SystemStructure.ssd"
MODEL_DESCRIPTION = "modelDescription.xml"
CALCULATED, EXACT, APPROX = "calculated", "exact", "approx"
OUTPUTS, DERIVATIVES, INITIAL_UNKNOWNS = "Outputs", "Derivatives", "InitialUnknowns"
_TRUE = ("true", "1")


class DocumentError(ArchiveError):
    """The modelDescription.xml of an FMU is missing or damaged; the message does not name the FMU's file."""


@dataclass(frozen=True)
class Declared:
    """A ScalarVariable of modelDescription.xml, with the defaults of the standard.

    Attributes
    ----------
    index
        1-based place in ModelVariables.
    type
        FMI type of the values; the values of an Enumeration are Integers.
    variability, initial
        The given value or the standard's default; `initial` is None where the standard forbids it.
    given
        Names of the attributes that the file gives.
    start
        Text of the start value, None if the file does not give one.
    limits
        Smallest and largest value, of the variable or else of its declared type.
    relative
        Whether the variable, or else its declared type, is declared as a difference of values.
    derivative
        Index of the state whose derivative the variable is.
    items
        Numbers by name of an Enumeration's items; empty for other types.
    """

    index: int
    name: str
    reference: int
    type: str
    causality: str
    variability: str
    initial: str | None
    given: frozenset[str]
    start: str | None
    limits: tuple[float | None, float | None]
    unit: str
    display_unit: str
    declared_type: str
    derivative: int | None
    relative: bool
    description: str
    items: Mapping[str, int] = field(default_factory=dict)

    @property
    def stands_for(self) -> str:
        """Type whose values a Real may have, Boolean or Integer, by the name of its declared type; else its own."""
        return STANDS_FOR.get(self.declared_type, self.type) if self.type == REAL else self.type

    @property
    def number(self) -> float | None:
        """The start value as a number; Booleans are 0 or 1."""
        if self.start is None or self.type == STRING:
            return None
        return float(self.start.strip() in _TRUE) if self.type == BOOLEAN else float(self.start)


@dataclass(frozen=True)
class Unknown:
    """A row of ModelStructure; indices are 1-based, and `dependencies` is None if the file does not give them."""

    index: int
    dependencies: tuple[int, ...] | None
    kinds: tuple[str, ...] | None


class Document:
    """The contents of an FMU's modelDescription.xml.

    Parameters
    ----------
    root
        Root element, of lxml, valid against the schema.
    mapping
        Names in the FMU of variables, or of whole arrays, by the names in the system. Other variables keep their name.
    """

    def __init__(self, root: Any, mapping: Mapping[str, str] | None = None) -> None:
        self.root = root
        self._ours = {their: our for our, their in (mapping or {}).items()}
        self.guid: str = root.get("guid")
        self.model_name: str = root.get("modelName")
        self.structured = root.get("variableNamingConvention") == "structured"
        self.co_simulation = root.find("CoSimulation")
        self.identifier: str = "" if self.co_simulation is None else self.co_simulation.get("modelIdentifier")

    def renamed(self, mapping: Mapping[str, str]) -> "Document":
        """Return the description with other names of variables; `mapping` gives the FMU's names by the new names."""
        return Document(self.root, mapping) if mapping else self

    def flag(self, name: str) -> bool:
        """Whether a capability flag of the CoSimulation element is true."""
        return self.co_simulation is not None and self.co_simulation.get(name, "false").strip() in _TRUE

    def experiment(self, name: str) -> float | None:
        """Return an attribute of DefaultExperiment as a number, None if it is not given."""
        element = self.root.find("DefaultExperiment")
        text = None if element is None else element.get(name)
        return None if text is None else float(text)

    @cached_property
    def variables(self) -> tuple[Declared, ...]:
        """All variables, in their order."""
        return tuple(self._variable(i, row) for i, row in enumerate(self._rows, start=1))

    def attributes(self, variable: Declared) -> dict[str, str]:
        """Return attributes of a variable's type element, and those of its declared type that it does not give."""
        row = self._rows[variable.index - 1]
        typed = next(child for child in row if child.tag in _TYPES)
        simple = self.types.get(typed.get("declaredType"))
        return {**({} if simple is None else simple.attrib), **typed.attrib}

    @cached_property
    def _rows(self) -> list[Any]:
        return self.root.findall("ModelVariables/ScalarVariable")

    @cached_property
    def types(self) -> Mapping[str, Any]:
        """Type elements of TypeDefinitions by name."""
        return {row.get("name"): row[0] for row in self.root.findall("TypeDefinitions/SimpleType")}

    @cached_property
    def _items(self) -> dict[str, Mapping[str, int]]:
        """Numbers of items by their names, of each declared Enumeration."""
        listings = {name: row.findall("Item") for name, row in self.types.items() if row.tag == ENUMERATION}
        return {name: {i.get("name"): _integer(i.get("value")) for i in items} for name, items in listings.items()}

    @cached_property
    def units(self) -> Mapping[str, Unit | None]:
        """Units by name; None for one without a BaseUnit."""
        return {row.get("name"): _unit(row) for row in self.root.findall("UnitDefinitions/Unit")}

    @cached_property
    def display_units(self) -> Mapping[str, frozenset[str]]:
        """Names of the display units of each unit."""
        rows = self.root.findall("UnitDefinitions/Unit")
        return {row.get("name"): frozenset(d.get("name") for d in row.findall("DisplayUnit")) for row in rows}

    def unknowns(self, listing: str) -> tuple[Unknown, ...]:
        """Rows of Outputs, Derivatives or InitialUnknowns."""
        return tuple(map(_unknown, self.root.findall(f"ModelStructure/{listing}/Unknown")))

    def of_causality(self, causality: str) -> list[Declared]:
        """Variables of a causality, in their order."""
        return [variable for variable in self.variables if variable.causality == causality]

    def _name(self, name: str) -> str:
        """Return the new name of a variable, or of the array that it is an element of."""
        base, bracket, element = name.partition("[")
        return self._ours.get(name) or self._ours.get(base, base) + bracket + element

    def _variable(self, index: int, row: Any) -> Declared:
        typed = next(child for child in row if child.tag in _TYPES)
        simple = self.types.get(typed.get("declaredType"), {})
        causality, variability = row.get("causality", "local"), row.get("variability", "continuous")
        low, high = (typed.get(name, simple.get(name)) for name in ("min", "max"))
        derivative = typed.get("derivative")
        return Declared(
            index=index,
            name=self._name(row.get("name")),
            reference=_integer(row.get("valueReference")),
            type=INTEGER if typed.tag == ENUMERATION else typed.tag,
            causality=causality,
            variability=variability,
            initial=row.get("initial", default_initial(causality, variability)),
            given=frozenset(row.attrib),
            start=typed.get("start"),
            limits=(None if low is None else float(low), None if high is None else float(high)),
            unit=typed.get("unit", simple.get("unit", "")),
            display_unit=typed.get("displayUnit", simple.get("displayUnit", "")),
            declared_type=typed.get("declaredType", ""),
            derivative=None if derivative is None else _integer(derivative),
            relative=typed.get("relativeQuantity", simple.get("relativeQuantity", "false")).strip() in _TRUE,
            description=row.get("description", ""),
            items=self._items.get(typed.get("declaredType", ""), {}) if typed.tag == ENUMERATION else {},
        )


_TYPES = (REAL, INTEGER, BOOLEAN, STRING, ENUMERATION)


def read_bytes(path: Path, most: int = LARGEST) -> bytes:
    """Read the bytes of modelDescription.xml in a safe archive.

    Raises
    ------
    DocumentError
        If the file is missing, or larger than `most` bytes.
    ArchiveError
        If the file cannot be unpacked.
    """
    content = dict(read_entries(path, [MODEL_DESCRIPTION], most + 1)).get(MODEL_DESCRIPTION)
    if content is None:
        other = "it is an SSP package, which System.read reads" if SSP_FILE in entry_names(path) else ""
        msg = f"The archive has no {MODEL_DESCRIPTION}; {other or 'every FMU has one'}."
        raise DocumentError(msg)
    if len(content) > most:
        msg = f"{MODEL_DESCRIPTION} has more than {most} bytes."
        raise DocumentError(msg)
    return content


def parsed(content: bytes) -> Any:
    """Parse a description and return its root element; entities are not resolved, and nothing is fetched.

    Raises
    ------
    DocumentError
        If the XML is not well-formed, or breaks a limit of `orchestration.sandbox.xml`.
    """
    try:
        return parse_xml(content)
    except XmlError as failed:
        msg = f"{MODEL_DESCRIPTION} {failed}."
        raise DocumentError(msg) from failed


def require_valid(root: Any) -> None:
    """Require that a description of FMI 2.0 is valid against the schema.

    Raises
    ------
    DocumentError
        If it is not; the message has the first violation, and the line and number of violations where they are known.
    """
    if found := violation(root, _schema()):
        msg = f"{MODEL_DESCRIPTION} violates the schema{found}."
        raise DocumentError(msg)


@cache
def _schema() -> Any:
    from lxml import etree

    return etree.XMLSchema(etree.parse(str(standard_file("schema", "fmi2", "fmi2ModelDescription.xsd"))))


def default_initial(causality: str, variability: str) -> str | None:
    """Return the default of the attribute `initial` (FMI 2.0.5, section 2.2.7)."""
    if causality in ("input", "independent"):
        return None
    return EXACT if causality == "parameter" or variability == "constant" else CALCULATED


def _integer(text: str) -> int:
    """Convert a text that the schema takes for an integer; Python refuses 5000 digits, even leading zeros."""
    sign = "-" if text.strip().startswith("-") else ""
    return int(sign + (text.strip().lstrip("+-0") or "0"))


def _unit(row: Any) -> Unit | None:
    base = row.find("BaseUnit")
    if base is None:
        return None
    exponents = tuple((name, power) for name in BASE_UNITS if (power := _integer(base.get(name, "0"))))
    return Unit(exponents, float(base.get("factor", "1")), float(base.get("offset", "0")))


def _unknown(row: Any) -> Unknown:
    dependencies, kinds = row.get("dependencies"), row.get("dependenciesKind")
    return Unknown(
        _integer(row.get("index")),
        None if dependencies is None else tuple(map(_integer, dependencies.split())),
        None if kinds is None else tuple(kinds.split()),
    )
