"""A toolchain that turns a model declared with CasADi into an FMU for co-simulation (FMI 2.0).

Declare a `ContinuousModel` or a `SampledModel`, then `build` it.
"""

from typing import TYPE_CHECKING, Any

from adaptimp_fmu.files.parts import imported

if TYPE_CHECKING:
    from adaptimp_fmu.continuous_model import ContinuousModel
    from adaptimp_fmu.documentation import present
    from adaptimp_fmu.errors import DefinitionError, ToolchainError
    from adaptimp_fmu.guide import Drawing, Example, Formula, Formulas, Grid, Guide, Numbers, Signal
    from adaptimp_fmu.icon import Icon, Stroke
    from adaptimp_fmu.metadata import Experiment, Ownership
    from adaptimp_fmu.model import ANY, NOT_NEGATIVE, POSITIVE, Limits, Model
    from adaptimp_fmu.package import build, default_cache
    from adaptimp_fmu.references import ParameterSet, ReferenceRun
    from adaptimp_fmu.runtime_files import runtime_license
    from adaptimp_fmu.sampled_model import SampledModel
    from adaptimp_fmu.terminals import Terminal, terminals_and_icons
    from adaptimp_fmu.toolchain import PLATFORMS, Platform, host_platform
    from adaptimp_fmu.variables import Role, Type, Variable

_HOME = {
    "ANY": "model",
    "NOT_NEGATIVE": "model",
    "PLATFORMS": "toolchain",
    "POSITIVE": "model",
    "ContinuousModel": "continuous_model",
    "DefinitionError": "errors",
    "Drawing": "guide",
    "Example": "guide",
    "Experiment": "metadata",
    "Formula": "guide",
    "Formulas": "guide",
    "Grid": "guide",
    "Guide": "guide",
    "Icon": "icon",
    "Limits": "model",
    "Model": "model",
    "Numbers": "guide",
    "Ownership": "metadata",
    "ParameterSet": "references",
    "Platform": "toolchain",
    "ReferenceRun": "references",
    "Role": "variables",
    "SampledModel": "sampled_model",
    "Signal": "guide",
    "Stroke": "icon",
    "Terminal": "terminals",
    "ToolchainError": "errors",
    "Type": "variables",
    "Variable": "variables",
    "build": "package",
    "default_cache": "package",
    "host_platform": "toolchain",
    "present": "documentation",
    "runtime_license": "runtime_files",
    "terminals_and_icons": "terminals",
}

__all__ = [
    "ANY",
    "NOT_NEGATIVE",
    "PLATFORMS",
    "POSITIVE",
    "ContinuousModel",
    "DefinitionError",
    "Drawing",
    "Example",
    "Experiment",
    "Formula",
    "Formulas",
    "Grid",
    "Guide",
    "Icon",
    "Limits",
    "Model",
    "Numbers",
    "Ownership",
    "ParameterSet",
    "Platform",
    "ReferenceRun",
    "Role",
    "SampledModel",
    "Signal",
    "Stroke",
    "Terminal",
    "ToolchainError",
    "Type",
    "Variable",
    "build",
    "default_cache",
    "host_platform",
    "present",
    "runtime_license",
    "terminals_and_icons",
]


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)


def __getattr__(name: str) -> Any:
    """Import a public name when it is used first: `adaptimp_fmu.files` also serves programs that need no CasADi."""
    if name not in _HOME:
        msg = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(msg)
    value = getattr(imported(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value
