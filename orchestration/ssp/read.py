"""Reading of an SSP package; nested systems become one flat system.

A component ``motor`` in a system ``drive`` gets the name ``drive__motor``. A connection through the connectors of
several systems becomes one connection between two components. All conversions of units and linear
transformations on the way become one factor and one offset.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path
from urllib.parse import unquote

from orchestration.errors import ArchiveError, OrchestrationError, SystemDescriptionError
from orchestration.fmi.blame import blaming
from orchestration.fmi.description import read_description
from orchestration.fmi.units import UnitDefinition, defined
from orchestration.ssp.connectors import Element, Home, Wiring
from orchestration.ssp.experiment import read_experiment
from orchestration.ssp.parameters import start_values
from orchestration.ssp.schema import (
    ASSUMPTIONS_ANNOTATION,
    DEFINITION_TYPE,
    FMU_TYPE,
    NAMES_ANNOTATION,
    PACKAGE_TYPE,
    SSC,
    Package,
    Xml,
    read_units,
    required,
    ssd,
)
from orchestration.ssp.variants import variants_in
from orchestration.system.component import Component, Connection
from orchestration.system.system import System

MOST_NESTED = 500  # packages within packages, all together
SEPARATOR = "__"  # between the names of a system and its component; a name must not contain a dot


def read_ssp(path: Path, variant: str | None = None) -> System:
    """Read a coupled system from an SSP package.

    Parameters
    ----------
    path
        SSP package; or a folder with the files of one, or an .ssd file beside them.
    variant
        Name of another .ssd file in the package than ``SystemStructure.ssd``, with its suffix or without.

    Returns
    -------
    System
        Flat system. Its notices list the parts of the package that have no effect.

    Raises
    ------
    ArchiveError
        If the package is unsafe, incomplete or invalid.
    SystemDescriptionError
        If the package describes a system that cannot be run here, or has no such variant.

    Examples
    --------
    >>> from orchestration import scenario
    >>> from orchestration.ssp import read_ssp
    >>> read_ssp(scenario("fig2").write("fig2.ssp"))
    <System fig2: 5 components (...), 20 connections, step 0.0001 s, stop time 2 s>
    """
    package = Package.open(path, variant)
    try:
        return _system(package, path)
    except OrchestrationError:
        package.discard()  # what is refused takes no more place in the cache than before
        raise


def _system(package: Package, path: Path) -> System:
    """Read the system of an unpacked package."""
    root = package.structure()
    reading = _Reading(Home(package, read_units(root)))
    outer = reading.system(required(root, ssd("System")), ())
    wiring = Wiring(str(path), outer)
    reading.notices += wiring.undriven()
    start, notices = start_values(wiring)
    names = {component.name: _names(element, path) for component, element in reading.found}
    components = tuple(
        replace(component, description=component.description.renamed(names[component.name]))
        for component, _ in reading.found
    )
    connections = tuple(_renamed(connection, names) for connection in wiring.connections())
    values = {
        f"{component}.{names[component].get(variable, variable)}": value
        for component, of_component in start.items()
        for variable, value in of_component.items()
    }
    options = read_experiment(root, path)
    said = (*package.formalities, *options.get("notices", ()), *reading.notices, *notices)
    options["notices"] = tuple(dict.fromkeys(said))
    assumptions = {
        item.get("variable") or "": item.get("text") or "" for item in _items(outer.xml, ASSUMPTIONS_ANNOTATION)
    }
    system = System(root.attrib["name"], components, connections, **options).set(values)
    return replace(system, assumptions=assumptions)


def variants_of(path: Path) -> list[str]:
    """Return the names of the .ssd files in a package or folder, without the suffix, the default one first.

    Raises
    ------
    ArchiveError
        If the package is missing, unsafe or invalid.
    """
    return variants_in(Package.at(path).folder)


@dataclass
class _Reading:
    """Reader of all systems and components of a package, from the outermost system inwards.

    Attributes
    ----------
    home
        The package that is read; within a component that is a package, that one.
    within
        Files of the packages and .ssd files around the one that is read.
    opened
        Files of all packages and .ssd files that components refer to.
    """

    home: Home
    found: list[tuple[Component, Xml]] = field(default_factory=list)
    notices: list[str] = field(default_factory=list)
    paths: dict[str, str] = field(default_factory=dict)
    within: tuple[Path, ...] = ()
    opened: list[Path] = field(default_factory=list)

    @property
    def package(self) -> Package:
        """The package that is read."""
        return self.home.package

    def system(self, xml: Xml, path: tuple[str, ...]) -> Element:
        """Read a system and all its elements."""
        element = Element(path, xml, None, self.connectors(xml), [(xml, self.home)])
        for child in xml.iterfind(ssd("Elements/*")):
            name = child.get("name")
            if not name or name in element.children:
                msg = (
                    f"{self.package.path}: the element name {name!r} is empty, or is used twice"
                    f" in system {xml.get('name')}."
                )
                raise SystemDescriptionError(msg)
            if child.tag == ssd("System"):
                element.children[name] = self.system(child, (*path, name))
            elif child.tag == ssd("Component"):
                element.children[name] = self.component(child, (*path, name))
            else:
                dotted = ".".join((*path, name))
                msg = f"{self.package.path}: {dotted} refers to a signal dictionary, which is not supported."
                raise SystemDescriptionError(msg)
        return element

    def component(self, xml: Xml, path: tuple[str, ...]) -> Element:
        """Read a component, and give it the name that it has in the flat system."""
        dotted, flat = ".".join(path), SEPARATOR.join(path).replace(".", SEPARATOR)
        kind = xml.get("type") or FMU_TYPE
        if kind in (PACKAGE_TYPE, DEFINITION_TYPE):
            return self.nested(xml, path)
        if kind != FMU_TYPE or xml.get("implementation") == "ModelExchange":
            what = f"of type {kind}" if kind != FMU_TYPE else "to be run as model exchange"
            msg = f"{self.package.path}: component {dotted} is {what}; only FMUs for co-simulation are run."
            raise SystemDescriptionError(msg)
        if flat in self.paths:
            msg = f"{self.package.path}: {self.paths[flat]} and {dotted} would both be called {flat}; rename one."
            raise SystemDescriptionError(msg)
        self.paths[flat] = dotted
        if any("." in name for name in path):
            self.notices.append(f"The component {dotted} is called {flat}, because a name in a system has no dot.")
        file = self.package.file(xml.get("source"))
        with blaming(f"{self.package.path}: component {dotted} ({xml.get('source')})", file):
            component = Component(flat, read_description(file))
        self.found.append((component, xml))
        return Element(path, xml, component, self.connectors(xml), [(xml, self.home)])

    def nested(self, xml: Xml, path: tuple[str, ...]) -> Element:
        """Read a component that is a package or an .ssd file itself, as a system in the system."""
        source, _, variant = (xml.get("source") or "").partition("#")
        file, dotted = self.package.file(source), ".".join(path)
        self.opened.append(file)
        if file in self.within or len(self.opened) > MOST_NESTED:
            why = "contains itself" if file in self.within else f"is one of over {MOST_NESTED} packages in packages"
            msg = f"{self.package.path}: component {dotted}, {source}, {why}."
            raise SystemDescriptionError(msg)
        if xml.get("type") == PACKAGE_TYPE:
            package = Package.open(file, unquote(variant) or None, self.package)
            package.path = self.package.path / source
        else:
            package = self.package.definition(file)
        root = package.structure()
        inner = replace(self, home=Home(package, read_units(root)), within=(*self.within, file))
        element = inner.system(required(root, ssd("System")), path)
        self.notices += package.formalities
        element.bindings.append((xml, self.home))
        return element

    def connectors(self, xml: Xml) -> dict[str, tuple[str, UnitDefinition | None]]:
        """Read the kind and the unit of each connector of a system or component."""
        found = {}
        for connector in xml.iterfind(ssd("Connectors/Connector")):
            typed = connector.find(f"{{{SSC}}}Real")
            unit = typed.get("unit") if typed is not None else None
            found[connector.attrib["name"]] = (connector.attrib["kind"], defined(unit, self.home.units))
        return found


def _names(xml: Xml, path: Path) -> dict[str, str]:
    """Names of renamed variables in the system, by their names in the FMU."""
    found: dict[str, str] = {}
    for item in _items(xml, NAMES_ANNOTATION):
        in_fmu, in_system = item.get("fmu"), item.get("variable")
        if not in_fmu or not in_system:
            msg = f"{path}: the annotation {NAMES_ANNOTATION} of {xml.get('name')} is incomplete."
            raise ArchiveError(msg)
        found[in_fmu] = in_system
    return found


def _renamed(connection: Connection, names: dict[str, dict[str, str]]) -> Connection:
    """Connection with the names of variables in the system instead of the names in the FMUs."""
    output = names[connection.source].get(connection.output, connection.output)
    input_ = names[connection.target].get(connection.input, connection.input)
    return replace(connection, output=output, input=input_)


def _items(xml: Xml, kind: str) -> list[Xml]:
    """Items of an annotation that this project has added to an element."""
    return xml.findall(f"{ssd('Annotations')}/{{{SSC}}}Annotation[@type='{kind}']/*/item")
