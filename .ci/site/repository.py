"""Links of the documents to files of the repository that are no pages: the site gets a page for each of them.

In the repository a link such as ``../orchestration/paper/scenarios.py`` leads to a file. The site holds docs/ only, and
is read where there is no repository. So each file that a page links to is shown by a page below ``source/``.
"""

import posixpath
import re
from pathlib import Path

PAGES_OUTSIDE = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
"""Pages of the site by the paths of the documents outside docs/ that they show."""
LINK = re.compile(r"(\]\()(?!\w+:)([^)#\s]+)((?:#[^)\s]*)?\))")
FENCE = re.compile(r"(^ *```.*?^ *```$)", re.MULTILINE | re.DOTALL)
KINDS = {".py": "python", ".c": "c", ".h": "c", ".toml": "toml", ".cff": "yaml", ".xml": "xml", ".csv": "text"}
MOST = 100_000
"""Bytes of a file that a page shows."""


def origin_of(site: str) -> str:
    """Path in the repository of what a page of the site shows."""
    outside = {page: path for path, page in PAGES_OUTSIDE.items()}
    return outside.get(site, f"docs/{site}")


def page_of(path: str, root: Path) -> str:
    """Page or file of the site that shows a path of the repository."""
    if path in PAGES_OUTSIDE:
        return PAGES_OUTSIDE[path]
    folder = (root / path).is_dir()
    if path.startswith("docs/"):
        return path.removeprefix("docs/") + ("/index.md" if folder else "")
    return f"source/{path}.md"


def redirected(markdown: str, site: str, origin: str, root: Path) -> str:
    """The text of a page with links that are right in the site; code is left alone.

    Parameters
    ----------
    site, origin
        Path of the page in the site, and of the document that it shows in the repository.
    root
        Folder of the repository.
    """

    def right(link: re.Match[str]) -> str:
        path = posixpath.normpath(posixpath.join(posixpath.dirname(origin), link[2]))
        if not (root / path).exists():
            return link[0]  # a page that is generated, or a mistake, which MkDocs reports
        return link[1] + posixpath.relpath(page_of(path, root), posixpath.dirname(site) or ".") + link[3]

    parts = FENCE.split(markdown)
    return "".join(part if i % 2 else LINK.sub(right, part) for i, part in enumerate(parts))


def linked_sources(root: Path) -> dict[str, str]:
    """Pages for all files and folders that a document links to, by their paths in the site.

    Raises
    ------
    ValueError
        If such a file is too long to be shown.
    """
    found: dict[str, str] = {}
    documents = [root / name for name in PAGES_OUTSIDE] + sorted((root / "docs").rglob("*.md"))
    for document in documents:
        for link in LINK.finditer(FENCE.sub("", document.read_text(encoding="utf-8"))):
            folder = document.parent.relative_to(root).as_posix()
            path = posixpath.normpath(posixpath.join(folder, link[2]))
            page = page_of(path, root)
            if (root / path).is_dir():
                found[page] = _listing(root / path, path)
            elif page.startswith("source/") and (root / path).is_file():
                found[page] = _shown(root / path, path)
    return found


def _listing(folder: Path, path: str) -> str:
    """A page that lists what a folder holds; documents by their titles."""
    lines = []
    for entry in sorted(folder.iterdir()):
        if path.startswith("docs/") and entry.suffix == ".md":
            title = entry.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")
            lines.append(f"- [{title}]({entry.name})")
        elif not entry.name.startswith("_"):
            lines.append(f"- `{entry.name}{'/' if entry.is_dir() else ''}`")
    name = Path(path).name
    title = name.capitalize() if path.startswith("docs/") else f"The folder `{path}`"
    return f"{_unlisted(path)}# {title}\n\n" + "\n".join(lines) + "\n"


def _shown(file: Path, path: str) -> str:
    """A page that shows a file as it is."""
    text = file.read_text(encoding="utf-8")
    if len(text) > MOST:
        msg = f"{path}: a page would show {len(text)} bytes, at most {MOST} are shown; link to something shorter."
        raise ValueError(msg)
    return f"{_unlisted(path)}# `{path}`\n\n````{KINDS.get(file.suffix, 'text')}\n{text.rstrip()}\n````\n"


def _unlisted(path: str) -> str:
    """Head of a page that a search does not find; pages of documents have none."""
    return "" if path.startswith("docs/") else "---\nsearch:\n  exclude: true\n---\n\n"
