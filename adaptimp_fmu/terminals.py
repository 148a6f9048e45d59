"""Groups of variables of an FMU, called terminals, that tools may connect as one.

FMI 2.0 allows the file ``terminalsAndIcons/terminalsAndIcons.xml`` since release 2.0.4 and leaves its form to FMI 3.0,
section 2.4.9. Hence the file carries ``fmiVersion="3.0"`` in an FMU of FMI 2.0, too: there the attribute names the
version of FMI that defines the file, not the version of the FMU. A tool that does not know the file ignores it.

An icon is not among its contents: FMI 2.0 has ``model.png``.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from lxml import etree

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.files.standards import standard_file
from adaptimp_fmu.model import Model
from adaptimp_fmu.names import suggestion

TERMINALS_FILE = "terminalsAndIcons/terminalsAndIcons.xml"
FMI_VERSION = "3.0"
"""Version of FMI that defines the file."""
_SIGNAL = "signal"  # connected members are equal; the other kinds obey Kirchhoff's current law


@dataclass(frozen=True)
class Terminal:
    """A group of variables of an FMU under one name.

    Attributes
    ----------
    name
        Name of the terminal, unique in its FMU.
    members
        Names of the FMU's variables by the name that each has in the terminal. Terminals of two FMUs are connected by
        the names in the terminal.
    description
        One line for the user.
    matching_rule
        ``"plug"``: both terminals have the same members. ``"bus"``: members that the other terminal does not have stay
        unconnected.

    Examples
    --------
    >>> from adaptimp_fmu import Terminal
    >>> Terminal("plant", {"x": "plant.x", "tau": "plant.tau"}, "The arm").members["x"]
    'plant.x'
    """

    name: str
    members: Mapping[str, str]
    description: str = ""
    matching_rule: Literal["plug", "bus"] = "bus"


def terminals_and_icons(fmu: str, terminals: Sequence[Terminal], variables: Collection[str]) -> bytes:
    """Write ``terminalsAndIcons.xml``, the file that lists the terminals of an FMU.

    Parameters
    ----------
    fmu
        Name of the FMU, for messages.
    terminals
        The terminals; their order and the order of their members are kept.
    variables
        Names of the FMU's inputs, outputs and parameters: others cannot be in a terminal.

    Returns
    -------
    bytes
        The file. The same terminals give the same bytes.

    Raises
    ------
    DefinitionError
        If two terminals have one name, if a member is not a variable of the FMU, or if the file does not validate
        against FMI's schema.

    Examples
    --------
    >>> from adaptimp_fmu import Terminal, terminals_and_icons
    >>> arm = Terminal("plant", {"x": "plant.x"})
    >>> print(terminals_and_icons("Fig5", [arm], ["plant.x"]).decode().splitlines()[1])
    <fmiTerminalsAndIcons fmiVersion="3.0">
    """
    root = etree.Element("fmiTerminalsAndIcons", fmiVersion=FMI_VERSION)
    listing = etree.SubElement(root, "Terminals")
    known = dict.fromkeys(variables)
    taken: set[str] = set()
    for terminal in terminals:
        if terminal.name in taken:
            msg = f"{fmu} already has a terminal {terminal.name}; give the other one another name."
            raise DefinitionError(msg)
        taken.add(terminal.name)
        _terminal(listing, terminal, f"{fmu}: terminal {terminal.name}", known)
    schema = _schema()
    if not schema.validate(root):
        msg = f"{fmu}: {TERMINALS_FILE} is invalid: {schema.error_log.last_error}"
        raise DefinitionError(msg)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def terminals_entry(model: Model) -> Mapping[str, bytes]:
    """Return the file of a model's terminals by its name in the archive; nothing if the model has none."""
    if not model.terminals:
        return {}
    names = [variable.name for variable in model.ordered_variables()]
    terminals = []
    for terminal, groups in model.terminals.items():
        members = [element for group in groups for element in _elements(group, names)]
        terminals.append(Terminal(terminal, dict(zip(members, members, strict=True))))
    return {TERMINALS_FILE: terminals_and_icons(model.name, terminals, names)}


def _elements(group: str, names: Sequence[str]) -> list[str]:
    """Names of an array's elements; the name itself of anything else, so that a wrong name is reported."""
    return [name for name in names if name.startswith(f"{group}[")] or [group]


def _terminal(listing: Any, terminal: Terminal, where: str, known: Collection[str]) -> None:
    element = etree.SubElement(listing, "Terminal", name=terminal.name, matchingRule=terminal.matching_rule)
    if terminal.description:
        element.set("description", terminal.description)
    for member, variable in terminal.members.items():
        if variable not in known:
            msg = f"{where} holds {variable}, which is not an input, output or parameter; {suggestion(variable, known)}"
            raise DefinitionError(msg)
        attributes = {"memberName": member, "variableName": variable, "variableKind": _SIGNAL}
        etree.SubElement(element, "TerminalMemberVariable", attributes)


@cache
def _schema() -> Any:
    path = standard_file("schema", "fmi3", "fmi3TerminalsAndIcons.xsd")
    return etree.XMLSchema(etree.parse(str(path)))
