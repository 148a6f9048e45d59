"""The documentation site builds without a warning, its links lead somewhere, and it needs no other machine.

Notebooks are executed by `tests.scenarios.test_notebook`; here they are shown without what their cells give.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from lxml import html

import adaptimp_fmu
import orchestration
from fmus.catalog import MODELS, VARIANTS
from orchestration.paper.scenarios import ALL_SCENARIOS
from tests.faults.test_cli_examples import COMMANDS
from tests.interop.wasm.test_browser import CHROMIUM, QUIET
from tests.scenarios.pages import PAGES, ROOT
from tests.untested import needs

LOADED = {
    "link": "href",
    "script": "src",
    "img": "src",
    "iframe": "src",
    "source": "src",
    "video": "src",
    "object": "data",
}
"""Attributes by the element for which a browser loads something."""
IN_STYLE = re.compile(r"""url\(\s*["']?(?!data:|#)([^"')]+)|@import\s+["']([^"']+)""")

ASKED = """<script>
setTimeout(() => {
  document.body.dataset.asked = JSON.stringify(performance.getEntriesByType("resource").map((one) => one.name));
}, 6000);
</script>"""
"""Writes into a page what it has loaded."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built site."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", str(ROOT / ".mkdocs.yml"), "-d", str(folder)]
    quiet = {"ADAPTIMP_SITE_NOTEBOOKS": "false", "NO_MKDOCS_2_WARNING": "1"}
    run = subprocess.run(command, cwd=ROOT, env={**os.environ, **quiet}, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert "WARNING" not in run.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[str, html.HtmlElement]:
    """All pages by their paths in the site; that for lost readers has links from the root of a server."""
    found = {path.relative_to(site).as_posix(): html.parse(str(path)).getroot() for path in site.rglob("*.html")}
    return {path: page for path, page in found.items() if path != "404.html"}


def test_every_document_is_a_page(pages: dict[str, html.HtmlElement]) -> None:
    outside = {"README.md": "index.html", "CONTRIBUTING.md": "contributing.html", "CHANGELOG.md": "changelog.html"}
    for page in PAGES:
        assert outside.get(page, page.removeprefix("docs/").replace(".md", ".html")) in pages
    for notebook in (ROOT / "docs").glob("*.ipynb"):
        assert f"{notebook.stem}.html" in pages


def test_nothing_is_loaded_from_elsewhere(site: Path, pages: dict[str, html.HtmlElement]) -> None:
    for path, page in pages.items():
        for element in page.iter(*LOADED):
            address = element.get(LOADED[str(element.tag)]) or ""
            here = not urlsplit(address).netloc or element.get("rel") == "canonical"
            assert here, f"{path} loads {address}"
        for style in page.iter("style"):
            assert not IN_STYLE.search(style.text or ""), f"{path}: a style loads something"
    for sheet in site.rglob("*.css"):
        for found in IN_STYLE.finditer(sheet.read_text(encoding="utf-8")):
            assert not urlsplit(found[1] or found[2]).netloc, f"{sheet.name} loads {found[0]}"


def test_links_lead_somewhere(site: Path, pages: dict[str, html.HtmlElement]) -> None:
    places = {
        path: {e.get("id") or e.get("name") for e in page.iter() if isinstance(e.tag, str)}
        for path, page in pages.items()
    }
    for path, page in pages.items():
        for link in page.iter("a"):
            parts = urlsplit(link.get("href") or "")
            if parts.scheme or parts.netloc or link.get("href") is None:
                continue
            target = (site / path).parent / unquote(parts.path) if parts.path else site / path
            target = Path(os.path.normpath(target))
            assert target.exists(), f"{path} links to {link.get('href')}"
            if parts.fragment and target.suffix == ".html":
                known = places[target.relative_to(site).as_posix()]
                assert unquote(parts.fragment) in known, f"{path} links to {link.get('href')}"


def test_the_reference_has_everything(pages: dict[str, html.HtmlElement]) -> None:
    ids = {
        element.get("id") for path, page in pages.items() if "/api/" in path for element in page.iter("h2", "h3", "div")
    }
    names = {f"orchestration.{name}" for name in orchestration.__all__} | {
        f"adaptimp_fmu.{n}" for n in adaptimp_fmu.__all__
    }
    listed = {name for name in names if name in ids or f"{name.partition('.')[0]}.{name.rpartition('.')[2]}" in ids}
    assert names - listed == set()
    for page, expected in (
        ("all-options", {f"adaptimp {command}" for command in COMMANDS}),
        ("variables", set(MODELS) | set(VARIANTS)),
        ("scenarios", set(ALL_SCENARIOS)),
    ):
        headings = {heading.text for heading in pages[f"reference/{page}.html"].iter("h2")}
        assert expected <= headings, page


def test_formulas_are_drawn_without_a_script(pages: dict[str, html.HtmlElement]) -> None:
    formulas = pages["impedance-control.html"].xpath("//*[local-name()='math']")
    assert len(formulas) > 20
    for path, page in pages.items():
        assert not page.xpath("//*[@class='arithmatex']"), f"{path} has a formula that is not drawn"


def looked_at(page: Path, folder: Path, further: str = "") -> tuple[str, set[str]]:
    """The text of a page in Chromium, and the hosts that it has asked, not its folder; `further` is HTML at its end."""
    probe = page.with_name(f"probe-{page.name}")
    probe.write_text(page.read_text(encoding="utf-8").replace("</body>", f"{further}{ASKED}</body>"), encoding="utf-8")
    root = ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    options = [*QUIET, *root, f"--user-data-dir={folder / 'profile'}", "--virtual-time-budget=8000", "--dump-dom"]
    command = [str(CHROMIUM), *options, f"{probe.as_uri()}?q=impedance"]
    shown = html.fromstring(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    asked = json.loads(shown.xpath("//body/@data-asked")[0])
    return shown.text_content(), {urlsplit(url).netloc for url in asked} - {""}


@pytest.mark.skipif(CHROMIUM is None, reason=needs("Chromium is not installed", "chromium"))
def test_a_browser_searches_in_a_folder_and_asks_nobody(site: Path, tmp_path: Path) -> None:
    said, hosts = looked_at(site / "index.html", tmp_path)
    found = re.search(r"(\d+) matching documents", said)
    assert found, "the search says how many documents it has found"
    assert int(found[1]) > 5
    assert hosts == set()


@pytest.mark.skipif(CHROMIUM is None, reason=needs("Chromium is not installed", "chromium"))
def test_a_page_that_asks_another_host_is_noticed(site: Path, tmp_path: Path) -> None:
    _, hosts = looked_at(site / "why-fmus.html", tmp_path, '<img src="http://127.0.0.1:8/x.png">')
    assert hosts == {"127.0.0.1:8"}
