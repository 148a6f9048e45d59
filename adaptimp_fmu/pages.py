"""Pages in FMUs: one look for all, self-contained, without a script; templates of other packages build on it.

A template begins with ``{% extends "page.html.j2" %}``. The macros of ``parts.html.j2`` make tables, formulas and
drawings.
"""

import jinja2

from adaptimp_fmu.mathml import mathml


def page_environment(package: str = "adaptimp_fmu") -> jinja2.Environment:
    """Return the environment of the templates of a package, which may build on the templates of this package."""
    loaders = [jinja2.PackageLoader(name) for name in dict.fromkeys((package, "adaptimp_fmu"))]
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader(loaders),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=True,
    )
    environment.filters["mathml"] = mathml
    return environment
