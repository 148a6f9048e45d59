"""A child process runs any job that a plan names; however the job ends, the parent goes on and knows it."""

import ast
import os
import sys
from pathlib import Path

import pytest

from orchestration.sandbox import process
from orchestration.sandbox.process import work
from orchestration.sandbox.worker import TRACE_BYTES
from tests.unit.orchestration.sandbox import jobs

linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="asks Linux")
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


def test_records_cannot_be_forged(tmp_path: Path) -> None:
    """The job's library writes to all that it finds; what is not signed is counted, and signs of old are not taken."""
    ending = work(job("forge"), {}, tmp_path, timeout=60.0)
    assert ending.lines == [{"word": "true"}, {"word": "last"}]
    assert (ending.how, ending.foreign > 0) == ("", True)


@linux
def test_denied_calls_are_told_with_what_was_announced(tmp_path: Path) -> None:
    ending = work(job("reach"), {}, tmp_path, timeout=60.0)
    assert ending.lines == [{"denied": "fmi2DoStep"}, {"denied": "fmi2Reset"}] or "calls" not in ending.measures
    if "told" not in ending.measures:
        pytest.skip("this kernel does not tell of denied calls")
    assert ending.denied["socket"] == "fmi2DoStep"
    assert [ending.denied.get("fork"), ending.denied.get("clone")].count("fmi2Reset") == 1
    assert len(ending.denied) == 2


def test_files_that_are_left_are_named_and_removed(tmp_path: Path) -> None:
    ending = work(job("leave"), {}, tmp_path, timeout=60.0)
    assert "here.txt" in ending.files
    assert any(name.endswith(".kept") for name in ending.files)
    assert list(Path(ending.lines[0]["folder"]).iterdir()) == []


def test_a_job_has_a_time_in_all(tmp_path: Path) -> None:
    """It gives signs of life all the time."""
    ending = work(job("plod"), {}, tmp_path, timeout=60.0, total=2.0)
    assert (ending.how, ending.function, ending.out_of_time) == ("does not come to its end within 2 s", "plod", True)


@linux
def test_a_job_sees_nothing_of_its_parent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TOKEN", "secret")
    with (tmp_path / "open").open("w") as file:
        os.set_inheritable(file.fileno(), True)
        first, second = work(job("surroundings"), {}, tmp_path, timeout=60.0).lines
    assert "TOKEN" not in first["variables"]
    assert (first["umask"], first["read"]) == (0o077, "")
    assert not [name for name in second["descriptors"] if name.endswith("open")]


@linux
def test_a_job_fills_no_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "LOOKS", 0.1)
    assert work(job("flood"), {}, tmp_path, timeout=600.0).how == "writes more than 1 GiB to its files"


def test_sandbox_imports_errors_alone() -> None:
    folder = Path(process.__file__).parent
    for path in folder.glob("*.py"):
        nodes = [node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.ImportFrom)]
        ours = {node.module for node in nodes if node.module and node.module.startswith("orchestration")}
        assert all(name.startswith(("orchestration.errors", "orchestration.sandbox")) for name in ours), (path, ours)
