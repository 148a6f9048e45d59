"""Tables that map single values of Booleans, Integers and Enumerations to others, in parameter mappings (SSP 1.0)."""

from lxml import etree

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import BOOLEAN, ENUMERATION, INTEGER
from orchestration.ssp.schema import SSC, Xml

_TYPES = {f"{kind}MappingTransformation": kind for kind in (BOOLEAN, INTEGER, ENUMERATION)}
_TRUTH = {"1": "true", "0": "false"}


def value_map(element: Xml) -> tuple[str, dict[str, str]] | None:
    """Return the table that an element has.

    Returns
    -------
    tuple of str and dict, or None
        Type of the values, and the texts of the targets by those of the sources; None without a table.
    """
    for child in element.iterchildren(f"{{{SSC}}}*"):
        kind = _TYPES.get(etree.QName(child).localname)
        if kind is not None:
            entries = child.iterfind(f"{{{SSC}}}MapEntry")
            return kind, {_plain(kind, e.attrib["source"]): _plain(kind, e.attrib["target"]) for e in entries}
    return None


def is_identity(element: Xml) -> bool:
    """Whether an element has a table that maps each of its values to itself."""
    found = value_map(element)
    return found is not None and all(source == target for source, target in found[1].items())


def mapped_value(element: Xml, text: str, kind: str, where: str) -> str:
    """Return the text of a value after the table of an element; the same text if the element has no table.

    Parameters
    ----------
    text, kind
        Value of a parameter, and its type in the parameter set.
    where
        Name of the element, for messages.

    Raises
    ------
    SystemDescriptionError
        If the table is for values of another type, or does not have the value.
    """
    found = value_map(element)
    if found is None:
        return text
    expected, table = found
    if kind != expected:
        msg = f"{where}: a {expected}MappingTransformation does not apply to a value of type {kind}."
        raise SystemDescriptionError(msg)
    if (value := _plain(kind, text)) in table:
        return table[value]
    msg = f"{where}: the table of the transformation has {', '.join(table)}, but not {text}; add an entry."
    raise SystemDescriptionError(msg)


def _plain(kind: str, text: str) -> str:
    """Text of a value, the same for each way to write the value; the name of an item stays as it is."""
    if kind == INTEGER:
        return str(int(text))
    return _TRUTH.get(text.strip(), text.strip()) if kind == BOOLEAN else text
