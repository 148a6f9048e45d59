"""Experiment on rule 16: compares directional derivatives with central differences, in initialization mode.

    (y(u + d) - y(u - d)) / 2 d,    d = 1e-5 max(1, |u|)

Truncation is d^2 times third derivatives, rounding EPS |y| / d, both far below the 1e-3 that is allowed.
Where the two one-sided differences disagree, the output has a kink and is not judged. An FMU whose outputs
do not follow its inputs in initialization mode is not judged either.
"""

import ctypes as ct
import math

from orchestration.check.dynamic.bitwise_runs import Yield, moves
from orchestration.check.dynamic.instance import Binary, Instance, reals
from orchestration.check.findings import error, shown
from orchestration.fmi.instance import c_references

SHIFT, TOLERANCE = 1e-5, 1e-3
ROUNDING = 100 * 2.0**-52
MOST = 16  # inputs, and outputs, that are looked at


def derivatives(binary: Binary) -> Yield:
    """Try rule 16: compare the derivative of each output along each continuous input with a difference."""
    outputs = binary.names("output", "Real")[:MOST]
    known = [n for n in binary.names("input", "Real") if binary.variables[n]["variability"] == "continuous"][:MOST]
    if not moves(binary):
        return
    wrong, moved, declared = [], 0, 0.0
    with Instance(binary) as instance:
        instance.enter()
        for name in known if outputs else []:
            found = _directional(instance, outputs, name)
            rows = _shifted(instance, outputs, name)
            declared = max(declared, *map(abs, found))
            for output, value, (low, middle, high, d) in zip(outputs, found, rows, strict=True):
                difference = (high - low) / (2 * d)
                sides = abs(high - 2 * middle + low) / d
                noise = ROUNDING * max(abs(high), abs(low)) / d
                size = max(abs(difference), abs(value))
                moved += abs(difference) > noise
                if sides <= TOLERANCE * size + noise and not abs(difference - value) <= TOLERANCE * size + noise:
                    pair = f"d {shown(output)} / d {shown(name)}"
                    wrong.append(f"{pair} is {value:.6g} as a derivative, {difference:.6g} as a difference.")
    if moved:
        yield from (error("16", message) for message in wrong)
    elif declared > 0 or any(map(math.isnan, [declared])):
        yield "Directional derivatives were not compared: outputs do not follow inputs in initialization mode."


def _directional(instance: Instance, outputs: list[str], name: str) -> list[float]:
    """Return the directional derivatives of the outputs along one input."""
    numbers = [instance.binary.variables[output]["reference"] for output in outputs]
    found = reals([0.0] * len(outputs))
    instance.call(
        "fmi2GetDirectionalDerivative",
        c_references(numbers),
        len(numbers),
        c_references([instance.binary.variables[name]["reference"]]),
        1,
        ct.byref(ct.c_double(1.0)),
        found,
    )
    return list(found)


def _shifted(instance: Instance, outputs: list[str], name: str) -> list[tuple[float, float, float, float]]:
    """Return the outputs below, at and above the value of one input, and the shift of the input."""
    value = instance.binary.starts()[name]
    d = SHIFT * max(1.0, abs(value))
    rows = []
    for shift in (-d, 0.0, d):
        instance.set({name: value + shift})
        rows.append(instance.get(outputs))
    instance.set({name: value})
    return [(*triple, d) for triple in zip(*rows, strict=True)]
