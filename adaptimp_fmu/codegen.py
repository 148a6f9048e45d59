"""Generate the C code of a model: CasADi's functions, a table of variables, and the runtime."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import jinja2

from adaptimp_fmu.equations import equations_text
from adaptimp_fmu.lowering import Lowered, lower
from adaptimp_fmu.model import Model
from adaptimp_fmu.runtime_files import runtime_sources
from adaptimp_fmu.sampled_model import SampledModel
from adaptimp_fmu.variables import Role, Type, Variable, element_names

GUID_PLACEHOLDER = "{guid}"
MAIN_SOURCE = "model.c"
EQUATIONS_SOURCE = "equations.h"
SIZES_SOURCE = "sizes.h"

# C parameters of each function of the seam (runtime/model.h): name of the CasADi argument or
# result, and its C declaration.
_IN = {"t": "double t", "r": "const double *r"} | {
    name: f"const double *{name}" for name in ("x", "u", "p", "c", "m", "w", "s", "v", "q")
}
_SEAM = {
    "calibrate": (("p",), ("c", "checks", "ticks")),
    "initial": (("t", "u", "p", "c"), ("x",)),
    "tick": (("t", "x", "u", "p", "c", "w"), ("y", "next", "checks")),
    "tick_update": (("t", "x", "u", "p", "c", "w"), ("y", "next", "checks")),
    "noise": (("r", "p", "c"), ("w",)),
    "prepare": (("x", "p", "c"), ("s",)),
    "derivative": (("t", "x", "u", "p", "c", "m", "s"), ("dx",)),
    "output": (("t", "x", "u", "p", "c", "m", "s"), ("y", "checks")),
    "event_indicators": (("t", "x", "p", "c", "s"), ("z",)),
    "output_rate": (("t", "x", "u", "p", "m", "v"), ("dy",)),
    "output_sensitivity": (("t", "x", "u", "p", "m", "v"), ("dy",)),
    "initial_sensitivity": (("t", "u", "p", "r", "v", "q"), ("dy",)),
}
"""Beginning of a function that CasADi adds for its own use, and leaves visible to other C files."""

_UNNEEDED_CONTAINED = ("output_rate", "output_sensitivity", "initial_sensitivity")
"""Functions of the seam that serve derivatives of FMI, which a model contained in a program does not have."""


@dataclass(frozen=True)
class Adapter:
    """A C function that the runtime calls and that calls CasADi's function of the same name."""

    name: str
    signature: str
    arguments: str
    results: str


def generate(model: Model) -> dict[str, str]:
    """Generate all C sources of a model, the runtime's included.

    Returns
    -------
    dict
        File name to text. ``model.c`` is the one to compile; it holds `GUID_PLACEHOLDER` where the
        GUID belongs, because the GUID is a hash of these sources.
    """
    lowered = lower(model)
    templates = _environment()
    sizes = templates.get_template("sizes.h.j2").render(
        model=model,
        sampled=isinstance(model, SampledModel),
        n=_sizes(model, lowered),
        period=model.reference(model.period_name),
        divisor=_divisor_reference(model),
        integer_outputs=any(v.type is Type.INTEGER for v in model.with_role(Role.OUTPUT)),
        whole_reals=any(v.stands_for is not None for v in model.variables),
    )
    main = templates.get_template("model.c.j2").render(
        model=model,
        guid=GUID_PLACEHOLDER,
        variables=[(v, 0.0 if v.start is None else v.start) for v in model.ordered_variables()],
        runs=_runs(model.ordered_variables()),
        sentences=_sentences(model),
        equations=EQUATIONS_SOURCE,
        functions=[_adapter(function) for function in lowered.functions],
        unneeded=_UNNEEDED_CONTAINED,
        seed=_seed_reference(model),
        whole=[v.stands_for is not None for v in model.ordered_variables()],
    )
    equations = equations_text(lowered.functions)
    return {MAIN_SOURCE: main, SIZES_SOURCE: sizes, EQUATIONS_SOURCE: equations, **runtime_sources()}


def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("adaptimp_fmu"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        # The output is C, not HTML.
        autoescape=False,  # noqa: S701  # nosec B701
    )
    environment.filters["c_number"] = _c_number
    environment.filters["c_string"] = _c_string
    return environment


def _sizes(model: Model, lowered: Lowered) -> dict[str, int]:
    noise = model.noise if isinstance(model, SampledModel) else None
    return {
        "PARAMETERS": sum(symbol.numel() for symbol in model.parameter_symbols),
        "INPUTS": sum(symbol.numel() for symbol in model.input_symbols),
        "OUTPUTS": sum(value.numel() for value in model.output_values),
        "STATES": sum(state.symbol.numel() for state in model.states),
        "CONSTANTS": lowered.n_constants,
        "SHARED": lowered.n_shared,
        "EVENTS": len(getattr(model, "events", ())),
        "NOISE": noise.symbol.numel() if noise else 0,
        "STATIC_CHECKS": len(model.static_checks),
        "CHECKS": len(model.checks),
    }


def _sentences(model: Model) -> dict[str, list[str]]:
    return {
        "model_static_checks": [check.sentence for check in model.static_checks],
        "model_checks": [check.sentence for check in model.checks],
        "model_states": [name for s in model.states for name in element_names(s.name, s.symbol.numel())],
    }


def _runs(variables: Sequence[Variable]) -> list[tuple[Variable, int]]:
    """Count, for each variable, the neighbours from it on that have its type and role, itself included."""
    lengths: list[int] = []
    following = None
    for variable in reversed(variables):
        alike = following is not None and (variable.type, variable.role) == (following.type, following.role)
        lengths.append(lengths[-1] + 1 if alike else 1)
        following = variable
    return list(zip(variables, reversed(lengths), strict=True))


def _seed_reference(model: Model) -> int | None:
    if isinstance(model, SampledModel) and model.noise:
        return model.reference(model.noise.seed_name)
    return None


def _divisor_reference(model: Model) -> int | None:
    if isinstance(model, SampledModel) and model.divisor_name:
        return model.reference(model.divisor_name)
    return None


def _adapter(function: ca.Function) -> Adapter:
    name = function.name()
    arguments, results = _SEAM[name]
    declarations = [_IN[a] for a in arguments] + [f"double *restrict {_result(r)}" for r in results]
    return Adapter(
        name=name,
        signature=", ".join(declarations),
        arguments=", ".join("&t" if a == "t" else a for a in function.name_in()),
        results=", ".join(_result(r) for r in function.name_out()),
    )


def _result(name: str) -> str:
    """Return the name of a result in C, which must differ from the names of the arguments."""
    return {"c": "constants", "x": "states", "w": "drawn", "s": "shared"}.get(name, name)


def _c_number(value: float) -> str:
    if math.isinf(value):
        return "REAL_INFINITY" if value > 0 else "-REAL_INFINITY"
    return repr(float(value))


def _c_string(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
