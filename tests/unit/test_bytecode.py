"""Processes that tests start find and keep bytecode in the folder of the run."""

import os
import subprocess
import sys
from pathlib import Path

from tests.bytecode import PREFIX, SWITCHED_OFF


def test_a_process_keeps_bytecode_for_the_next_one(tmp_path: Path) -> None:
    assert SWITCHED_OFF not in os.environ
    (tmp_path / "imported_by_a_test.py").write_text("x = 1\n", encoding="utf-8")
    subprocess.run([sys.executable, "-c", "import imported_by_a_test"], cwd=tmp_path, check=True)
    kept = Path(os.environ[PREFIX]) / tmp_path.relative_to(tmp_path.anchor)
    assert [path.name.partition(".")[0] for path in kept.iterdir()] == ["imported_by_a_test"]
    assert not (tmp_path / "__pycache__").exists()
