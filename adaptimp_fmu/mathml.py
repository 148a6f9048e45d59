r"""Formulas as MathML, which browsers typeset without a script and without a network.

The source of a formula is LaTeX, ``M \ddot{x} + K x = F``. It is converted when the FMU is built.
"""

import re
from functools import cache

from lxml import etree

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.files.parts import require

_ARGUMENTS = {
    **dict.fromkeys(("mfrac", "mover", "mroot", "msub", "msup", "munder"), 2),
    **dict.fromkeys(("msubsup", "munderover"), 3),
}
"""Elements of MathML that need so many parts; the converter leaves out what the formula lacks."""
_UNKNOWN = re.compile(r"\\[A-Za-z]+")


@cache
def mathml(latex: str, *, block: bool = True) -> str:
    """Return a formula as an element ``math``.

    Parameters
    ----------
    latex
        The formula as LaTeX of the mathematical mode, without dollar signs.
    block
        Whether the formula stands in a line of its own; else in the line of a text.

    Raises
    ------
    DefinitionError
        If the text is not LaTeX, or has a command that the converter does not know.
    MissingPartError
        If the converter is not installed.

    Examples
    --------
    >>> from adaptimp_fmu.mathml import mathml
    >>> mathml("a", block=False)
    '<math xmlns="http://www.w3.org/1998/Math/MathML" display="inline"><mrow><mi>a</mi></mrow></math>'
    """
    require("latex2mathml")  # not at the import: where nothing is built, formulas are only declared
    from latex2mathml.converter import convert

    try:
        text = convert(latex, display="block" if block else "inline")
    except Exception as error:  # the converter has a class for each fault, and IndexError
        msg = f"Formula {latex!r} is not LaTeX that can be typeset ({type(error).__name__}); correct the formula."
        raise DefinitionError(msg) from error
    if unknown := _UNKNOWN.search(text):
        msg = f"Formula {latex!r}: the command {unknown[0]} is not known; write the formula without it."
        raise DefinitionError(msg)
    if (fault := _incomplete(latex, text)) is not None:
        msg = f"Formula {latex!r} is incomplete: {fault}; complete the formula."
        raise DefinitionError(msg)
    return text


def _incomplete(latex: str, text: str) -> str | None:
    """What a formula lacks, although the converter took it."""
    braces = re.findall(r"\\.|[{}]", latex)
    opened, closed = braces.count("{"), braces.count("}")
    if opened != closed:
        return f"{opened} braces open and {closed} close"
    for element in etree.fromstring(text).iter():
        name = etree.QName(element).localname
        if len(element) != _ARGUMENTS.get(name, len(element)):
            return f"{name} has {len(element)} of {_ARGUMENTS[name]} parts"
    return None
