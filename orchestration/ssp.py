"""Systems as SSP 1.0 packages: ``SystemStructure.ssd`` and ``resources/*.fmu, *.ssv`` in a zip.

The profile is the one that other engines load too: a flat system, connected variables as the only
connectors, one parameter set per component, equal units on both ends, literal prefixes ``ssd:``,
``ssc:``, ``ssv:``. The order of the components is the order in the file.
"""

import importlib.resources
import os
import tempfile
import zipfile
from contextlib import suppress
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Any

import platformdirs
from lxml import etree

from orchestration.archive import file_hash, unpack
from orchestration.errors import ArchiveError, SystemDescriptionError
from orchestration.fmu import BOOLEAN, INTEGER, REAL, UnitDefinition, read_description
from orchestration.system import Component, Connection, System

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
FMU_TYPE = "application/x-fmu-sharedlibrary"
PARAMETER_SET_TYPE = "application/x-ssp-parameter-set"
PARAMETER_SET = "parameters"  # one name for all: ecos applies sets by name
STEP_ANNOTATION = "org.adaptimp.step"
_EPOCH = (1980, 1, 1, 0, 0, 0)


def write_ssp(system: System, path: Path) -> Path:
    """Write a system as an SSP package; same system, same bytes.

    Raises
    ------
    SystemDescriptionError
        If the result does not validate against SSP's schemas.
    """
    entries = {"SystemStructure.ssd": _structure(system)}
    for component in system.components:
        if component.start:
            entries[f"resources/{component.name}.ssv"] = _parameter_set(component)
    for name, source in _resources(system).items():
        entries[f"resources/{name}"] = source.read_bytes()
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(path.name + ".part")
    with zipfile.ZipFile(draft, "w") as archive:
        for name, content in entries.items():
            info = zipfile.ZipInfo(name, _EPOCH)
            info.external_attr = 0o100644 << 16
            stored = name.endswith(".fmu")  # compressed already
            info.compress_type = zipfile.ZIP_STORED if stored else zipfile.ZIP_DEFLATED
            archive.writestr(info, content)
    draft.replace(path)
    return path


def read_ssp(path: Path) -> System:
    """Read an SSP package of the profile above.

    The package is unpacked once into the cache (``$ADAPTIMP_CACHE`` or the user's), by its hash.

    Raises
    ------
    ArchiveError
        If the package is unsafe, incomplete or invalid.
    SystemDescriptionError
        If it describes what cannot be run.
    """
    if not path.is_file():
        msg = f"{path}: there is no such package."
        raise ArchiveError(msg)
    folder = _unpacked(path)
    root = _parse(folder / "SystemStructure.ssd", "SystemStructureDescription.xsd", path)
    outer = root.find(f"{{{SSD}}}System")
    if outer.find(f"{{{SSD}}}Elements/{{{SSD}}}System") is not None:
        msg = f"{path}: nested systems are not supported; flatten the package first."
        raise SystemDescriptionError(msg)
    components = tuple(
        _component(element, folder, path) for element in outer.iterfind(f"{{{SSD}}}Elements/{{{SSD}}}Component")
    )
    connections = []
    for element in outer.iterfind(f"{{{SSD}}}Connections/{{{SSD}}}Connection"):
        if any(etree.QName(child).namespace == SSC for child in element.iterchildren("*")):
            msg = f"{path}: connection {dict(element.attrib)} has a transformation, which is not supported."
            raise SystemDescriptionError(msg)
        ends = [element.get(a) for a in ("startElement", "startConnector", "endElement", "endConnector")]
        if None in ends:
            ends_text = dict(element.attrib)
            msg = f"{path}: connection {ends_text} leads to the system's own connectors; nothing drives them."
            raise SystemDescriptionError(msg)
        connections.append(_oriented(ends, components))
    experiment = root.find(f"{{{SSD}}}DefaultExperiment")
    stop = experiment.get("stopTime") if experiment is not None else None
    start = float(experiment.get("startTime") or 0) if experiment is not None else 0.0
    step = root.find(f".//{{{SSC}}}Annotation[@type='{STEP_ANNOTATION}']/step")
    options = {"step": float(step.get("size"))} if step is not None else {}
    if stop is not None:
        options["stop_time"] = float(stop)
    if start != 0:
        options["notices"] = (f"{path}: its start time {start:g} s is not used; give it in Options.start_time.",)
    return System(root.get("name"), components, tuple(connections), **options)


def _unpacked(path: Path) -> Path:
    """The package's folder in the cache; it appears whole, also when two runs read at once."""
    cache_folder = os.environ.get("ADAPTIMP_CACHE") or platformdirs.user_cache_path("adaptimp")
    folder = Path(cache_folder) / "ssp" / file_hash(path)[:32]
    if not folder.is_dir():
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
            fresh = Path(scratch) / "package"
            fresh.mkdir()
            unpack(path, fresh)
            with suppress(OSError):  # another run was faster
                fresh.rename(folder)
    return folder


def _resources(system: System) -> dict[str, Path]:
    """File name in the package to FMU; two different files of one name are told apart."""
    names: dict[str, Path] = {}
    for component in system.components:
        names.setdefault(_resource_name(system, component), component.description.path)
    return names


def _resource_name(system: System, component: Component) -> str:
    path = component.description.path
    paths = {c.description.path for c in system.components if c.description.path.name == path.name}
    return path.name if len(paths) == 1 else f"{component.name}.{path.name}"


def _structure(system: System) -> bytes:
    root = etree.Element(
        f"{{{SSD}}}SystemStructureDescription",
        {"version": "1.0", "name": system.name, "generationTool": "adaptimp"},
        nsmap={"ssd": SSD, "ssc": SSC, "ssv": SSV},
    )
    outer = etree.SubElement(root, f"{{{SSD}}}System", name=system.name)
    elements = etree.SubElement(outer, f"{{{SSD}}}Elements")
    units: dict[str, UnitDefinition] = {}
    for component in system.components:
        element = etree.SubElement(
            elements,
            f"{{{SSD}}}Component",
            name=component.name,
            type=FMU_TYPE,
            source=f"resources/{_resource_name(system, component)}",
        )
        _connectors(element, system, component, units)
        if component.start:
            bindings = etree.SubElement(element, f"{{{SSD}}}ParameterBindings")
            source = f"resources/{component.name}.ssv"
            etree.SubElement(bindings, f"{{{SSD}}}ParameterBinding", type=PARAMETER_SET_TYPE, source=source)
    connections = etree.Element(f"{{{SSD}}}Connections")
    for c in system.connections:
        etree.SubElement(
            connections,
            f"{{{SSD}}}Connection",
            startElement=c.source,
            startConnector=c.output,
            endElement=c.target,
            endConnector=c.input,
        )
    if len(connections):  # an empty list is invalid
        outer.append(connections)
    if units:
        _write_units(etree.SubElement(root, f"{{{SSD}}}Units"), units)
    experiment = etree.SubElement(
        root, f"{{{SSD}}}DefaultExperiment", startTime="0.0", stopTime=repr(float(system.stop_time))
    )
    annotations = etree.SubElement(experiment, f"{{{SSD}}}Annotations")
    annotation = etree.SubElement(annotations, f"{{{SSC}}}Annotation", type=STEP_ANNOTATION)
    etree.SubElement(annotation, "step", size=repr(float(system.step)))
    return _validated(root, "SystemStructureDescription.xsd", system.name)


def _connectors(element: Any, system: System, component: Component, units: dict[str, UnitDefinition]) -> None:
    connected = {(c.source, c.output) for c in system.connections} | {(c.target, c.input) for c in system.connections}
    listing = etree.Element(f"{{{SSD}}}Connectors")
    for variable in component.description.variables.values():
        if (component.name, variable.name) not in connected:
            continue
        connector = etree.SubElement(listing, f"{{{SSD}}}Connector", name=variable.name, kind=variable.causality)
        typed = etree.SubElement(connector, f"{{{SSC}}}{variable.type}")
        if variable.unit:
            typed.set("unit", variable.unit)
            units[variable.unit] = component.description.units[variable.unit]
    if len(listing):
        element.append(listing)


def _write_units(listing: Any, units: dict[str, UnitDefinition]) -> None:
    for name, unit in sorted(units.items()):
        element = etree.SubElement(listing, f"{{{SSC}}}Unit", name=name)
        base = {symbol: str(power) for symbol, power in unit.exponents if not symbol.startswith("=")}
        if unit.factor != 1:
            base["factor"] = repr(unit.factor)
        if unit.offset != 0:
            base["offset"] = repr(unit.offset)
        etree.SubElement(element, f"{{{SSC}}}BaseUnit", base)


def _parameter_set(component: Component) -> bytes:
    root = etree.Element(
        f"{{{SSV}}}ParameterSet",
        {"version": "1.0", "name": PARAMETER_SET},
        nsmap={"ssv": SSV, "ssc": SSC},
    )
    listing = etree.SubElement(root, f"{{{SSV}}}Parameters")
    for name, value in component.start.items():
        variable = component.variable(name)
        parameter = etree.SubElement(listing, f"{{{SSV}}}Parameter", name=name)
        text = {
            REAL: repr(float(value)),
            INTEGER: str(int(value)),
            BOOLEAN: "true" if value else "false",
        }[variable.type]
        etree.SubElement(parameter, f"{{{SSV}}}{variable.type}", value=text)
    return _validated(root, "SystemStructureParameterValues.xsd", component.name)


def _component(element: Any, folder: Path, path: Path) -> Component:
    name, source = element.get("name"), element.get("source")
    fmu = _inside(folder, source, path)
    component = Component(name, read_description(fmu))
    start: dict[str, float] = {}
    for binding in element.iterfind(f"{{{SSD}}}ParameterBindings/{{{SSD}}}ParameterBinding"):
        if len(binding.findall(f"{{{SSD}}}ParameterMapping")) or binding.get("prefix"):
            msg = f"{path}: component {name} maps or prefixes parameter names, which is not supported."
            raise SystemDescriptionError(msg)
        start.update(_values(binding, component, folder, path))
    return System("_", (component,)).set({f"{name}.{n}": v for n, v in start.items()}).components[0]


def _values(binding: Any, component: Component, folder: Path, path: Path) -> dict[str, Any]:
    """Values of a parameter set, in its own file or inline."""
    inline = binding.find(f"{{{SSD}}}ParameterValues/{{{SSV}}}ParameterSet")
    if inline is None:
        file = _inside(folder, binding.get("source"), path)
        inline = _parse(file, "SystemStructureParameterValues.xsd", path)
    values = {}
    for parameter in inline.iterfind(f"{{{SSV}}}Parameters/{{{SSV}}}Parameter"):
        typed = next(child for child in parameter if isinstance(child.tag, str))
        variable = component.variable(parameter.get("name"))
        unit = typed.get("unit")
        if unit and variable.unit and unit != variable.unit:
            msg = f"{path}: {component.name}.{variable.name} is given in {unit}, the FMU has {variable.unit}."
            raise SystemDescriptionError(msg)
        values[variable.name] = typed.get("value")
    return values


def _oriented(ends: list[str], components: tuple[Component, ...]) -> Connection:
    """A connection from output to input; SSP allows either end first."""
    start, start_connector, end, end_connector = ends
    for component in components:
        variable = component.description.variables.get(start_connector)
        if component.name == start and variable is not None and variable.causality == "input":
            return Connection(end, end_connector, start, start_connector)
    return Connection(start, start_connector, end, end_connector)


def _inside(folder: Path, source: str | None, path: Path) -> Path:
    """A file of the package; a source that leads out of it is refused."""
    relative = PurePosixPath(source or "")
    file = (folder / relative).resolve()
    if not source or relative.is_absolute() or not file.is_relative_to(folder.resolve()):
        msg = f"{path}: the source {source!r} is missing or leads outside the package."
        raise ArchiveError(msg)
    if not file.is_file():
        msg = f"{path}: the source {source!r} is not in the package."
        raise ArchiveError(msg)
    return file


def _parse(file: Path, schema: str, path: Path) -> Any:
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
    try:
        root = etree.parse(str(file), parser).getroot()
    except (etree.XMLSyntaxError, OSError) as error:
        msg = f"{path}: {file.name} is missing or no well-formed XML: {error}"
        raise ArchiveError(msg) from error
    if root.getroottree().docinfo.doctype:
        msg = f"{path}: {file.name} declares a document type; entities are not read."
        raise ArchiveError(msg)
    if not _schema(schema).validate(root):
        msg = f"{path}: {file.name} is invalid: {_schema(schema).error_log.last_error}"
        raise ArchiveError(msg)
    return root


def _validated(root: Any, schema: str, name: str) -> bytes:
    if not _schema(schema).validate(root):
        msg = f"{name}: the SSP description is invalid: {_schema(schema).error_log.last_error}"
        raise SystemDescriptionError(msg)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


@cache
def _schema(name: str) -> Any:
    folder = importlib.resources.files("fmpy") / "ssp" / "schema"
    return etree.XMLSchema(etree.parse(str(folder / name)))
