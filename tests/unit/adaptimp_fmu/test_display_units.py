"""Tests of display units: their factors, and what modelDescription.xml says about them."""

import math
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

from adaptimp_fmu import DefinitionError, SampledModel, build
from adaptimp_fmu.display_units import display_unit, require_display_unit


@pytest.mark.parametrize(
    ("name", "coherent", "value", "shown"),
    [
        ("deg", "rad", math.pi, 180.0),
        ("deg/s", "rad/s", math.pi, 180.0),
        ("rpm", "rad/s", 2 * math.pi, 60.0),
        ("rev", "rad", 2 * math.pi, 1.0),
        ("mm", "m", 1.0, 1000.0),
        ("mm2", "m2", 1.0, 1e6),
        ("kN/m", "N/m", 4000.0, 4.0),
        ("km/h", "m/s", 1.0, 3.6),
        ("g", "kg", 1.0, 1000.0),
        ("ms", "s", 1.0, 1000.0),
        ("1/min", "1/s", 1.0, 60.0),
        ("percent", "1", 0.5, 50.0),
        ("degC", "K", 273.15, 0.0),
        ("rad", "rad", 2.0, 2.0),
    ],
)
def test_a_value_is_shown_in_its_display_unit(name: str, coherent: str, value: float, shown: float) -> None:
    unit = display_unit(name)
    assert unit.coherent == coherent
    # Rounding: the factor, its product and its sum are each within half an ulp of the larger operand.
    assert unit.factor * value + unit.offset == pytest.approx(shown, rel=4e-16, abs=1e-13)


def test_an_unknown_display_unit_is_refused_with_near_ones() -> None:
    with pytest.raises(DefinitionError, match=r'display unit "dge": "dge" is not known; did you mean deg'):
        display_unit("dge")


def test_a_display_unit_has_the_dimension_of_its_unit() -> None:
    require_display_unit("deg", "rad")
    with pytest.raises(DefinitionError, match='"deg" shows values in rad, but the variable is in m'):
        require_display_unit("deg", "m")
    with pytest.raises(DefinitionError, match="but the variable is without a unit"):
        require_display_unit("deg", "")


def test_a_built_fmu_declares_display_units(tmp_path: Path) -> None:
    model = SampledModel("Turner", "Turns")
    angle = model.input("q", [0.0, 0.0], unit="rad", display_unit="deg", description="Angle")
    heat = model.parameter("T", 293.15, unit="K", display_unit="degC", description="Temperature")
    model.output("y", angle * heat, unit="rad.K", description="Product")
    model.output("half", angle / 2, unit="rad", display_unit=["deg", "rev"], description="Half the angle")
    path = build(model, tmp_path)
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(str(path), validate=True)
    shown = {variable.name: variable.displayUnit for variable in description.modelVariables}
    assert shown == {
        **{"sample_time": None, "T": "degC", "q[1]": "deg", "q[2]": "deg", "y[1]": None, "y[2]": None},
        **{"half[1]": "deg", "half[2]": "rev"},
    }
    found = {
        (unit.name, display.name): (float(display.factor), float(display.offset))
        for unit in description.unitDefinitions
        for display in unit.displayUnits
    }
    assert found == {
        ("rad", "deg"): (180 / math.pi, 0.0),
        ("rad", "rev"): (1 / (2 * math.pi), 0.0),
        ("K", "degC"): (1.0, -273.15),
    }
