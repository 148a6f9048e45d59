"""A child process runs any job that a plan names; however the job ends, the parent goes on and knows it."""

import ast
import sys
from pathlib import Path

import pytest

from orchestration.sandbox import process
from orchestration.sandbox.process import work
from orchestration.sandbox.worker import TRACE_BYTES
from tests.unit.orchestration.sandbox import jobs

GIGABYTE = 1024**3


def job(name: str) -> str:
    return f"{jobs.__name__}:{name}"


def test_job_gets_its_plan_and_its_lines_come_back(tmp_path: Path) -> None:
    ending = work(job("echo"), {"words": ["one", "two"]}, tmp_path, timeout=60.0)
    assert ending.lines == [{"word": "one"}, {"word": "two"}]
    assert (ending.how, ending.function) == ("", "")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows knows no SIGKILL")
def test_death_is_told_with_the_call_and_the_lines_before_it(tmp_path: Path) -> None:
    ending = work(job("die"), {}, tmp_path, timeout=60.0)
    assert [line["word"] for line in ending.lines] == ["last"]
    assert (ending.how, ending.function) == ("dies of SIGKILL", "x" * TRACE_BYTES)


def test_silence_ends_the_job(tmp_path: Path) -> None:
    ending = work(job("hang"), {}, tmp_path, timeout=1.0)
    assert ending.how == "does not return within 1 s"


def test_the_start_of_the_interpreter_is_no_silence(tmp_path: Path) -> None:
    """None starts within the time that this job gets, and more than that is not needed for its two words."""
    ending = work(job("echo"), {"words": ["one", "two"]}, tmp_path, timeout=0.02)
    assert (len(ending.lines), ending.how) == (2, "")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limit of addresses")
@pytest.mark.parametrize(("memory", "line"), [(GIGABYTE, {"refused": True}), (None, {"size": GIGABYTE})])
def test_memory_is_limited_where_the_plan_says_so(tmp_path: Path, memory: int | None, line: dict[str, int]) -> None:
    ending = work(job("swallow"), {"bytes": GIGABYTE}, tmp_path, timeout=60.0, memory=memory)
    assert line in ending.lines


def test_sandbox_imports_errors_alone() -> None:
    folder = Path(process.__file__).parent
    for path in folder.glob("*.py"):
        nodes = [node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.ImportFrom)]
        ours = {node.module for node in nodes if node.module and node.module.startswith("orchestration")}
        assert all(name.startswith(("orchestration.errors", "orchestration.sandbox")) for name in ours), (path, ours)
