"""Evidence for ``adaptimp doctor``: its exit codes, its JSON, and that it can be read on narrow and wide terminals."""

import json
import re
import shlex
from pathlib import Path

import pytest

from tests.faults.cli import Command

PAGE = Path(__file__).parents[2] / "docs" / "doctor.md"
LATE = ("fig2", "--algorithm", "jacobi", "--sample-time", "7e-3", "--stop", "1.4")


def keys(heading: str) -> list[str]:
    """Keys in the table below a heading of the page, in their order."""
    part = PAGE.read_text(encoding="utf-8").partition(f"## {heading}\n")[2].partition("\n## ")[0]
    return re.findall(r"^\| `([\w-]+)` \|", part, re.MULTILINE)


def test_the_object_has_the_documented_keys(adaptimp: Command) -> None:
    outcome = adaptimp("doctor", *LATE, "--json")
    found = json.loads(outcome.out)
    assert list(found) == keys("Numbers for programs")
    assert (outcome.code, found["exit_code"], found["worst"]) == (1, 1, "error")
    assert (found["system"], found["algorithm"], found["step"], found["stop_time"]) == ("fig2", "jacobi", 7e-3, 1.4)
    assert found["errors"] == sum(f["severity"] == "error" for f in found["findings"])
    assert {f["id"] for f in found["findings"]} <= set(keys("Findings"))


def test_a_healthy_system_ends_with_0(adaptimp: Command) -> None:
    outcome = adaptimp("doctor", "fig2", "--stop", "0.1")
    assert outcome.code == 0
    assert "0 errors, 0 warnings" in outcome.out
    assert outcome.err == ""


@pytest.mark.parametrize("columns", [60, 120])
def test_it_can_be_read_at_any_width(adaptimp: Command, columns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    outcome = adaptimp("doctor", *LATE)
    lines = [line for line in outcome.out.splitlines() if not line.startswith("    $ ")]
    assert max(map(len, lines)) <= columns
    assert "ERROR stability: plant.dq[2]" in lines
    assert "adaptimp run" in outcome.out  # a command stays in one line, to be pasted


def test_the_command_that_it_gives_runs(adaptimp: Command) -> None:
    outcome = adaptimp("doctor", *LATE, "--set", "controller.K=[4000,2000]", "--json")
    finding = json.loads(outcome.out)["findings"][0]
    words = shlex.split(finding["command"])
    assert words[:3] == ["adaptimp", "run", "fig2"]
    assert "controller.K=[4000,2000]" in words
    assert adaptimp(*words[1:], "-q").code == 0


def test_what_cannot_be_examined_is_an_object_too(adaptimp: Command) -> None:
    outcome = adaptimp("doctor", "fig2", "--set", "plant.K_f=-1", "--json")
    found = json.loads(outcome.out)
    assert (outcome.code, found["exit_code"]) == (2, 2)
    assert "K_f = -1 must be at least 0 N/m" in found["error"]
    assert adaptimp("doctor", "fig99").code == 2
    both = adaptimp("doctor", "fig2", "--step", "1e-4", "--sample-time", "1e-4")
    assert (both.code, both.sentence.startswith("--step and --sample-time exclude each other")) == (2, True)
