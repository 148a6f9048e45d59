"""The pages in ``documentation/`` of an FMU: equations, interface, semantics, how to rebuild it, and its owner.

The equations are the docstrings of the modules that declare them, word for word.
"""

import importlib
import inspect
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import jinja2

from adaptimp_fmu.continuous_model import ContinuousModel
from adaptimp_fmu.description import number
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.icon import Icon
from adaptimp_fmu.model import Model
from adaptimp_fmu.related_files import FOLDER, MANIFEST, RelatedFile
from adaptimp_fmu.runtime_files import RUNTIME_LICENSE, runtime_sources
from adaptimp_fmu.sampled_model import SampledModel
from adaptimp_fmu.variables import Role, Type, Variable

INDEX = "index.html"
REFERENCES = "fmi-ls-ref.html"  # the place that the layered standard recommends
LICENSE = "licenses/license.txt"  # the place FMI 2.0.5, section 2.3, reserves for it
_LIMITS = ("MAX_TICKS", "MAX_SUBSTEPS", "FIRST_EVENTS", "EVENTS_PER_SUBSTEP")


@dataclass(frozen=True)
class Row:
    """A row of an interface table: texts about a variable of a model."""

    name: str
    type: str
    unit: str
    start: str
    minimum: str
    maximum: str
    tunable: str
    description: str


def present(model: Model, icon: Icon, *modules: str) -> None:
    """Give a model its icon, and the docstrings of modules as its documentation.

    Parameters
    ----------
    modules
        Names of the modules whose docstrings hold the equations, the model's own module first.

    Raises
    ------
    DefinitionError
        If a docstring is missing.

    Examples
    --------
    >>> from adaptimp_fmu import ContinuousModel, Icon, present
    >>> model = ContinuousModel("Plant", "An arm")
    >>> present(model, Icon(colour=(40, 90, 140)), "fmus.plant", "fmus.mechanics.planar_arm")
    >>> list(model.documentation)
    ['fmus.plant', 'fmus.mechanics.planar_arm']
    """
    texts = {name: importlib.import_module(name).__doc__ for name in modules}
    for name, text in texts.items():
        if not text:
            msg = f"{model.name}: {name} has no docstring to document it; do not run Python with -OO."
            raise DefinitionError(msg)
    model.icon = icon
    model.documentation = {name: inspect.cleandoc(text) for name, text in texts.items() if text}


def documentation(model: Model, related: Sequence[RelatedFile] = ()) -> dict[str, bytes]:
    """Return the files of ``documentation/`` in an FMU by name; the same model gives the same files.

    Parameters
    ----------
    related
        Reference runs and parameter sets that lie in ``extra/`` of the FMU. A page of their own explains them.
    """
    page = _environment().get_template("documentation.html.j2")
    html = page.render(
        model=model,
        sampled=isinstance(model, SampledModel),
        noisy=isinstance(model, SampledModel) and model.noise is not None,
        whole=any(variable.stands_for for variable in model.variables),
        divisor=model.divisor_name if isinstance(model, SampledModel) else None,
        events=[event.name for event in model.events] if isinstance(model, ContinuousModel) else [],
        tables={
            "Inputs": _rows(model, Role.INPUT),
            "Outputs": _rows(model, Role.OUTPUT),
            "Parameters": _rows(model, Role.FIXED_PARAMETER, Role.TUNABLE_PARAMETER),
        },
        demands=[check.sentence for check in (*model.static_checks, *model.checks)],
        limits=_limits(),
        license_file=LICENSE,
        runtime_license=RUNTIME_LICENSE,
        references=REFERENCES if related else "",
    )
    pages = {INDEX: html.encode()}
    if related:
        page = _environment().get_template("references.html.j2")
        html = page.render(model=model, files=related, folder=FOLDER, manifest=MANIFEST, index=INDEX)
        pages[REFERENCES] = html.encode()
    if model.ownership.license_text:
        pages[LICENSE] = model.ownership.license_text.encode()
    return pages


def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.PackageLoader("adaptimp_fmu"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=True,
    )


def _rows(model: Model, *roles: Role) -> list[Row]:
    return [_row(variable) for variable in model.ordered_variables() if variable.role in roles]


def _row(variable: Variable) -> Row:
    bounded = variable.type is not Type.BOOLEAN
    return Row(
        name=variable.name,
        type=variable.type.value if not variable.stands_for else f"Real, {variable.range}",
        unit=variable.unit,
        start="" if variable.start is None else number(variable.start, variable.type),
        minimum=_bound(variable.minimum, variable.type) if bounded else "",
        maximum=_bound(variable.maximum, variable.type) if bounded else "",
        tunable="yes" if variable.role is Role.TUNABLE_PARAMETER else "",
        description=variable.description,
    )


def _bound(value: float, type: Type) -> str:
    return number(value, type) if math.isfinite(value) else ""


def _limits() -> dict[str, str]:
    """Return limits of the runtime by name, read from its sources, so that this page cannot contradict them."""
    sources = "\n".join(runtime_sources().values())
    limits = {}
    for name in _LIMITS:
        match = re.search(rf"#define {name} (\S+)", sources)
        if match is None:
            msg = f"The runtime defines no {name}, which the documentation states."
            raise DefinitionError(msg)
        limits[name] = match[1]
    return limits
