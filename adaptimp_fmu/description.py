"""Write the modelDescription.xml of an FMU (FMI 2.0.5, chapters 2.2 and 4.3)."""

import math
from collections.abc import Iterable
from functools import cache
from typing import Any

from lxml import etree

from adaptimp_fmu.display_units import display_unit
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.files.standards import standard_file
from adaptimp_fmu.metadata import Experiment
from adaptimp_fmu.model import Model
from adaptimp_fmu.sampled_model import SampledModel
from adaptimp_fmu.structure import dependencies
from adaptimp_fmu.units import QUANTITIES, base_exponents
from adaptimp_fmu.variables import Role, Type, Variable

GENERATION_TOOL = "adaptimp_fmu"
LOG_CATEGORIES = {
    "logStatusError": "Why a call returned fmi2Error",
    "logStatusWarning": "What a user should know although the call succeeded",
    "logAll": "All messages",
}
_EXPERIMENT = {
    "start_time": "startTime",
    "stop_time": "stopTime",
    "step_size": "stepSize",
    "tolerance": "tolerance",
}
STANDS_FOR = {
    Type.BOOLEAN: ("BooleanAsReal", "0 for false, 1 for true"),
    Type.INTEGER: ("IntegerAsReal", "A whole number"),
}
"""Declared type, with its description, of the Reals that stand for Booleans or Integers."""
_CAUSALITY = {
    Role.FIXED_PARAMETER: "parameter",
    Role.TUNABLE_PARAMETER: "parameter",
    Role.INPUT: "input",
    Role.OUTPUT: "output",
}


def model_description(model: Model, guid: str, sources: Iterable[str]) -> bytes:
    """Write modelDescription.xml.

    Parameters
    ----------
    guid
        GUID that the description shares with the binary.
    sources
        Names of the C files in ``sources/`` that are compiled.

    Raises
    ------
    DefinitionError
        If the result does not validate against FMI's schema.
    """
    root = etree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": model.name,
            "guid": guid,
            "description": model.description,
            **model.ownership.attributes(),
            "generationTool": GENERATION_TOOL,
            "variableNamingConvention": "structured",
            "numberOfEventIndicators": "0",
        },
    )
    variables = model.ordered_variables()
    _co_simulation(root, model, sources)
    _units(root, variables)
    _types(root, variables)
    categories = etree.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        etree.SubElement(categories, "Category", name=name, description=description)
    _experiment(root, model.experiment)
    listing = etree.SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables):
        _variable(listing, variable, reference, sampled=isinstance(model, SampledModel))
    _structure(root, model, variables)
    _validate(root, model.name)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def number(value: float, type: Type) -> str:
    """Return a value as a text of XML Schema."""
    if type is Type.BOOLEAN:
        return "true" if value else "false"
    if type is Type.INTEGER or float(value).is_integer():
        return str(int(value)) if abs(value) < 1e15 else repr(value)
    return repr(value)


def _co_simulation(root: Any, model: Model, sources: Iterable[str]) -> None:
    continuous = "false" if isinstance(model, SampledModel) else "true"
    element = etree.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=model.name,
        canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs=continuous,
        maxOutputDerivativeOrder="1",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        providesDirectionalDerivative="true",
    )
    files = etree.SubElement(element, "SourceFiles")
    for name in sources:
        etree.SubElement(files, "File", name=name)


def _units(root: Any, variables: Iterable[Variable]) -> None:
    definitions = etree.SubElement(root, "UnitDefinitions")
    shown: dict[str, set[str]] = {}
    for variable in variables:
        if variable.unit:
            shown.setdefault(variable.unit, set()).update(filter(None, [variable.display_unit]))
    for unit in sorted(shown):
        element = etree.SubElement(definitions, "Unit", name=unit)
        exponents = {base: str(power) for base, power in base_exponents(unit).items()}
        etree.SubElement(element, "BaseUnit", exponents)
        for display in map(display_unit, sorted(shown[unit])):
            attributes = {"name": display.name, "factor": repr(display.factor)}
            if display.offset:
                attributes["offset"] = repr(display.offset)
            etree.SubElement(element, "DisplayUnit", attributes)


def _types(root: Any, variables: Iterable[Variable]) -> None:
    definitions = etree.Element("TypeDefinitions")
    for unit in sorted({variable.unit for variable in variables} & QUANTITIES.keys()):
        simple = etree.SubElement(definitions, "SimpleType", name=QUANTITIES[unit])
        etree.SubElement(simple, "Real", quantity=QUANTITIES[unit], unit=unit)
    for type, (name, text) in STANDS_FOR.items():
        if all(variable.stands_for is not type for variable in variables):
            continue
        simple = etree.SubElement(definitions, "SimpleType", name=name, description=text)
        etree.SubElement(simple, "Real")
    if len(definitions):  # the schema has no empty list
        root.append(definitions)


def _experiment(root: Any, experiment: Experiment) -> None:
    stated = experiment.stated()
    if stated:
        attributes = {_EXPERIMENT[name]: number(value, Type.REAL) for name, value in stated.items()}
        etree.SubElement(root, "DefaultExperiment", attributes)


def _variable(listing: Any, variable: Variable, reference: int, *, sampled: bool) -> None:
    element = etree.SubElement(
        listing,
        "ScalarVariable",
        name=variable.name,
        valueReference=str(reference),
        description=variable.description,
        causality=_CAUSALITY[variable.role],
        variability=_variability(variable, sampled=sampled),
    )
    if variable.role is Role.OUTPUT:
        element.set("initial", "calculated")
    elif variable.role.is_parameter:
        element.set("initial", "exact")
    typed = etree.SubElement(element, variable.type.value)
    if variable.unit in QUANTITIES:
        typed.set("declaredType", QUANTITIES[variable.unit])
    if variable.stands_for is not None:
        typed.set("declaredType", STANDS_FOR[variable.stands_for][0])
    if variable.unit:
        typed.set("unit", variable.unit)
    if variable.display_unit:
        typed.set("displayUnit", variable.display_unit)
    if variable.type is not Type.BOOLEAN:
        for attribute, bound in (("min", variable.minimum), ("max", variable.maximum)):
            if math.isfinite(bound):
                typed.set(attribute, number(bound, variable.type))
    if variable.start is not None:
        typed.set("start", number(variable.start, variable.type))


def _variability(variable: Variable, *, sampled: bool) -> str:
    if variable.role is Role.FIXED_PARAMETER:
        return "fixed"
    if variable.role is Role.TUNABLE_PARAMETER:
        return "tunable"
    if variable.type is not Type.REAL or variable.stands_for or (sampled and variable.role is Role.OUTPUT):
        return "discrete"
    return "continuous"


def _structure(root: Any, model: Model, variables: list[Variable]) -> None:
    depends = dependencies(model)
    first = next(i for i, variable in enumerate(variables) if variable.role is Role.OUTPUT)
    structure = etree.SubElement(root, "ModelStructure")
    for tag, rows in (("Outputs", depends.in_step), ("InitialUnknowns", depends.initial)):
        listing = etree.SubElement(structure, tag)
        for i, row in enumerate(rows):
            known = " ".join(str(reference + 1) for reference in row)
            etree.SubElement(listing, "Unknown", index=str(first + i + 1), dependencies=known)


@cache
def _schema() -> Any:
    path = standard_file("schema", "fmi2", "fmi2ModelDescription.xsd")
    return etree.XMLSchema(etree.parse(str(path)))


def _validate(root: Any, name: str) -> None:
    schema = _schema()
    if not schema.validate(root):
        msg = f"{name}: modelDescription.xml is invalid: {schema.error_log.last_error}"
        raise DefinitionError(msg)
