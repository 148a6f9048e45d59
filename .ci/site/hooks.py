"""Makes the documentation site whole: pages that are generated, links that leave docs/, formulas, the navigation.

MkDocs calls the functions of this module by their names, in the order in which they stand here.
"""

import re
from pathlib import Path
from typing import Any

from formulas import with_mathml
from generated import reference_pages
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from navigation import expanded
from repository import PAGES_OUTSIDE, linked_sources, origin_of, redirected

ROOT = Path(__file__).parents[2]
NOTEBOOK_LINK = re.compile(r'(<a href="(?!\w+:)[^"#]+)\.(?:md|ipynb)(?=["#])')


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the pages that are no files of docs/, then expand the patterns of the navigation."""
    pages = {site: (ROOT / path).read_text(encoding="utf-8") for path, site in PAGES_OUTSIDE.items()}
    pages |= reference_pages()
    pages |= linked_sources(ROOT)
    for site, text in pages.items():
        files.append(File.generated(config, site, content=text))
    config.nav = expanded(config.nav or [], [file.src_uri for file in files.documentation_pages()])
    return files


def on_page_markdown(markdown: str, *, page: Page, **_: Any) -> str:
    """Turn links that are right in the repository into links that are right in the site."""
    return redirected(markdown, page.file.src_uri, origin_of(page.file.src_uri), ROOT)


def on_page_content(html: str, *, page: Page, **_: Any) -> str:
    """Typeset formulas, and let links of a notebook lead to pages, not to documents."""
    found = with_mathml(html)
    return NOTEBOOK_LINK.sub(r"\1.html", found) if page.file.src_uri.endswith(".ipynb") else found
