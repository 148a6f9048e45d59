"""SSP packages of a few lines of XML, some of which mean harm."""

from collections.abc import Mapping, Sequence

from tests.strangers.hostile.zips import Row, zipped

NAMESPACES = 'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"'
NAMESPACES += ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"'
NAMESPACES += ' xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'


def package(fmus: Mapping[str, bytes], *, structure: str = "", entries: Sequence[Row] = ()) -> bytes:
    """A package of FMUs, by the names of their components; `structure` replaces the whole description."""
    components = "".join(component(name) for name in fmus)
    xml = structure or described(f"<ssd:Elements>{components}</ssd:Elements>")
    rows = [Row(f"resources/{name}.fmu", content) for name, content in fmus.items()]
    return zipped([Row("SystemStructure.ssd", xml.encode()), *rows, *entries])


def described(inner: str, name: str = "hostile") -> str:
    """A whole SystemStructure.ssd from what is in its outermost system."""
    root = f'<ssd:SystemStructureDescription version="1.0" name="{name}" {NAMESPACES}>'
    return f'{HEAD}{root}<ssd:System name="outer">{inner}</ssd:System></ssd:SystemStructureDescription>'


def component(name: str, inner: str = "", source: str = "") -> str:
    """A component."""
    return f'<ssd:Component name="{name}" source="{source or f"resources/{name}.fmu"}">{inner}</ssd:Component>'


def connectors(**kinds: str) -> str:
    """Connectors of Reals, by name."""
    rows = (f'<ssd:Connector name="{n}" kind="{kind}"><ssc:Real/></ssd:Connector>' for n, kind in kinds.items())
    return f"<ssd:Connectors>{''.join(rows)}</ssd:Connectors>"


def wire(start: str, end: str) -> str:
    """A connection between two places such as ``a.y``; without a dot, a connector of the system itself."""
    text = ""
    for what, place in (("start", start), ("end", end)):
        element, _, connector = place.rpartition(".")
        text += f' {what}Element="{element}"' if element else ""
        text += f' {what}Connector="{connector}"'
    return f"<ssd:Connection{text}/>"
