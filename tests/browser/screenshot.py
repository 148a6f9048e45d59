"""Takes the screenshot of README.md: the arm and the plots of the paper's page while the tip slides along the wall.

uv run adaptimp paper && uv run python -m tests.browser.screenshot out/report.html docs/images/page.png
"""

import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

from tests.browser.conftest import CHROMIUM, FLAGS

WIDTH, HEIGHT = 1280, 860  # pixels
SLIDING = 0.5  # of the time of the run
DRAWN = 1500  # ms until the plots have drawn


def take(page: Path, picture: Path) -> None:
    """Write the screenshot of a page as a PNG file."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        shown = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, color_scheme="light")
        shown.goto(page.resolve().as_uri())
        shown.wait_for_selector("html[data-ready]", state="attached")
        shown.wait_for_timeout(DRAWN)
        time = shown.get_by_role("slider", name="Time").first
        time.evaluate(
            "(slider, t) => { slider.value = String(t); slider.dispatchEvent(new Event('input', {bubbles: true})); }",
            SLIDING,
        )
        shown.evaluate("document.getElementById('motion').scrollIntoView()")
        shown.wait_for_timeout(DRAWN)
        shown.screenshot(path=picture)
        browser.close()


if __name__ == "__main__":
    take(Path(sys.argv[1]), Path(sys.argv[2]))
