"""Pages for the tests in a browser, and the browser: Debian's Chromium, driven by Playwright."""

import shutil
import subprocess
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, ConsoleMessage, Error, Page, Request, sync_playwright

from orchestration import Result, scenario, simulate
from orchestration.paper.page.report import report_page, write_page
from tests.untested import needs

HERE = Path(__file__).parent
CHROMIUM = shutil.which("chromium")
TOOLS = HERE / "node_modules"
AXE = TOOLS / "axe-core" / "axe.min.js"
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"]
FLAGS += ["--disable-component-update", "--disable-sync"]
HOSTILE = "</script><img src=x onerror=alert(1)>"
"""What a stranger may call a variable or a system."""
NO_CHROMIUM = needs("pages in a browser: chromium is not installed", "chromium")
NO_TOOLS = "tools for pages are not installed; run npm install in tests/browser"


@dataclass
class Opened:
    """A page that was opened from its file, and what it did besides showing itself.

    Attributes
    ----------
    requests
        Addresses outside of the page that it asked for.
    complaints
        Errors and warnings on the console, and exceptions.
    """

    page: Page
    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def watch(self) -> None:
        """Note what the page does from now on."""
        self.page.on("request", self._requested)
        self.page.on("console", self._said)
        self.page.on("pageerror", self._failed)

    def _requested(self, request: Request) -> None:
        if not request.url.startswith(("data:", "blob:")):
            self.requests.append(request.url)

    def _said(self, message: ConsoleMessage) -> None:
        if message.type in ("error", "warning"):
            self.complaints.append(message.text)

    def _failed(self, error: Error) -> None:
        self.complaints.append(error.message)

    def ready(self) -> float:
        """Wait until the page is ready, and return after how many ms it was."""
        self.page.wait_for_selector("html[data-ready]", state="attached")
        return float(self.page.evaluate("document.documentElement.dataset.ready"))


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Chromium; tests are skipped where it is not installed."""
    if CHROMIUM is None:
        pytest.skip(NO_CHROMIUM)
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield started
        started.close()


@pytest.fixture(scope="session")
def results() -> Mapping[str, Result]:
    """A run of Fig. 5 with 200,001 rows, and one of Fig. 2."""
    return {name: simulate(scenario(name), verdict=True) for name in ("fig5", "fig2")}


@pytest.fixture(scope="session")
def stranger() -> Result:
    """A run of a system that is no robot, with names that are markup, and values that are no numbers."""
    time = np.array([0.0, 0.1, 0.15, 0.4, 1.0])  # s, uneven
    rows = np.column_stack([time**2, [1.0, np.nan, np.inf, -np.inf, 2.0], np.full(5, 3.0)])
    names = ("tank.level", f"tank.{HOSTILE}", "tank.constant")
    return Result(time, names, rows, units={"tank.level": "m", names[1]: HOSTILE}, metadata={"system": HOSTILE})


@pytest.fixture(scope="session")
def pages(tmp_path_factory: pytest.TempPathFactory, results: Mapping[str, Result], stranger: Result) -> Path:
    """A folder with the pages ``fig5.html``, ``both.html`` and ``stranger.html``."""
    folder = tmp_path_factory.mktemp("pages")
    systems = {"fig5": scenario("fig5")}
    write_page(report_page({"fig5": results["fig5"]}, systems), folder / "fig5.html")
    write_page(report_page(results), folder / "both.html")
    write_page(report_page({HOSTILE: stranger}), folder / "stranger.html")
    return folder


def opened(browser: Browser, file: Path, width: int = 1280, scheme: str = "light") -> Opened:
    """Open a page from its file in a window of its own."""
    dark = scheme == "dark"
    context = browser.new_context(
        viewport={"width": width, "height": 800}, color_scheme="dark" if dark else "light", reduced_motion="reduce"
    )
    found = Opened(context.new_page())
    found.watch()
    found.page.goto(file.as_uri())
    return found


def run_tool(*words: str, cwd: Path = HERE) -> str:
    """What a tool of the folder complains of; empty if it finds nothing. The test is skipped without the tools."""
    if not AXE.exists():
        pytest.skip(NO_TOOLS)
    program = TOOLS / ".bin" / words[0]
    done = subprocess.run([program, *words[1:]], cwd=cwd, capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else done.stdout + done.stderr
