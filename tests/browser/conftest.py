"""Pages for the tests in a browser, and the browser: Debian's Chromium, driven by Playwright."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, sync_playwright

HERE = Path(__file__).parent
CHROMIUM = shutil.which("chromium")
AXE = HERE / "node_modules" / "axe-core" / "axe.min.js"
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"]
FLAGS += ["--disable-component-update", "--disable-sync"]


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Chromium; tests are skipped where it is not installed."""
    if CHROMIUM is None:
        pytest.skip("chromium is not installed; install Debian's package chromium")
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield started
        started.close()


@pytest.fixture(scope="session")
def tools() -> Path:
    """The folder with the tools of tests/browser/package.json; tests are skipped where they are not installed."""
    if not AXE.exists():
        pytest.skip("tools for pages are not installed; run npm install in tests/browser")
    return HERE / "node_modules"


def run_tool(*words: str) -> str:
    """What a tool of the folder says; empty if it finds nothing."""
    done = subprocess.run(["npx", "--no-install", *words], cwd=HERE, capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else done.stdout + done.stderr
