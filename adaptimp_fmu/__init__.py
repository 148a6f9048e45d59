"""A toolchain that turns a model declared with CasADi into an FMU for co-simulation (FMI 2.0).

Declare a `ContinuousModel` or a `SampledModel`, then `build` it.
"""

from adaptimp_fmu.codegen import runtime_license
from adaptimp_fmu.continuous_model import ContinuousModel
from adaptimp_fmu.documentation import present
from adaptimp_fmu.errors import DefinitionError, ToolchainError
from adaptimp_fmu.icon import Icon, Stroke
from adaptimp_fmu.metadata import Experiment, Ownership
from adaptimp_fmu.model import ANY, NOT_NEGATIVE, POSITIVE, Limits, Model
from adaptimp_fmu.package import build, default_cache
from adaptimp_fmu.sampled_model import SampledModel
from adaptimp_fmu.toolchain import PLATFORMS, Platform, host_platform
from adaptimp_fmu.variables import Role, Type, Variable

__all__ = [
    "ANY",
    "NOT_NEGATIVE",
    "PLATFORMS",
    "POSITIVE",
    "ContinuousModel",
    "DefinitionError",
    "Experiment",
    "Icon",
    "Limits",
    "Model",
    "Ownership",
    "Platform",
    "Role",
    "SampledModel",
    "Stroke",
    "ToolchainError",
    "Type",
    "Variable",
    "build",
    "default_cache",
    "host_platform",
    "present",
    "runtime_license",
]
