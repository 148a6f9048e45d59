"""docs/cluster.md: the commands of the page start a cluster, and its sweep has the table of a sweep without one.

The Python block of the page is run by `tests.scenarios.test_documents`.
"""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pandas as pd

from tests.unit.orchestration.campaigns.cluster.machines import READY, REGISTERED, machines

PAGE = Path(__file__).parents[2] / "docs" / "cluster.md"
HOST = "tcp://10.0.0.5:8786"
"""Address on the page; the test takes a free port of this machine."""


def commands() -> dict[str, list[str]]:
    """Arguments of the commands of the page, by the words that they begin with."""
    lines = re.findall(r"^    (dask \w+|adaptimp sweep) (.*)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    return {command: shlex.split(arguments) for command, arguments in lines}


def sweep(arguments: list[str], out: Path) -> pd.DataFrame:
    """Run `adaptimp sweep`, and read its table."""
    program = [sys.executable, "-c", "from orchestration.cli import main; main()"]
    subprocess.run([*program, "sweep", *arguments, "-o", str(out)], check=True, cwd=out.parent, capture_output=True)
    return pd.read_csv(out)


def test_the_commands_of_the_page_make_the_runs(tmp_path: Path) -> None:
    given = commands()
    assert set(given) == {"dask scheduler", "dask worker", "adaptimp sweep"}
    assert given["dask scheduler"] == ["--port", HOST.rpartition(":")[2]]
    with machines(tmp_path, workers=None) as cluster:
        address = cluster.started(READY, "scheduler", "--port", "0", "--host", "127.0.0.1", "--dashboard-address", ":0")
        here = [argument.replace(HOST, address[1]) for argument in given["dask worker"]]
        cluster.started(REGISTERED, "worker", *here)
        there = [argument.replace(HOST, address[1]) for argument in given["adaptimp sweep"]]
        made = sweep(there, tmp_path / "cluster.csv")
    without = given["adaptimp sweep"][: given["adaptimp sweep"].index("--cluster")]
    assert len(made) == 9
    pd.testing.assert_frame_equal(made, sweep(without, tmp_path / "alone.csv"), check_exact=True)
