"""Writes the modelDescription.xml of a system as one FMU (FMI 2.0.5, chapters 2.2 and 4.3).

Each variable has the description, unit, limits and variability that its FMU declares, and the name
``component.variable``.
"""

import re
from collections.abc import Iterable, Mapping
from typing import Any

from lxml import etree

from adaptimp_fmu.description import LOG_CATEGORIES, number
from adaptimp_fmu.variables import Type
from orchestration.containers.fmu.structure import structure
from orchestration.containers.fmu.unit_definitions import UnitDefinitions
from orchestration.containers.plan import FIXED, INPUT, OUTPUT, TUNABLE, Plan, ProgramVariable
from orchestration.fmi.codes import BOOLEAN, INTEGER, ONE_INSTANCE, REAL
from orchestration.fmi.document import Document, require_valid

GENERATION_TOOL = "adaptimp"
_TYPES = {REAL: Type.REAL, INTEGER: Type.INTEGER, BOOLEAN: Type.BOOLEAN}
_CAUSALITIES = {FIXED: "parameter", TUNABLE: "parameter", INPUT: "input", OUTPUT: "output"}
_PARAMETERS = {FIXED: "fixed", TUNABLE: "tunable"}
_KEPT = ("quantity", "relativeQuantity", "min", "max", "nominal", "unbounded")
"""Attributes of a variable or of its declared type that a container hands on as they are."""
_STRUCTURED = re.compile(r"[A-Za-z_]\w*(\[[1-9]\d*\])?(\.[A-Za-z_]\w*(\[[1-9]\d*(,[1-9]\d*)*\])?)+", re.ASCII)


def container_description(plan: Plan, documents: Mapping[str, Document], sources: Iterable[str], guid: str) -> bytes:
    """Write modelDescription.xml.

    Parameters
    ----------
    plan
        The system as a program. The index of a variable is its value reference.
    documents
        Description of each component's FMU, by the name of the component.
    sources
        Names of the C files in ``sources/`` that are compiled.
    guid
        GUID that the description shares with the binary.

    Raises
    ------
    DocumentError
        If the result does not validate against FMI's schema.
    """
    structured = all(_STRUCTURED.fullmatch(variable.path) for variable in plan.variables)
    root = etree.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=plan.system.name,
        guid=guid,
        description=summary(plan),
        generationTool=GENERATION_TOOL,
        variableNamingConvention="structured" if structured else "flat",
        numberOfEventIndicators="0",
    )
    _co_simulation(root, plan, sources)
    units = UnitDefinitions()
    listing = etree.Element("ModelVariables")
    for reference, variable in enumerate(plan.variables):
        _variable(listing, variable, documents[plan.members[variable.member].name], units, reference)
    units.write(root)
    categories = etree.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        etree.SubElement(categories, "Category", name=name, description=description)
    _experiment(root, plan)
    root.append(listing)
    _structure(root, plan, documents)
    require_valid(root)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def summary(plan: Plan) -> str:
    """Return one sentence on what a container holds."""
    members = ", ".join(f"{member.name} ({member.component.description.model_name})" for member in plan.members)
    return f"System {plan.system.name} as one FMU: {members}; coupled by {plan.algorithm} with a step of {plan.step} s"


def _co_simulation(root: Any, plan: Plan, sources: Iterable[str]) -> None:
    alone = any(fmu.description.can(ONE_INSTANCE) for fmu in plan.fmus)
    element = etree.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=plan.identifier,
        canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs="false",
        maxOutputDerivativeOrder="0",
        canBeInstantiatedOnlyOncePerProcess=_boolean(alone),
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate=_boolean(plan.saves),
        canSerializeFMUstate=_boolean(plan.serializes),
        providesDirectionalDerivative="false",
    )
    files = etree.SubElement(element, "SourceFiles")
    for name in sources:
        etree.SubElement(files, "File", name=name)


def _boolean(value: bool) -> str:
    return "true" if value else "false"


def _experiment(root: Any, plan: Plan) -> None:
    times = {"startTime": plan.system.start_time, "stopTime": plan.system.stop_time, "stepSize": plan.step}
    given = {name: number(float(value), Type.REAL) for name, value in times.items() if value is not None}
    etree.SubElement(root, "DefaultExperiment", given)


def _variable(
    listing: Any, variable: ProgramVariable, document: Document, units: UnitDefinitions, reference: int
) -> None:
    declared = variable.declared
    element = etree.SubElement(
        listing,
        "ScalarVariable",
        name=variable.path,
        valueReference=str(reference),
        description=declared.description,
        causality=_CAUSALITIES[variable.role],
        variability=_variability(variable),
    )
    if variable.role != INPUT:
        element.set("initial", "calculated" if variable.role == OUTPUT else "exact")
    typed = etree.SubElement(element, declared.type)
    attributes = document.attributes(declared)
    for name in (name for name in _KEPT if name in attributes):
        typed.set(name, attributes[name])
    if declared.unit:
        typed.set("unit", units.unit(document, declared.unit))
        shown = units.display_unit(document, declared.unit, declared.display_unit)
        if shown:
            typed.set("displayUnit", shown)
    if variable.role != OUTPUT:
        typed.set("start", number(variable.start, _TYPES[declared.type]))


def _variability(variable: ProgramVariable) -> str:
    """Variability in the container; only a Real is continuous, and an output that never changes is still calculated."""
    declared = variable.declared
    if variable.role in _PARAMETERS:
        return _PARAMETERS[variable.role]
    if declared.variability == "constant" or (declared.type != REAL and declared.variability == "continuous"):
        return "discrete"
    return declared.variability


def _structure(root: Any, plan: Plan, documents: Mapping[str, Document]) -> None:
    depends = structure(plan.system, documents)
    index = {(plan.members[v.member].name, v.declared.name): i for i, v in enumerate(plan.variables, start=1)}
    outputs = [name for name, variable in zip(index, plan.variables, strict=True) if variable.role == OUTPUT]
    element = etree.SubElement(root, "ModelStructure")
    for tag, rows in (("Outputs", depends.in_step), ("InitialUnknowns", depends.initial)):
        listing = etree.SubElement(element, tag)
        for output in outputs:
            known = sorted(index[name] for name in rows[output] if name in index)
            etree.SubElement(listing, "Unknown", index=str(index[output]), dependencies=" ".join(map(str, known)))
