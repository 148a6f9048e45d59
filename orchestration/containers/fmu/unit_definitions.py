"""Merges the unit definitions of several FMUs into the one list that a description has room for.

Two FMUs may define the same name in two ways, for example ``rpm`` with and without the radian. The definition that
comes first keeps the name; another one gets the name with a number, ``rpm_2``. The same holds for display units.
"""

from collections.abc import Mapping
from typing import Any

from lxml import etree

from orchestration.fmi.document import Document

_FACTOR, _OFFSET = "factor", "offset"
_DEFAULTS = {_FACTOR: 1.0, _OFFSET: 0.0}

Meaning = tuple[tuple[str, float], ...] | None
"""Attributes of a definition as numbers, without those that have their default; None if there is no definition."""


class UnitDefinitions:
    """The units that variables of several FMUs use, each under a name of its own."""

    def __init__(self) -> None:
        self._meanings: dict[str, Meaning] = {}
        self._shown: dict[str, dict[str, Meaning]] = {}

    def unit(self, document: Document, name: str) -> str:
        """Return the merged name of a unit that an FMU uses.

        Parameters
        ----------
        document
            Description of the FMU.
        name
            Name of the unit in the FMU. The empty text, no unit, stays empty.
        """
        if not name:
            return name
        definition = _definition(document, name)
        return _entered(self._meanings, name, None if definition is None else _meaning(definition.find("BaseUnit")))

    def display_unit(self, document: Document, unit: str, name: str) -> str:
        """Return the merged name of a display unit that an FMU uses; empty if the FMU does not define it.

        Parameters
        ----------
        document
            Description of the FMU.
        unit
            Name of the unit in the FMU.
        name
            Name of the display unit in the FMU.
        """
        definition = _definition(document, unit)
        rows = [] if definition is None else definition.findall("DisplayUnit")
        found = next((row for row in rows if row.get("name") == name), None)
        if found is None:
            return ""
        return _entered(self._shown.setdefault(self.unit(document, unit), {}), name, _meaning(found))

    def write(self, root: Any) -> None:
        """Add the element ``UnitDefinitions``, sorted by names; nothing if no variable has a unit."""
        if not self._meanings:
            return
        listing = etree.SubElement(root, "UnitDefinitions")
        for name, meaning in sorted(self._meanings.items()):
            unit = etree.SubElement(listing, "Unit", name=name)
            if meaning is not None:
                etree.SubElement(unit, "BaseUnit", _attributes(meaning))
            for shown, how in sorted(self._shown.get(name, {}).items()):
                etree.SubElement(unit, "DisplayUnit", {"name": shown, **_attributes(how)})


def _definition(document: Document, name: str) -> Any:
    """Element of a unit in an FMU's description; None if it is not there."""
    rows = document.root.findall("UnitDefinitions/Unit")
    return next((row for row in rows if row.get("name") == name), None)


def _meaning(element: Any) -> Meaning:
    if element is None:
        return None
    numbers = {name: float(text) for name, text in sorted(element.attrib.items()) if name != "name"}
    return tuple((name, value) for name, value in numbers.items() if value != _DEFAULTS.get(name, 0.0))


def _entered(names: dict[str, Meaning], name: str, meaning: Meaning) -> str:
    """Enter a meaning under the first name that is free or has this meaning already."""
    candidate, n = name, 1
    while names.setdefault(candidate, meaning) != meaning:
        n += 1
        candidate = f"{name}_{n}"
    return candidate


def _attributes(meaning: Meaning) -> Mapping[str, str]:
    """Attributes of a definition; exponents are whole numbers."""
    return {name: repr(value) if name in _DEFAULTS else str(int(value)) for name, value in meaning or ()}
