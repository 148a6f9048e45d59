"""Brings an XML document of another tool into the form of SSP 1.0, as far as its meaning stays the same.

Two kinds of documents are changed before they are compared with the schemas of SSP 1.0:

- Documents of SSP 2.0. The namespaces are those of SSP 1.0, and Float64 and Int32 are Real and Integer of FMI 2.0.
  What FMI 2.0 does not have is refused: arrays, clocks, structural parameters and numbers of other sizes.
- Documents of SSP 1.0 that break a rule of form which no reader needs: empty lists, and elements in another order.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from lxml import etree

from orchestration.errors import SystemDescriptionError

if TYPE_CHECKING:
    from orchestration.ssp.schema import Xml

_NAMESPACES = "{http://ssp-standard.org/SSP1/"
_SSC = f"{_NAMESPACES}SystemStructureCommon}}"
_LISTS = (
    *("Connectors", "Elements", "Connections", "ParameterBindings", "SignalDictionaries"),
    *("GraphicalElements", "Annotations", "Units", "Enumerations"),
)
_ELEMENT = ("Connectors", "ElementGeometry", "ParameterBindings")
_ORDERS = {
    "SystemStructureDescription": ("System", "Enumerations", "Units", "DefaultExperiment", "Annotations"),
    "Component": (*_ELEMENT, "Annotations"),
    "System": (
        *(*_ELEMENT, "Elements", "Connections", "SignalDictionaries", "SystemGeometry"),
        *("GraphicalElements", "Annotations"),
    ),
}
_SAME_TYPE = {"Float64": "Real", "Int32": "Integer"}
_OTHER_TYPES = ("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "Int64", "UInt64", "Clock")
_NOT_READ = ("MetaData", "Signature")
_NOT_CONNECTED = ("constant", "local", "unspecified")
_ROOTS = ("SystemStructureDescription", "ParameterSet", "ParameterMapping", "SignalDictionary")


def brought_into_form(root: "Xml", where: str) -> list[str]:
    """Change a document so that it fits the schemas of SSP 1.0, where its meaning allows it.

    Parameters
    ----------
    root
        Root element, which is changed in place.
    where
        Names of the package and of the document, for messages.

    Returns
    -------
    list of str
        A sentence if the document breaks a rule of form.

    Raises
    ------
    SystemDescriptionError
        If a document of SSP 2.0 needs what FMI 2.0 does not have.
    """
    if (root.get("version") or "").startswith("2."):
        for element in list(_known(root)):
            _from_version_2(element, where)
    broken = sorted({rule for element in list(_known(root)) for rule in _mended(element)})
    return [f"{where} breaks a rule of SSP that no reader needs: it has {' and '.join(broken)}."] if broken else []


def _known(root: "Xml") -> Iterator["Xml"]:
    """Elements of SSP below an element, with the element itself."""
    return (e for e in root.iter() if str(e.tag).startswith(_NAMESPACES))


def _from_version_2(element: "Xml", where: str) -> None:
    """Turn an element of SSP 2.0 into one of SSP 1.0."""
    name, parent = etree.QName(element).localname, element.getparent()
    if parent is not None and name in _NOT_READ:
        parent.remove(element)
    elif parent is not None and name == "Connector" and element.get("kind") in _NOT_CONNECTED:
        parent.remove(element)
    elif name in _SAME_TYPE:
        element.tag = str(element.tag)[: -len(name)] + _SAME_TYPE[name]
    elif name in _ROOTS:
        element.set("version", "1.0")
    if lacking := _not_in_fmi_2(element, name):
        owner = next((e.get("name") for e in (element, *element.iterancestors()) if e.get("name")), name)
        msg = f"{where}: {owner} {lacking}, which FMI 2.0 does not have; export the system as SSP 1.0."
        raise SystemDescriptionError(msg)


def _not_in_fmi_2(element: "Xml", name: str) -> str:
    """What an element has that FMI 2.0 does not have, as the end of a sentence; empty if it has nothing of the kind."""
    if name in _OTHER_TYPES:
        return "has a clock" if name == "Clock" else f"is of type {name}"
    if name == "Dimension" or {"startIndices", "endIndices"} & {*map(str, element.attrib)}:
        return "is an array"
    if name == "Connector" and element.get("kind") == "structuralParameter":
        return "is a structural parameter"
    if name == "Component" and element.get("implementation") == "ScheduledExecution":
        return "is to be run by scheduled execution"
    return ""


def _mended(element: "Xml") -> Iterator[str]:
    """Mend what breaks rules of form in an element, and name what is mended."""
    name, parent = etree.QName(element).localname, element.getparent()
    if parent is not None and name in _LISTS and not len(element):
        parent.remove(element)
        yield "empty lists"
    elif name == "Annotation" and not str(element.tag).startswith(_SSC):
        element.tag = f"{_SSC}{name}"
        yield "annotations in a wrong namespace"
    order = _ORDERS.get(name, ())
    places = [order.index(child) for child in map(_local, element) if child in order]
    if order and places != sorted(places) and len(places) == len(element):
        element[:] = sorted(element, key=lambda child: order.index(_local(child)))
        yield "elements in another order"


def _local(element: "Xml") -> str:
    return etree.QName(element).localname if isinstance(element.tag, str) else ""
