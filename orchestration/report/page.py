"""A self-contained HTML page: sections, modules of JavaScript, and the data that they read.

Nothing of the page is loaded from elsewhere. Each module of JavaScript stands in the import map of the page under the
name of its file, so modules import each other as they do in their folders. Texts of strangers reach the page through
the template, which escapes them, or as JSON without ``<``.
"""

import base64
import importlib.resources
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from markupsafe import Markup

from orchestration.errors import OrchestrationError
from orchestration.report.encoding import packed_bytes
from orchestration.report.markup import marked, render

_IMPORT = re.compile(r"""(\bfrom\s+|\bimport\s+)(["'])(?:\.{1,2}/)+(?:[\w-]+/)*([\w-]+\.m?js)\2""")
"""An import of a module by a relative path; the last group is the name of its file."""
BOKEH = "bokeh"
"""Id of the block with the scripts of Bokeh."""


@dataclass(frozen=True)
class Section:
    """A part of a page with a heading.

    Attributes
    ----------
    id
        Anchor of the section.
    title
        The heading, a plain text.
    html
        What stands below the heading: markup, in which texts of strangers are escaped.
    """

    id: str
    title: str
    html: str


@dataclass(frozen=True)
class Page:
    """A page before it is written.

    Attributes
    ----------
    title, lead
        Heading of the page and the sentence below, plain texts.
    sections
        In the order of the page.
    data
        Values by the id of their block, for ``json(id)`` of ``data.js``; the block ``runs`` must be among them.
    blocks
        Bytes by the id of their block, for ``block(id)`` of ``data.js``.
    modules
        Files of JavaScript besides those of this folder. Of each file in `starts` the page calls ``start``.
    starts
        Names of files among the modules.
    """

    title: str
    lead: str
    sections: Sequence[Section]
    data: Mapping[str, Any]
    blocks: Mapping[str, bytes] = field(default_factory=dict)
    modules: Sequence[Path] = ()
    starts: Sequence[str] = ()

    def html(self) -> str:
        """The page as a text.

        Raises
        ------
        OrchestrationError
            If two modules have the same name.
        """
        texts = _module_texts([*own_modules(), *self.modules])
        imports = {name: f"data:text/javascript;base64,{_base64(text)}" for name, text in texts.items()}
        contents = {BOKEH: bokeh_scripts(), **self.blocks}
        return render(
            "orchestration.report",
            "page.html.j2",
            title=self.title,
            lead=self.lead,
            style=marked(read_text("style", "page.css")),
            sections=[(section, marked(section.html)) for section in self.sections],
            data={name: script_json(value) for name, value in self.data.items()},
            import_map=script_json({"imports": imports}),
            blocks={name: marked(packed_bytes(content)) for name, content in contents.items()},
            starts=self.starts,
        )


def own_modules() -> list[Path]:
    """Files of JavaScript that every page carries."""
    folder = Path(str(importlib.resources.files("orchestration.report"))) / "script"
    return sorted(folder.glob("*.js"))


def read_text(folder: str, name: str) -> str:
    """A file of a folder beside this module."""
    return (importlib.resources.files("orchestration.report") / folder / name).read_text(encoding="utf-8")


def bokeh_scripts() -> bytes:
    """The scripts of Bokeh that a page carries, as one script, from the installed package."""
    from bokeh.settings import settings

    folder = Path(settings.bokehjs_path()) / "js"
    return b"\n;\n".join((folder / f"{name}.min.js").read_bytes() for name in ("bokeh", "bokeh-api"))


def script_json(value: Any) -> Markup:
    """JSON that can stand in a script of a page: without ``<``, which could end the script."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return marked(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def _module_texts(files: Sequence[Path]) -> dict[str, str]:
    """Modules by the names of their files; imports by path become imports by name."""
    texts: dict[str, str] = {}
    for file in files:
        if file.name in texts:
            msg = f"{file.name}: two modules of the page have this name; give one of them another name."
            raise OrchestrationError(msg)
        texts[file.name] = _IMPORT.sub(r"\1\2\3\2", file.read_text(encoding="utf-8"))
    return texts


def _base64(text: str) -> str:
    return base64.b64encode(text.encode("utf-8")).decode("ascii")
