"""Writes a set of parameter values as a file of the standard SSP (suffix ``.ssv``).

A tool that knows such files applies the set to the variables of the same names.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any

from lxml import etree

from adaptimp_fmu.description import number
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.files.standards import standard_file
from adaptimp_fmu.model import Model
from adaptimp_fmu.names import suggestion
from adaptimp_fmu.references import ParameterSet
from adaptimp_fmu.units import base_exponents
from adaptimp_fmu.variables import Variable

_BASE = "http://ssp-standard.org/SSP1/SystemStructure"
SSV, SSC = f"{_BASE}ParameterValues", f"{_BASE}Common"


def parameter_set_file(model: Model, given: ParameterSet) -> bytes:
    """Write the file of a parameter set.

    Returns
    -------
    bytes
        A parameter set of SSP 1.0. The same set gives the same bytes.

    Raises
    ------
    DefinitionError
        If the model has no such parameter, or the parameter cannot have such a value.
    """
    root = etree.Element(f"{{{SSV}}}ParameterSet", {"version": "1.0", "name": given.name}, {"ssv": SSV, "ssc": SSC})
    if given.description:
        root.set("description", given.description)
    listing = etree.SubElement(root, f"{{{SSV}}}Parameters")
    units: set[str] = set()
    for variable, value in _checked(model, given):
        parameter = etree.SubElement(listing, f"{{{SSV}}}Parameter", name=variable.name)
        typed = etree.SubElement(parameter, f"{{{SSV}}}{variable.type.value}", value=number(value, variable.type))
        if variable.unit:
            typed.set("unit", variable.unit)
            units.add(variable.unit)
    if units:  # the schema has no empty list
        defined = etree.SubElement(root, f"{{{SSV}}}Units")
        for unit in sorted(units):
            element = etree.SubElement(defined, f"{{{SSC}}}Unit", name=unit)
            exponents = {base: str(power) for base, power in base_exponents(unit).items()}
            etree.SubElement(element, f"{{{SSC}}}BaseUnit", exponents)
    schema = _schema()
    if not schema.validate(root):
        msg = f"{model.name}: parameter set {given.name} is invalid: {schema.error_log.last_error}"
        raise DefinitionError(msg)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def _checked(model: Model, given: ParameterSet) -> Iterator[tuple[Variable, float]]:
    """Variables and values in the order of the model's parameters."""
    parameters = {variable.name: variable for variable in model.variables if variable.role.is_parameter}
    values = dict(given.scalars())
    where = f"{model.name}: parameter set {given.name}"
    for name, value in values.items():
        if name not in parameters:
            msg = f"{where}: the model has no parameter {name}; {suggestion(name, parameters)}"
            raise DefinitionError(msg)
        parameters[name].require(value, f"{where}: {name}")
    yield from ((variable, values[name]) for name, variable in parameters.items() if name in values)


@cache
def _schema() -> Any:
    path = standard_file("ssp", "schema", "SystemStructureParameterValues.xsd")
    return etree.XMLSchema(etree.parse(str(path)))
