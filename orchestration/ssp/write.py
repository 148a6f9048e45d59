"""Writing of a coupled system as an SSP package; the same system always gives the same bytes."""

import re
import zipfile
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from lxml import etree

from adaptimp_fmu.files.whole_file import whole_file
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import BOOLEAN, ENUMERATION, INTEGER, REAL, STRING
from orchestration.fmi.description import Variable
from orchestration.fmi.units import Unit, UnitDefinition
from orchestration.sandbox.zip.names import names_a_device
from orchestration.ssp.diagram import Box, diagram
from orchestration.ssp.geometry import place_component, place_connection, place_connector, place_system
from orchestration.ssp.schema import (
    ASSUMPTIONS_ANNOTATION,
    FMU_TYPE,
    NAMES_ANNOTATION,
    PARAMETER_SET_TYPE,
    SSC,
    SSD,
    SSV,
    STEP_ANNOTATION,
    STRUCTURE,
    VALUES,
    Xml,
    serialized,
)
from orchestration.system.component import Component, Connection, unit_scale
from orchestration.system.system import System

PARAMETER_SET = "parameters"  # one name for all sets, because the tool ecos selects sets by name
_Key = TypeVar("_Key")
_LONGEST_STEM = 100  # characters of a file name before its suffix
_EPOCH = (1980, 1, 1, 0, 0, 0)


def write_ssp(system: System, path: Path) -> Path:
    """Write a coupled system as an SSP package.

    Parameters
    ----------
    system
        System to write.
    path
        File to write. An existing file is replaced when the new file is complete.

    Returns
    -------
    Path
        The path of the package.

    Raises
    ------
    SystemDescriptionError
        If XML cannot hold a name or an assumption, or the schemas of SSP refuse the result.
    """
    fmus = _fmu_files(system)
    sets = _unique({c.name: c.name for c in system.components if c.start}, ".ssv")
    try:
        entries = {"SystemStructure.ssd": _structure(system, fmus, sets)}
        for component in system.components:
            if component.start:
                entries[f"resources/{sets[component.name]}"] = _parameter_set(component, system.assumptions)
    except ValueError as error:  # lxml refuses characters that XML does not allow
        msg = f"{system.name!r}: a name or an assumption cannot be written: {error}"
        raise SystemDescriptionError(msg) from error
    for source, name in fmus.items():
        entries[f"resources/{name}"] = source.read_bytes()
    with whole_file(path) as file, zipfile.ZipFile(file, "w") as archive:
        for name, content in entries.items():
            info = zipfile.ZipInfo(name, _EPOCH)
            info.external_attr = 0o100644 << 16
            stored = name.endswith(".fmu")  # an FMU is already compressed
            info.compress_type = zipfile.ZIP_STORED if stored else zipfile.ZIP_DEFLATED
            archive.writestr(info, content)
    return path


class _Units:
    """List of unit definitions in a document; a second definition of one name gets a number after the name."""

    def __init__(self) -> None:
        self.names: dict[str, UnitDefinition] = {}

    def name(self, unit: UnitDefinition | None) -> str | None:
        """Return the name of a unit in the document; None if the FMU gives no definition of the unit."""
        if unit is None or unit.meaning is None:
            return None
        name, count = unit.name, 1
        while not self.names.setdefault(name, unit).equivalent(unit):
            count += 1
            name = f"{unit.name}_{count}"
        return name

    def write(self, root: Xml, namespace: str) -> None:
        """Add the list of all named units to a document."""
        if not self.names:
            return
        listing = etree.SubElement(root, f"{{{namespace}}}Units")
        for name, unit in sorted(self.names.items()):
            meaning = unit.meaning or Unit()
            base = {symbol: str(power) for symbol, power in meaning.exponents}
            if meaning.factor != 1:
                base["factor"] = _real(meaning.factor)
            if meaning.offset != 0:
                base["offset"] = _real(meaning.offset)
            element = etree.SubElement(listing, f"{{{SSC}}}Unit", name=name)
            etree.SubElement(element, f"{{{SSC}}}BaseUnit", base)


def _fmu_files(system: System) -> dict[Path, str]:
    """File names in the package by FMU; different FMUs with one file name get different names."""
    owners: dict[Path, str] = {}
    for component in system.components:
        owners.setdefault(component.description.path, component.name)
    stems = Counter(path.stem for path in owners)
    wanted = {p: p.stem if stems[p.stem] == 1 else f"{owner}.{p.stem}" for p, owner in owners.items()}
    return _unique(wanted, ".fmu")


def _unique(wanted: dict[_Key, str], extension: str) -> dict[_Key, str]:
    """File names that are valid on every platform, and differ even on a file system that ignores case."""
    files: dict[_Key, str] = {}
    taken: set[str] = set()
    counts: Counter[str] = Counter()
    for key, name in wanted.items():
        plain = re.sub(r"[^A-Za-z0-9._+-]", "_", name)[:_LONGEST_STEM]
        plain = stem = f"_{plain}" if names_a_device(plain) else plain
        while stem.casefold() in taken:
            counts[plain] += 1
            stem = f"{plain}_{counts[plain] + 1}"
        taken.add(stem.casefold())
        files[key] = f"{stem}{extension}"
    return files


def _structure(system: System, fmus: dict[Path, str], sets: dict[str, str]) -> bytes:
    """Content of ``SystemStructure.ssd``, from file names of FMUs by path and of parameter sets by component."""
    root = etree.Element(
        f"{{{SSD}}}SystemStructureDescription",
        {"version": "1.0", "name": system.name, "generationTool": "adaptimp"},
        nsmap={"ssd": SSD, "ssc": SSC, "ssv": SSV},
    )
    outer = etree.SubElement(root, f"{{{SSD}}}System", name=system.name)
    elements = etree.SubElement(outer, f"{{{SSD}}}Elements")
    units, layout = _Units(), diagram(system)
    for component in system.components:
        source = f"resources/{fmus[component.description.path]}"
        element = etree.SubElement(elements, f"{{{SSD}}}Component", name=component.name, type=FMU_TYPE, source=source)
        _connectors(element, component, layout.boxes[component.name], units)
        place_component(element, layout, component.name)
        if component.start:
            bindings = etree.SubElement(element, f"{{{SSD}}}ParameterBindings")
            source = f"resources/{sets[component.name]}"
            etree.SubElement(bindings, f"{{{SSD}}}ParameterBinding", type=PARAMETER_SET_TYPE, source=source)
        renamed = [v for v in component.description.variables.values() if v.declared]
        _annotate(element, NAMES_ANNOTATION, "names", [{"variable": v.name, "fmu": v.declared} for v in renamed])
    if system.connections:  # an empty list is invalid
        listing = etree.SubElement(outer, f"{{{SSD}}}Connections")
        for connection, route in zip(system.connections, layout.routes, strict=True):
            place_connection(_connection(listing, system, connection), layout, route)
    place_system(outer, layout, [component.name for component in system.components])
    assumed = [{"variable": path, "text": text} for path, text in sorted(system.assumptions.items())]
    _annotate(outer, ASSUMPTIONS_ANNOTATION, "assumptions", assumed)
    units.write(root, SSD)
    _experiment(root, system)
    return serialized(root, STRUCTURE, system.name)


def _experiment(root: Xml, system: System) -> None:
    """Add the default experiment: start and stop time, and communication step as an annotation."""
    experiment = etree.SubElement(root, f"{{{SSD}}}DefaultExperiment", startTime=_real(system.start_time))
    if system.stop_time is not None:
        experiment.set("stopTime", _real(system.stop_time))
    if system.step is not None:
        annotations = etree.SubElement(experiment, f"{{{SSD}}}Annotations")
        annotation = etree.SubElement(annotations, f"{{{SSC}}}Annotation", type=STEP_ANNOTATION)
        etree.SubElement(annotation, "step", size=_real(system.step))


def _connectors(element: Xml, component: Component, box: Box, units: _Units) -> None:
    """Add connectors for the connected variables of a component, which are those that its box shows."""
    listing = etree.Element(f"{{{SSD}}}Connectors")
    for variable in component.description.variables.values():
        if variable.name not in box.inputs and variable.name not in box.outputs:
            continue
        connector = etree.SubElement(listing, f"{{{SSD}}}Connector", name=variable.fmu_name, kind=variable.causality)
        typed = etree.SubElement(connector, f"{{{SSC}}}{variable.type}")
        _set_unit(typed, component, variable, units)
        place_connector(connector, box, variable.name)
    if len(listing):
        element.append(listing)


def _set_unit(element: Xml, component: Component, variable: Variable, units: _Units) -> None:
    """Set the attribute ``unit`` of a Real whose unit has a definition."""
    name = units.name(component.description.unit(variable))
    if name is not None and variable.type == REAL:
        element.set("unit", name)


def _connection(listing: Xml, system: System, connection: Connection) -> Xml:
    """Add and return a connection with its full transformation, because some simulation tools do not convert units."""
    source, target = system.component(connection.source), system.component(connection.target)
    output, input_ = source.variable(connection.output), target.variable(connection.input)
    element = etree.SubElement(
        listing,
        f"{{{SSD}}}Connection",
        startElement=source.name,
        startConnector=output.fmu_name,
        endElement=target.name,
        endConnector=input_.fmu_name,
    )
    scale, by_units = connection.scale, unit_scale(source, output, target, input_)
    if by_units is None or not by_units.trivial:
        element.set("suppressUnitConversion", "true")
    if not scale.trivial:
        numbers = {"factor": _real(scale.factor)}
        if scale.offset != 0:
            numbers["offset"] = _real(scale.offset)
        etree.SubElement(element, f"{{{SSC}}}LinearTransformation", numbers)
    return element


def _annotate(element: Xml, kind: str, name: str, items: list[dict[str, str]]) -> None:
    """Add an annotation to an element, with one child per item."""
    if items:
        annotations = etree.SubElement(element, f"{{{SSD}}}Annotations")
        annotation = etree.SubElement(annotations, f"{{{SSC}}}Annotation", type=kind)
        listing = etree.SubElement(annotation, name)
        for item in items:
            etree.SubElement(listing, "item", item)


def _parameter_set(component: Component, assumptions: Mapping[str, str]) -> bytes:
    """Content of a parameter set; an assumed value has its assumption as description, for users of other tools."""
    root = etree.Element(
        f"{{{SSV}}}ParameterSet",
        {"version": "1.0", "name": PARAMETER_SET},
        nsmap={"ssv": SSV, "ssc": SSC},
    )
    listing = etree.SubElement(root, f"{{{SSV}}}Parameters")
    units = _Units()
    write: dict[str, Callable[[Any], str]] = {
        STRING: str,
        REAL: _real,
        INTEGER: lambda value: str(int(value)),
        BOOLEAN: lambda value: "true" if value else "false",
    }
    for variable in component.description.variables.values():
        if variable.name in component.start:
            parameter = etree.SubElement(listing, f"{{{SSV}}}Parameter", name=variable.fmu_name)
            assumed = assumptions.get(f"{component.name}.{variable.name}")
            if assumed:
                parameter.set("description", assumed)
            value = component.start[variable.name]
            items = {number: name for name, number in variable.items.items()}
            kind, text = variable.type, write[variable.type](value)
            if items and value in items:
                kind, text = ENUMERATION, items[int(value)]
            typed = etree.SubElement(parameter, f"{{{SSV}}}{kind}", value=text)
            _set_unit(typed, component, variable, units)
    units.write(root, SSV)
    return serialized(root, VALUES, component.name)


def _real(value: float) -> str:
    """Text of type xs:double that reads back as the same number."""
    text = repr(float(value))
    return text.replace("inf", "INF").replace("nan", "NaN")
