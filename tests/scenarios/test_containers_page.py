"""docs/containers.md, followed literally: each form of a system as one program does what the page says."""

import functools
import http.server
import os
import re
import shutil
import subprocess
import threading
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from orchestration import scenario, simulate
from tests.interop.wasm.test_browser import CHROMIUM, QUIET
from tests.scenarios.tutorial import Printed, blocks, follow
from tests.untested import needs

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "containers.md"
SHOWN = [block.line for block in blocks(PAGE) if block.kind == "text"]
TOOLS = {"cc": "gcc", "make": "make", "node": "nodejs"}
MISSING = [tool for tool in TOOLS if shutil.which(tool) is None]
pytestmark = pytest.mark.skipif(
    bool(MISSING), reason=needs(f"{', '.join(MISSING)}: not installed", *(TOOLS[tool] for tool in MISSING))
)
MOST = {"fig5.wasm": 150_000, "library": 400_000}
"""Bytes that a program of Fig. 5 may have: the module, and the library of each platform in the FMU."""


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[int, Printed]]:
    """The reader's folder when all is done, and what was printed, by line of the page."""
    folder = tmp_path_factory.mktemp("reader")
    return folder, {printed.line: printed for printed in follow(PAGE, folder)}


@pytest.mark.parametrize("line", SHOWN)
def test_commands_print_what_the_page_shows(followed: tuple[Path, dict[int, Printed]], line: int) -> None:
    printed = followed[1][line]
    assert printed.agree, f"{PAGE.name}, line {line}, shows\n{printed.shown}\nand the commands print\n{printed.real}"


def test_nothing_on_the_page_is_left_out() -> None:
    """Each fence is typed, compared or written to a named file."""
    text = PAGE.read_text(encoding="utf-8")
    found = blocks(PAGE)
    assert text.count("```") == 2 * len(found)
    assert {block.kind for block in found} == {"sh", "text", "python", "js", "html", "c"}
    files = [block.file for block in found if block.kind not in ("sh", "text")]
    assert all(files)
    assert len(set(files)) == len(files) == 6


def test_the_hash_is_that_of_all_other_programs(followed: tuple[Path, dict[int, Printed]]) -> None:
    table = (ROOT / "docs" / "same-bits.md").read_text(encoding="utf-8")
    (known,) = re.findall(r"^\| fig5 \|.*`([0-9a-f]{64})` \|$", table, re.MULTILINE)
    assert known in [printed.real.strip() for printed in followed[1].values()]


def test_programs_are_small(followed: tuple[Path, dict[int, Printed]]) -> None:
    folder, _ = followed
    assert (folder / "fig5.wasm").stat().st_size < MOST["fig5.wasm"]
    with zipfile.ZipFile(folder / "fig5.fmu") as archive:
        libraries = [entry for entry in archive.infolist() if entry.filename.startswith("binaries/")]
    assert libraries
    assert all(entry.file_size < MOST["library"] for entry in libraries)


def test_a_controller_fits_a_small_processor(followed: tuple[Path, dict[int, Printed]]) -> None:
    (sizes,) = [printed.real for printed in followed[1].values() if "bytes in brain_System" in printed.real]
    state, stack = (int(n) for n in re.findall(r"(\d+) bytes in", sizes) + re.findall(r"(\d+) bytes of stack", sizes))
    assert 0 < state < 1500
    assert 0 < stack < 4000


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves files and says nothing."""

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


@pytest.fixture
def address(followed: tuple[Path, dict[int, Printed]]) -> Iterator[str]:
    """Address of a server for the reader's folder."""
    serve = functools.partial(Quiet, directory=str(followed[0]))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), serve) as serving:
        thread = threading.Thread(target=serving.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{serving.server_port}"
        finally:
            serving.shutdown()
            thread.join()


@pytest.mark.skipif(CHROMIUM is None, reason=needs("Chromium is not installed", "chromium"))
def test_the_page_in_a_browser_shows_the_bits_of_the_master(address: str, tmp_path: Path) -> None:
    """A browser writes a number with as many digits as tell it from all others, as Python does."""
    as_root = ["--no-sandbox"] if hasattr(os, "getuid") and os.getuid() == 0 else []
    # The page has this time, ms, which passes faster than a clock's while the page waits for nothing.
    options = [*QUIET, *as_root, f"--user-data-dir={tmp_path}", "--virtual-time-budget=600000", "--dump-dom"]
    assert CHROMIUM is not None
    browser = subprocess.run(
        [CHROMIUM, *options, f"{address}/page.html"], capture_output=True, check=True, encoding="utf-8", timeout=600
    )
    expected = simulate(scenario("fig5"), 0.1, record=["plant.x[1]"])["plant.x[1]"][-1]
    assert f"<output>{expected.item()!r} m at 0.1 s</output>" in browser.stdout
