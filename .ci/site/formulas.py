r"""Turns formulas in LaTeX into MathML, which browsers draw without a script.

The extension arithmatex of Markdown marks a formula by an element of its class, in which the formula stands between
``\(`` and ``\)`` in a line, and between ``\[`` and ``\]`` as a block of its own.
"""

import html
import re

from latex2mathml.converter import convert

MARKED = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def with_mathml(page: str) -> str:
    """The HTML of a page with MathML in the place of its formulas."""
    return MARKED.sub(_drawn, page)


def _drawn(found: re.Match[str]) -> str:
    """MathML of one formula; the formula itself stays as what a screen reader or a search can read."""
    display = "block" if found[2] == "[" else "inline"
    latex = html.unescape(found[3]).strip()
    return f'<{found[1]} class="formula">{convert(latex, display=display)}</{found[1]}>'
