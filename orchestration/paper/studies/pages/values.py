"""Says what the paper leaves open, with ranges and reasons."""

from orchestration.paper.studies.fixed_values import FIXED
from orchestration.paper.studies.open_values import OPEN_VALUES, OpenValue
from orchestration.paper.studies.pages.text import table


def open_values() -> str:
    """What is open, with ranges, and what is assumed without a range."""
    rows = [[name_of(v), f"{v.chosen:g}", range_of(v), v.reason, v.claims] for v in OPEN_VALUES]
    fixed = [[v.name, v.value, v.reason, v.claims] for v in FIXED]
    return f"""## What is open

{table(("value", "chosen", "range", "reason", "takes part in"), rows)}
Psi_1 and Gamma_1 belong to algorithm 1, Psi_2, Gamma_2 and K_d to algorithm 2. Some numbers follow from runs of the
same setting: the bound of the noise from Fig. 5 without noise, and the limits of torque from Fig. 5 with noise.

The paper does not say the following either. It is assumed, and no study varies it.

{table(("assumption", "what is assumed", "reason", "takes part in"), fixed)}"""


def name_of(value: OpenValue) -> str:
    """The name of a value, with its unit if it has one."""
    return f"{value.name}, {value.unit}" if value.unit else value.name


def range_of(value: OpenValue) -> str:
    """The range of a value as text."""
    if value.choices:
        return " or ".join(f"{choice:g}" for choice in dict.fromkeys(value.choices))
    return f"{value.low:g} to {value.high:g}{', log' if value.log else ''}"
