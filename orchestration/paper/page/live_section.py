"""Writes the live section of the page: the form, the table of claims, and what the scripts compute with."""

import json
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import jinja2

from orchestration.containers.wasm.module import host
from orchestration.paper.page.live_data import live_data, plain_script
from orchestration.paper.page.live_settings import OPEN, STATED

WORKER = ("state.js", "measures.js", "claims.js", "loop.js", "worker.js")
"""Scripts that the worker is made of, in their order."""
SCRIPTS = ("state.js", "live.js")
"""Modules of the page; the last one has the function ``start``."""
ABOUT = {
    STATED: "The numbers that the paper gives. A slider reaches from a quarter of the number to four times of it; a field"
    " takes any number.",
    OPEN: "The paper leaves these open. Each slider shows the plausible range, and says why.",
}


def live_section(hashes: Mapping[str, str] | None = None) -> str:
    """Write the section as HTML, with the data and the text of the worker in it.

    Parameters
    ----------
    hashes
        As in `orchestration.paper.page.live_data.live_data`.
    """
    data = live_data(hashes)
    groups = [(title, about, [s for s in data["settings"] if s["group"] == title]) for title, about in ABOUT.items()]
    return _template("live.html.j2").render(
        **data, groups=groups, data=safe_json(data), worker=in_script(worker_text())
    )


def live_style() -> str:
    """The style sheet of the section."""
    return _text("templates/live.css")


def worker_text() -> str:
    """The text of the worker: the host of the modules and the scripts of the page, as one script without imports."""
    return "\n".join(map(plain_script, [host().decode(), *(_text(f"script/{name}") for name in WORKER)]))


def safe_json(value: Any) -> str:
    """A value as JSON that can stand in a script element: no text in it can end the element."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False).replace("<", r"\u003c")


def in_script(text: str) -> str:
    """A script that can stand in a script element of a page.

    Raises
    ------
    ValueError
        If the text would end the element, or open a comment in it.
    """
    for mark in ("</script", "<!--", "<script"):
        if mark in text.lower():
            msg = f"A script of the page has {mark} in it, which would end it; write it in two parts."
            raise ValueError(msg)
    return text


def _template(name: str) -> jinja2.Template:
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    return environment.from_string(_text(f"templates/{name}"))


def _text(path: str) -> str:
    return (files("orchestration.paper.page") / path).read_text(encoding="utf-8")
