"""Evidence that a user who swaps a controller gets its numbers, a picture of both runs, and what differs."""

import json
from pathlib import Path

import pytest

from orchestration import Result
from tests.faults.cli import Command, runner


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command line in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return runner(monkeypatch, capsys)


def test_swap_look_and_compare(adaptimp: Command, tmp_path: Path) -> None:
    first = adaptimp("run", "fig5", "--every", 10, "-o", "craig.parquet", "--plot", "craig.png")
    assert first.code == 0
    assert (tmp_path / "craig.png").stat().st_size > 20_000  # bytes; an empty page has 5,000
    for line in (
        "contact: from 0.9067 s to ",
        "tracking error in free motion: at most ",
        "estimate of m2 at the end: ",
    ):
        assert line in first.out

    swapped = ("--controller", "SlotineLiAdaptiveImpedance", "--every", 10)
    second = adaptimp("run", "fig5", *swapped, "-o", "slotine.parquet", "--json")
    numbers = json.loads(second.out)["numbers"]
    result = Result.read("slotine.parquet")
    assert numbers["peak_force"] == {"value": result.measure("max(norm(plant.F_ext))"), "unit": "N"}
    assert numbers["share_saturated"]["value"] == 0.0

    drawn = adaptimp("plot", "craig.parquet", "slotine.parquet", "-o", "both.svg")
    assert (drawn.code, drawn.err, drawn.out) == (0, "", "wrote both.svg\n")
    text = (tmp_path / "both.svg").read_text(encoding="utf-8")
    for label in ("craig", "slotine", "in contact", "error (mm)", "force (N)"):
        assert f">{label}</text>" in text

    compared = adaptimp("compare", "craig.parquet", "slotine.parquet")
    assert compared.code == 1
    verdict = compared.out.splitlines()[-1]
    assert verdict.startswith("The results differ: ")
    assert "only the first has controller.e_star[1]" in verdict
    assert adaptimp("compare", "craig.parquet", "craig.parquet").code == 0
