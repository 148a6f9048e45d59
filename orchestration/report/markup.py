"""Markup from templates: texts of strangers are escaped, and characters that would hide or turn a text are removed."""

from collections.abc import Sequence
from typing import Any

import jinja2
from markupsafe import Markup

from orchestration.errors import printable
from orchestration.fmi.display import escaped

MOST_ON_A_PHONE = 3  # columns that fit
MOST_OPEN = 2  # runs whose parts are not folded


def render(package: str, name: str, **values: Any) -> Markup:
    """Fill a template of a package's folder ``templates``.

    Parameters
    ----------
    values
        What the template shows; only `Markup` reaches the page as it is.
    """
    loader = jinja2.PackageLoader(package)
    environment = jinja2.Environment(
        loader=loader,
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        finalize=lambda value: printable(value) if type(value) is str else value,
    )
    return marked(environment.get_template(name).render(**values))


def marked(html: str) -> Markup:
    """HTML of our own as `Markup`: the one place that trusts a text, in which those of strangers are escaped by now."""
    return Markup(html)  # noqa: S704  # nosec B704


def table(head: Sequence[str], rows: Sequence[Sequence[object]], caption: str = "") -> Markup:
    """A table; one of many columns becomes a list on a narrow screen. Numbers are aligned right.

    Parameters
    ----------
    rows
        Cells; a float is shown with six digits, `Markup` as it is.
    """
    kind = ' class="stack"' if len(head) > MOST_ON_A_PHONE else ""
    names = "".join(f'<th scope="col">{escaped(name)}</th>' for name in head)
    body = "".join(f"<tr>{''.join(map(_cell, head, row))}</tr>" for row in rows)
    title = f"<caption>{escaped(caption)}</caption>" if caption else ""
    content = f"{title}<thead><tr>{names}</tr></thead><tbody>{body}</tbody>"
    return marked(f'<div class="table"><table{kind}>{content}</table></div>')


def for_run(label: str, html: Markup, runs: int) -> Markup:
    """What is said of one of several runs, below its label; of more than two runs it is folded at first."""
    if runs == 1:
        return html
    opened = Markup(" open") if runs <= MOST_OPEN else ""
    frame = Markup('<details class="run"{}><summary>{}</summary>{}</details>')
    return frame.format(opened, printable(label), html)


def _cell(name: str, value: object) -> str:
    label = f' data-label="{escaped(name)}"'
    if isinstance(value, float):
        return f'<td class="number"{label}>{value + 0.0:.6g}</td>'
    return f"<td{label}>{value if isinstance(value, Markup) else escaped(str(value))}</td>"
