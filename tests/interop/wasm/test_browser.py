"""A page in Chromium runs Fig. 5 with the bits of the master; it comes from a server on this machine."""

import hashlib
import http.server
import json
import os
import shutil
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path
from queue import Queue

import numpy as np
import pytest

from orchestration import scenario, simulate
from tests.interop.wasm.node import PATIENCE, module_of
from tests.untested import needs

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason=needs("Chromium is not installed", "chromium"))
QUIET = (
    "--headless",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
)
PAGE = """<!doctype html><meta charset="utf-8"><title>Fig. 5</title>
<script type="module">
const answer = (said) => fetch("/answer", { method: "POST", body: said });
try {
  const { load } = await import("./system.mjs");
  const [bytes, description] = await Promise.all([
    fetch("system.wasm").then((file) => file.arrayBuffer()),
    fetch("system.json").then((file) => file.json()),
  ]);
  const system = await load(bytes, description);
  const run = system.create();
  run.initialize();
  const rows = run.run(STEPS, { columns: NAMES });
  const all = new Float64Array(Object.values(rows).flatMap((column) => [...column]));
  const hash = await crypto.subtle.digest("SHA-256", all);
  await answer([...new Uint8Array(hash)].map((byte) => byte.toString(16).padStart(2, "0")).join(""));
} catch (error) {
  await answer(String(error));
}
</script>
"""


class Pages(http.server.SimpleHTTPRequestHandler):
    """Serves a folder, and puts what a page sends back into a queue."""

    answers: Queue[str]

    def do_POST(self) -> None:
        """Take the answer of the page."""
        length = int(self.headers["Content-Length"])
        self.answers.put(self.rfile.read(length).decode())
        self.send_response(204)
        self.end_headers()

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


@pytest.fixture
def server(tmp_path: Path) -> Iterator[tuple[str, Queue[str]]]:
    """Address of a server for the test's folder, and what pages send to it."""

    class Here(Pages):
        answers: Queue[str] = Queue()

        def __init__(self, *arguments: object) -> None:
            super().__init__(*arguments, directory=str(tmp_path))  # type: ignore[arg-type]

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Here) as serving:
        thread = threading.Thread(target=serving.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{serving.server_port}", Here.answers
        finally:
            serving.shutdown()
            thread.join()


def test_a_page_has_the_bits_of_the_master(tmp_path: Path, server: tuple[str, "Queue[str]"]) -> None:
    assert CHROMIUM is not None
    address, answers = server
    system = scenario("fig5")
    result = simulate(system, 0.5)
    steps = len(result.time) - 1
    module_of(system, tmp_path)
    page = PAGE.replace("STEPS", str(steps)).replace("NAMES", json.dumps(result.names))
    (tmp_path / "page.html").write_text(page, encoding="utf-8")
    as_root = ["--no-sandbox"] if hasattr(os, "getuid") and os.getuid() == 0 else []
    profile = tmp_path / "profile"
    profile.mkdir()
    command = [CHROMIUM, *QUIET, *as_root, f"--user-data-dir={profile}", f"{address}/page.html"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as browser:
        try:
            said = answers.get(timeout=PATIENCE)
        finally:
            browser.terminate()
    ours = np.ascontiguousarray(np.column_stack([result.time, result.rows]).T)
    assert said == hashlib.sha256(ours.tobytes()).hexdigest()
