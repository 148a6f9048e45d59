"""How sampling periods and communication steps fit together."""

import math
from collections.abc import Iterable

from orchestration.errors import SystemDescriptionError
from orchestration.system.component import Component

RATIO_TOLERANCE = 1e-9  # by which a quotient of two times may miss an integer


def steps_per_tick(components: Iterable[Component], step: float) -> dict[str, int]:
    """Return the number of communication steps per sampling period, by sampled component.

    Raises
    ------
    SystemDescriptionError
        If a period is not an integer multiple of the step.
    """
    ratios = {}
    for component in components:
        period = component.sample_time
        if period is None:
            continue
        if not (math.isfinite(period) and period > 0):
            msg = f"{component.name}: sample time {period:g} s is not positive; use {step:g} s, the step."
            raise SystemDescriptionError(msg)
        ratio = period / step
        nearest = round(ratio)
        if nearest < 1 or abs(ratio - nearest) > RATIO_TOLERANCE * ratio:
            below = period / max(1, -(-period // step))
            msg = (
                f"{component.name}: sample time {period:g} s is not a multiple of the step {step:g} s;"
                f" use a step of {below:.6g} s, or a sample time of {max(1, nearest) * step:.6g} s."
            )
            raise SystemDescriptionError(msg)
        ratios[component.name] = nearest
    return ratios
