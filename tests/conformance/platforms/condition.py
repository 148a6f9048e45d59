"""Measures the conditioning of a plan's outputs, which limits the difference between two platforms."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from tests.conformance.platforms.machines import Machine
from tests.conformance.platforms.plan import Plan

RELATIVE = 1e-9  # perturbation; 1e7 times the rounding of what it shows, 1e-9 of its second order
ROUNDING = 2.0**-52
# What multiplies a result of the C library: lengths sin and cos, deviations log and cos, friction tanh.
FACTORS = ("l[", "semi_axis[", "noise_std", "coulomb[")


def rounding_effects(plan: Plan, outputs: dict[str, np.ndarray], machine: Machine, folder: Path) -> dict[str, float]:
    """Largest change of each output that one unit of rounding in every function may cause.

    A sine that is one unit in its last place off acts as if the length that multiplies it were off by a
    relative 2^-52, and so do other functions and their factors. The plan is run with each factor in turn a
    relative 1e-9 larger; the largest changes of an output, over 1e-9, add up to its condition A. All
    functions wrong in the same direction at every evaluation change it by 2^-52 A, its own rounding by 2^-52
    of its largest value.

    Parameters
    ----------
    outputs
        What the plan gives, each of shape (steps + 1,).
    folder
        An empty folder.

    Returns
    -------
    dict
        In the units of the outputs.
    """
    condition = dict.fromkeys(outputs, 0.0)
    for number, perturbed in enumerate(_perturbed(plan)):
        (folder / str(number)).mkdir()
        changed = machine.run(perturbed, folder / str(number))
        for name, values in outputs.items():
            condition[name] += float(np.abs(changed[name] - values).max()) / RELATIVE
    return {name: ROUNDING * (condition[name] + float(np.abs(values).max())) for name, values in outputs.items()}


def _perturbed(plan: Plan) -> Iterator[Plan]:
    """The plan with one factor changed, for each that is not zero."""
    for component in plan.system.components:
        for variable in component.description.of_causality("parameter"):
            value = component.start.get(variable.name, variable.start)
            if variable.name.startswith(FACTORS) and value:
                changed = {f"{component.name}.{variable.name}": float(value) * (1 + RELATIVE)}
                yield replace(plan, system=plan.system.set(changed))
