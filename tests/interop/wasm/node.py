"""Runs scripts in node that work with a module of WebAssembly."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestration import Result, System, scenario
from orchestration.containers.wasm.module import write_wasm
from tests.untested import needs

NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason=needs("node is not installed", "nodejs"))
PATIENCE = 600
"""Time after which a script has failed, s: many times that of the longest one on a busy machine."""
HEAD = """
import { readFileSync, writeFileSync } from "node:fs";
import { load, formatted, SystemError } from "./system.mjs";
const description = JSON.parse(readFileSync("system.json", "utf8"));
const bytes = readFileSync("system.wasm");
const system = await load(bytes, description);
const outputs = description.variables.filter((v) => v.role === "output").map((v) => v.name);
const refusal = (call) => {
  try {
    call();
  } catch (error) {
    if (error instanceof SystemError) return error.message;
    throw error;
  }
  return "no error";
};
"""
KEEP = """
const keep = (file, rows) =>
  writeFileSync(file, Buffer.concat(Object.values(rows).map((c) => Buffer.from(c.buffer, c.byteOffset, c.byteLength))));
"""


def module_of(name: str | System, folder: Path, algorithm: str = "gauss-seidel") -> Path:
    """A folder with the module of a scenario or of a system, its description and its host."""
    system = scenario(name) if isinstance(name, str) else name
    write_wasm(system, folder / "system.wasm", algorithm=algorithm)
    return folder


def node(folder: Path, script: str) -> Any:
    """What a script prints, from JSON. It finds `system`, a loaded module, its `description`, and `refusal`.

    `keep(file, rows)` writes rows as float64, column by column; see `kept`.
    """
    return script_output(folder, HEAD + KEEP + script)


def script_output(folder: Path, script: str) -> Any:
    """What a script prints, from JSON; None if it prints nothing."""
    (folder / "script.mjs").write_text(script, encoding="utf-8")
    assert NODE is not None
    run = subprocess.run(
        [NODE, "script.mjs"], cwd=folder, capture_output=True, timeout=PATIENCE, check=False, encoding="utf-8"
    )
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout) if run.stdout else None


def kept(path: Path, n_columns: int) -> np.ndarray:
    """Rows that a script kept, shape (n_rows, n_columns); the first column is the time, s."""
    return np.fromfile(path).reshape(n_columns, -1).T


def assert_bitwise(rows: np.ndarray, result: Result) -> None:
    """Every bit of the time and of every column; the first difference is named."""
    ours = np.column_stack([result.time, result.rows])
    names = ("time", *result.names)
    assert rows.shape == ours.shape
    differs = np.ascontiguousarray(rows).view(np.int64) != np.ascontiguousarray(ours).view(np.int64)
    if differs.any():
        k, j = np.argwhere(differs)[0]
        pytest.fail(f"{differs.sum()} values differ, first row {k}, {names[j]}: {rows[k, j]!r}, ours {ours[k, j]!r}")
