"""docs/interop.md says what is measured: a slice of it is measured again, the rest is complete and current.

The slice is three FMUs, one with Reals only, and the first 200 steps of fig2, in every tool of the development
environment; the others need environments of their own, which these tests do not make. What they compare is bitwise
or a message, so there is no tolerance but that of `tests.interop.matrix.compare`.
"""

import re
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fmus.catalog import MODELS
from tests.interop.matrix import compare, runner
from tests.interop.matrix.compare import BITWISE, CLOSE, DIFFERS, FAILS, PASSES, ROUNDED, STEPS_AGREE, Verdict, judge
from tests.interop.matrix.jobs import CONTAINER, FIGURES, REALS, SYSTEMS, UNITS, fmu_job, our_rows
from tests.interop.matrix.outcomes import Outcomes, measure
from tests.interop.matrix.protocol import FMU, SYSTEM, Job, Record
from tests.interop.matrix.render import cell, render
from tests.interop.matrix.runner import Answer, ask
from tests.interop.matrix.tools import KEYS, module
from tests.interop.peers import unavailable

DOCUMENT = Path(__file__).parents[2] / "docs" / "interop.md"
SLICE = ("Actuator", f"Actuator{REALS}", "Plant", "fig2")
STEPS = 200
INSTALLED = [key for key in KEYS if not module(key).TOOL.requirements]
NEEDS = {"ecospy": "ecospy", "ecos_cli": "ecospy", "libcosim": "libcosimpy"}


@pytest.fixture(scope="module")
def fmus(fmu_folder: Path, reals_folder: Path) -> dict[str, Path]:
    """All FMUs' files."""
    endings = {"": fmu_folder, REALS: reals_folder}
    return {f"{name}{ending}": folder / f"{name}.fmu" for name in MODELS for ending, folder in endings.items()}


@pytest.fixture(scope="module")
def kept() -> Outcomes:
    """What the document was made of."""
    return Outcomes.read()


@pytest.mark.parametrize("key", INSTALLED)
def test_entries_are_what_is_measured(key: str, fmus: dict[str, Path], kept: Outcomes, tmp_path: Path) -> None:
    if reason := unavailable(NEEDS[key]) if key in NEEDS else None:
        pytest.skip(reason)
    measured = measure([key], SLICE, fmus, tmp_path, n_steps=STEPS)
    assert measured.verdicts[key]
    package = module(key).TOOL.distribution
    same_version = measured.versions[package] == kept.versions[package]
    for job, verdict in measured.verdicts[key].items():
        entry = kept.verdicts[key][job]
        what = (
            f"{job} in {package} {measured.versions[package]}: {verdict}; kept is {entry} of {kept.versions[package]}"
        )
        assert entry.kind == verdict.kind, what
        if same_version and verdict.kind == FAILS:  # other details depend on how far a run goes
            assert entry.detail == verdict.detail, what


def test_the_document_is_that_of_the_outcomes(kept: Outcomes) -> None:
    assert DOCUMENT.read_text(encoding="utf-8") == render(kept)


def test_every_unit_and_figure_was_run_in_every_tool(kept: Outcomes) -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    for key in KEYS:
        tool = module(key).TOOL
        expected = [*UNITS] * (FMU in tool.kinds) + [*SYSTEMS] * (SYSTEM in tool.kinds)
        assert list(kept.verdicts[key]) == expected, key
        assert f"| {tool.distribution} {kept.versions[tool.distribution]} |" in text
    for name in (*UNITS, *SYSTEMS):
        assert re.search(rf"^\| `{name}` \|", text, re.MULTILINE), name
    assert "not run" not in text


def test_whole_figures_agree(kept: Outcomes) -> None:
    """Bitwise; and the whole of each: 2 s."""
    for key in ("ecospy", "libcosim", "sofirpy"):
        for figure, steps in zip(FIGURES, [20_000] * 3 + [100_000] * 3, strict=True):
            assert (kept.verdicts[key][figure].kind, kept.verdicts[key][figure].steps) == (BITWISE, steps)


@pytest.mark.parametrize("key", ["cofmupy", "pathsim"])
def test_tools_that_know_reals_only_run_all_figures_and_the_container(kept: Outcomes, key: str) -> None:
    """With the FMUs of ``adaptimp build --reals``, in full length; with the others they run none."""
    for figure, steps in zip(FIGURES, [20_000] * 3 + [100_000] * 3, strict=True):
        verdict = kept.verdicts[key][f"{figure}{REALS}"]
        assert (verdict.kind, verdict.steps) == (BITWISE, steps)
        assert kept.verdicts[key][figure].kind == FAILS
    assert kept.verdicts[key][f"{CONTAINER}{REALS}"].kind == BITWISE


@pytest.mark.parametrize("key", KEYS)
def test_reals_are_worse_in_no_tool(kept: Outcomes, key: str) -> None:
    best = (PASSES, BITWISE, ROUNDED, CLOSE, STEPS_AGREE, DIFFERS, FAILS)
    for name in (name for name in kept.verdicts[key] if name.endswith(REALS)):
        usual = kept.verdicts[key][name.removesuffix(REALS)]
        assert best.index(kept.verdicts[key][name].kind) <= best.index(usual.kind), name


@pytest.fixture
def job() -> Job:
    """Two columns and three rows."""
    return Job("pair", SYSTEM, 0.1, 2, "", (), (), ("a.x", "a.y"))


OURS = np.array([[1.0, 0.0], [2.0, 0.0], [-4.0, 0.0]])
BEFORE = "; that is before the first step"
CHANGES: Mapping[str, tuple[tuple[int, int], float, float, Verdict]] = {
    "same": ((0, 0), 1.0, 0.0, Verdict(BITWISE, steps=2)),
    "sign of zero": ((1, 1), -0.0, 0.0, Verdict(CLOSE, steps=2)),
    "last bits": ((1, 0), 2 + 3.9e-10, 0.0, Verdict(CLOSE, 1e-10, steps=2)),
    "more": ((1, 0), 2 + 4.1e-9, 0.0, Verdict(DIFFERS, 2e-9, "a.x at step 1 is 2, ours 2", 2)),
    "zero column": ((2, 1), 1e-30, 0.0, Verdict(DIFFERS, np.inf, "a.y at step 2 is 1e-30, ours 0", 2)),
    "not a number": ((2, 0), np.nan, 0.0, Verdict(DIFFERS, np.inf, "a.x at step 2 is nan, ours -4", 2)),
    "digits": ((1, 0), 2 + 4e-7, 5e-7, Verdict(ROUNDED, 1e-7, steps=2)),
    "not all digits": ((1, 0), 2 + 6e-7, 5e-7, Verdict(DIFFERS, 2e-7, "a.x at step 1 is 2, ours 2", 2)),
    "first row": ((0, 0), 2.0, 0.0, Verdict(STEPS_AGREE, 0.0, f"a.x at step 0 is 2, ours 1{BEFORE}", 2)),
}


@pytest.mark.parametrize("change", CHANGES)
def test_verdicts(job: Job, change: str) -> None:
    place, value, resolution, verdict = CHANGES[change]
    values = OURS.copy()
    values[place] = value
    record = Record(values, job.columns, resolution=resolution)
    assert judge(job, Answer(record), OURS) == verdict


def test_verdicts_on_what_is_missing(job: Job) -> None:
    assert judge(job, Answer(None, "it is ill"), OURS) == Verdict(FAILS, detail="it is ill")
    assert judge(job, Answer(Record(np.empty((0, 0)), ())), OURS) == Verdict(PASSES)
    later = judge(job, Answer(Record(OURS[1:], job.columns, first=1)), OURS)
    assert later == Verdict(BITWISE, steps=2)
    short = judge(job, Answer(Record(OURS[1:], job.columns)), OURS)
    assert short == Verdict(DIFFERS, np.inf, "2 rows where 3 are expected", 2)
    narrow = judge(job, Answer(Record(OURS[:, 1:], ("a.y",))), OURS)
    assert narrow == Verdict(BITWISE, detail="only 1 of 2 outputs can be seen", steps=2)


def test_distances_show_one_digit() -> None:
    assert [compare.rounded_up(x) for x in (0.0, 1e-9, 1.01e-9, 9.5e-4, 3.0)] == [0.0, 1e-9, 2e-9, 1e-3, 3.0]
    assert cell(Verdict(CLOSE, 2e-13)) == "to 2e-13"
    assert cell(Verdict(CLOSE)) == "equal"  # but for the sign of a zero
    assert cell(Verdict(STEPS_AGREE)) == "bitwise from step 1"
    assert cell(None) == "not run"


def test_a_crash_and_a_hang_are_entries(fmus: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    identifier = fmu_job("VirtualTrajectory", fmus, tmp_path)
    tool = module("fmpy_simulate").TOOL
    for call, failure in {
        "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)": "the process ends with SIGSEGV",
        HANG: "no result after 1 s",
        "import sys; sys.exit('/somewhere/a b/ VirtualTrajectory.so is bad')": "b/ X.so is bad",
        "": "exit code 0",
    }.items():
        monkeypatch.setattr(runner, "_python", lambda _, call=call: [*PYTHON, call])
        answer = ask(tool, identifier, timeout=1.0 if call == HANG else 600.0)
        assert answer.failure.endswith(failure)


PYTHON = (sys.executable, "-c")
HANG = "import time; time.sleep(3600)"


def test_a_wrong_input_is_noticed(fmus: dict[str, Path], tmp_path: Path) -> None:
    """Else an entry could be bitwise with inputs that do nothing."""
    tool = module("fmpy_simulate").TOOL
    right = fmu_job("Actuator", fmus, tmp_path)
    wrong = replace(right, stimulus={name: values[::-1] for name, values in right.stimulus.items()})
    assert judge(right, ask(tool, wrong), our_rows(right, tool, fmus)).kind == DIFFERS
