"""The pages in ``documentation/`` of an FMU: how to connect it, its equations, its rules, its owner.

Everything follows from the declaration of the model and from its `Guide`. The docstrings of the modules that declare
the equations stand on the page word for word.
"""

import importlib
import inspect
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from adaptimp_fmu.continuous_model import ContinuousModel
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.grids import legends
from adaptimp_fmu.guide import Formulas
from adaptimp_fmu.icon import Icon
from adaptimp_fmu.interface_tables import display_units, ports, tables, topics
from adaptimp_fmu.model import Model
from adaptimp_fmu.pages import page_environment
from adaptimp_fmu.related_files import FOLDER, MANIFEST, RelatedFile
from adaptimp_fmu.runtime_files import RUNTIME_LICENSE, runtime_sources
from adaptimp_fmu.sampled_model import SampledModel
from adaptimp_fmu.variables import Role

FORMULAS = "FORMULAS"
"""Name of the constant of a module that holds its formulas, a value of type `Formulas`."""
INDEX = "index.html"
REFERENCES = "fmi-ls-ref.html"  # the place that the layered standard recommends
LICENSE = "licenses/license.txt"  # the place FMI 2.0.5, section 2.3, reserves for it
_INTERFACE = {"Inputs": Role.INPUT, "Outputs": Role.OUTPUT}
_INDEX = re.compile(r"\[\d+\]")
_MANY, _MANY_ELEMENTS = 3, 9
"""Up to how often a sentence stands on a page word for word, and for how many elements."""
_LIMITS = ("MAX_TICKS", "MAX_SUBSTEPS", "FIRST_EVENTS", "EVENTS_PER_SUBSTEP")


def present(model: Model, icon: Icon, *modules: str) -> None:
    """Give a model its icon, and the docstrings and formulas of modules as its documentation.

    The formulas are the module's constant ``FORMULAS``, if there is one.

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
    found = [importlib.import_module(name) for name in modules]
    texts = {name: module.__doc__ for name, module in zip(modules, found, strict=True)}
    for name, text in texts.items():
        if not text:
            msg = f"{model.name}: {name} has no docstring to document it; do not run Python with -OO."
            raise DefinitionError(msg)
    model.icon = icon
    model.documentation = {name: inspect.cleandoc(text) for name, text in texts.items() if text}
    stated = [getattr(module, FORMULAS, None) for module in found]
    formulas = [group for group in stated if isinstance(group, Formulas)]
    model.guide = replace(model.guide, formulas=formulas)


def documentation(model: Model, related: Sequence[RelatedFile] = ()) -> dict[str, bytes]:
    """Return the files of ``documentation/`` in an FMU by name; the same model gives the same files.

    Parameters
    ----------
    related
        Reference runs and parameter sets that lie in ``extra/`` of the FMU. A page of their own explains them.
    """
    environment = page_environment()
    page = environment.get_template("documentation.html.j2")
    html = page.render(
        model=model,
        sampled=isinstance(model, SampledModel),
        noisy=isinstance(model, SampledModel) and model.noise is not None,
        whole=any(variable.stands_for for variable in model.variables),
        divisor=model.divisor_name if isinstance(model, SampledModel) else None,
        events=[event.name for event in model.events] if isinstance(model, ContinuousModel) else [],
        inputs=ports(model, Role.INPUT),
        outputs=ports(model, Role.OUTPUT),
        topics=topics(model),
        legends=legends(model),
        shown=display_units(model),
        tables={title: tables(model, model.with_role(role)) for title, role in _INTERFACE.items()},
        demands=_demands(model),
        limits=_limits(),
        license_file=LICENSE,
        runtime_license=RUNTIME_LICENSE,
        references=REFERENCES if related else "",
    )
    pages = {INDEX: html.encode()}
    if related:
        page = environment.get_template("references.html.j2")
        html = page.render(model=model, files=related, folder=FOLDER, manifest=MANIFEST, index=INDEX)
        pages[REFERENCES] = html.encode()
    if model.ownership.license_text:
        pages[LICENSE] = model.ownership.license_text.encode()
    return pages


def _demands(model: Model) -> list[str]:
    """Sentences of the checks; what many elements share stands once, with the index i in the place of their numbers."""
    sentences = [check.sentence for check in (*model.static_checks, *model.checks)]
    indexed = {sentence: _INDEX.sub("[i]", sentence) for sentence in sentences}
    alike, same = Counter(indexed[sentence] for sentence in dict.fromkeys(sentences)), Counter(sentences)
    found: list[str] = []
    for sentence in sentences:
        one = f"{indexed[sentence]}, for each i" if alike[indexed[sentence]] > _MANY_ELEMENTS else sentence
        if one not in found or (one == sentence and same[sentence] <= _MANY):
            found.append(one)
    return found


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
