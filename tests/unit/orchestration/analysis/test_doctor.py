"""Evidence for the parts of an examination, on signals and systems whose answers are known."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import (
    Algorithm,
    Connection,
    Correction,
    Diagnosis,
    Finding,
    System,
    SystemDescriptionError,
    diagnose,
)
from orchestration.analysis.doctor.bonds import power_bonds
from orchestration.analysis.doctor.case import Case, in_python
from orchestration.analysis.doctor.finding import Severity
from orchestration.analysis.doctor.sampling import fitting_step
from orchestration.analysis.doctor.stability import contradicted
from orchestration.analysis.doctor.study import Kind, Study, signal_error, study
from orchestration.analysis.doctor.wiring import algebraic_loops, delays
from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import ALGORITHMS, NEWTON, PARALLEL
from tests.reference.problems import PROBLEMS, wall
from tests.unit.orchestration.small_models import H, chain, mixed, system

T = np.linspace(0, 1, 1001)


def values(error: np.ndarray, power: float) -> list[np.ndarray]:
    """A sine with an error that falls with a power of the step, at h, h/2 and h/4."""
    return [np.sin(6 * T) + error * 0.5 ** (power * i) for i in range(3)]


@pytest.mark.parametrize("power", [1.0, 2.0, 4.0])
def test_the_order_and_the_size_of_an_error_are_found(power: float) -> None:
    error = 1e-2 * T
    found = signal_error("a.x", "m", values(error, power))
    assert found.kind is Kind.ORDER
    assert found.order == pytest.approx(power, abs=1e-9)
    assert found.largest == pytest.approx(1e-2, rel=1e-9)
    assert found.error == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-9)
    assert found.relative == pytest.approx(found.error / np.ptp(values(error, power)[2]))


def test_noise_has_no_order() -> None:
    random = np.random.default_rng(1)
    found = signal_error("a.x", "m", [np.sin(6 * T) + 0.1 * random.standard_normal(T.size) for _ in range(3)])
    assert (found.kind, found.order) == (Kind.NONE, None)


def test_a_jump_that_moves_with_the_step_is_told_from_an_error() -> None:
    # A jump at 0.5 + h: the differences are 1 over h/2 and h/4, so their mean square falls with the root of h.
    found = signal_error("a.x", "m", [(T > 0.5 + 0.08 * 0.5**i).astype(float) for i in range(3)])
    assert (found.kind, found.order) == (Kind.JUMPS, None)
    assert found.largest == 1.0
    assert found.error == pytest.approx(np.sqrt(0.04), rel=0.03)


@pytest.mark.parametrize("level", [0.0, 3.0])
def test_a_signal_that_no_step_changes_is_exact(level: float) -> None:
    found = signal_error("a.x", "m", [np.full(10, level)] * 3)
    assert (found.kind, found.relative) == (Kind.EXACT, 0.0)


def test_the_squares_of_a_signal_that_diverges_do_not_overflow() -> None:
    found = signal_error("a.x", "m", [np.array([0.0, 1e200]), np.array([0.0, 1.0]), np.array([0.0, 2.0])])
    assert np.isfinite(found.error)
    assert found.relative > 1e199


def test_the_study_agrees_with_the_exact_solution() -> None:
    problem = PROBLEMS["quarter car"]
    made = study(Case(problem.system(1e-3, 1.0), 1e-3, 1.0, ALGORITHMS["gauss-seidel"]), 600.0)
    assert made.steps == (1e-3, 5e-4, 2.5e-4)
    assert made.result is not None
    exact = problem.exact(made.result.time)
    by_kind = {kind: [s for s in made.signals if s.kind is kind] for kind in Kind}
    assert [signal.name for signal in by_kind[Kind.EXACT]] == ["wheel.r"]  # the road
    assert len(by_kind[Kind.ORDER]) == 5
    for signal in by_kind[Kind.ORDER]:
        assert signal.order == pytest.approx(1.0, abs=0.1)
        # The next term of the error is of order h: some per cent here.
        assert signal.largest == pytest.approx(np.abs(made.result[signal.name] - exact[signal.name]).max(), rel=0.1)


def test_a_study_keeps_to_its_budget() -> None:
    case = Case(wall.system(1e-6, 100.0, m=1.0, k=100.0), 1e-6, 100.0, ALGORITHMS["gauss-seidel"])  # 1e8 steps
    made = study(case, 0.2)
    assert 0 < made.until < 100.0
    diagnosis = diagnose(case.system, budget=0.2)
    finding = diagnosis.of("study")
    assert finding is not None
    assert finding.severity is Severity.NOTE


def test_a_growth_is_contradicted_by_runs_that_stay_together() -> None:
    together = (signal_error("a.x", "m", values(1e-2 * T, 1.0)),)
    apart = (replace(together[0], kind=Kind.NONE),)
    calm = Study((1e-3,), 1.0, together, None, spread=10.0)
    assert contradicted(1e20, calm)
    assert not contradicted(100.0, calm)  # errors that add up spread as much
    assert not contradicted(1e20, replace(calm, spread=1e15))
    assert not contradicted(1e20, replace(calm, signals=apart))
    assert not contradicted(1e20, replace(calm, failure="it diverges"))


def test_loops_follow_what_is_declared(small: dict[str, Path]) -> None:
    # y = x + through u declares u, x does not.
    units = {"a": "Integrator", "b": "Integrator", "c": "Integrator"}
    loop = system(small, units, "a.y -> b.u\nb.y -> a.u\na.x -> c.u")
    assert [[str(c) for c in group] for group in algebraic_loops(loop)] == [["a.y -> b.u", "b.y -> a.u"]]
    assert algebraic_loops(system(small, units, "a.y -> b.u\nb.x -> a.u")) == []
    one = system(small, {"a": "Integrator"}, "a.y -> a.u")
    assert len(algebraic_loops(one)) == 1
    assert algebraic_loops(mixed(small)) == []  # the relay is sampled


def test_two_loops_are_two() -> None:
    # Found by hand: {0, 1, 2} and {3}, which follows itself.
    from orchestration.analysis.doctor.wiring import _strong_groups

    groups = _strong_groups([[1], [2], [0, 3], [3, 4], []])
    assert sorted(map(sorted, groups)) == [[0, 1, 2], [3], [4]]


def test_ten_thousand_connections_in_a_row_are_no_recursion() -> None:
    from orchestration.analysis.doctor.wiring import _strong_groups

    n = 10_000
    assert len(_strong_groups([[i + 1] for i in range(n)] + [[]])) == n + 1
    assert len(_strong_groups([[(i + 1) % n] for i in range(n)])) == 1


def test_delays_are_those_of_the_order(small: dict[str, Path]) -> None:
    forward = chain(small, 3)
    case = Case(forward, H, 16 * H, ALGORITHMS["gauss-seidel"])
    assert delays(case).late == ()
    assert len(delays(case, ["relay3", "relay2", "relay1", "source"]).late) == len(forward.connections)
    assert len(delays(case.but(algorithm=ALGORITHMS["jacobi"])).late) == len(forward.connections)
    # A tick at t reads what a continuous component shows at t only if that component steps later.
    feedback = Case(mixed(small), H, 16 * H, ALGORITHMS["gauss-seidel"])
    assert delays(feedback).early == ()
    assert [str(c) for c in delays(feedback, ["plant", "source", "relay", "switch"]).early] == ["plant.x -> relay.u"]


def test_the_better_order_is_given_with_its_call(small: dict[str, Path]) -> None:
    backward = chain(small, 2).ordered(["relay2", "relay1", "source"])
    finding = diagnose(backward, 4 * H).of("delays")
    assert finding is not None
    assert finding.severity is Severity.WARNING
    assert finding.command == f"simulate(system, stop_time={4 * H}, step={H}, order=['source', 'relay1', 'relay2'])"


@pytest.mark.parametrize(
    ("periods", "step", "stop_time", "expected"),
    [
        ((1e-3,), 3e-4, 1.0, 2.5e-4),
        ((5e-3,), 2e-3, 0.5, 1e-3),  # 5/3 ms divides, too, but is not round
        ((1e-3, 7e-4), 1e-3, 0.7, 1e-4),
        ((1e-3, 1e-3 + 1e-9), 1e-3, 1.0, None),
        ((1e-3,), 5e-3, 1.0, 1e-3),
    ],
)
def test_the_step_that_fits(
    small: dict[str, Path], periods: tuple[float, ...], step: float, stop_time: float, expected: float | None
) -> None:
    sampled = System.of({f"source{i}": small["Source"] for i in range(len(periods))})
    sampled = sampled.set({f"source{i}.sample_time": period for i, period in enumerate(periods)})
    found = fitting_step(sampled, step, stop_time)
    assert found == (None if expected is None else pytest.approx(expected, rel=1e-12))


def test_periods_that_do_not_divide_each_other_are_said(small: dict[str, Path]) -> None:
    sampled = System.of({"a": small["Source"], "b": small["Source"]})
    sampled = sampled.set({"a.sample_time": 0.5, "b.sample_time": 0.75})
    finding = diagnose(sampled, 3.0, 0.25).of("sampling-beat")
    assert finding is not None
    assert finding.figures["beat"] == pytest.approx(1.5)


def test_bonds_are_found_by_units() -> None:
    bonds = {name: [str(bond) for bond in power_bonds(p.system(1e-2, 1.0))] for name, p in PROBLEMS.items()}
    assert bonds["quarter car"] == ["body.F * wheel.v"]
    assert bonds["wall"] == ["wall.F * mass.v"]
    assert bonds["displacement-displacement"] == []  # only positions and velocities
    changed = wall.system(1e-2, 1.0)
    scaled = tuple(
        replace(c, factor=-1.0) if c.output == "F" else Connection(c.source, c.output, c.target, c.input)
        for c in changed.connections
    )
    assert power_bonds(replace(changed, connections=scaled)) == []  # both ends see different powers


def test_what_other_tools_lose_is_said(small: dict[str, Path]) -> None:
    diagnosis = diagnose(mixed(small).set({"switch.n": 3}), 4 * H)
    discrete = diagnosis.of("discrete-connections")
    assert discrete is not None
    assert "relay.odd -> switch.flag" in discrete.figures["connections"]
    starts = diagnosis.of("input-starts")
    assert starts is not None
    assert starts.figures["inputs"] == ["switch.n"]
    free = diagnose(system(small, {"a": "Integrator"}), 4 * H).of("unconnected-inputs")
    assert free is not None
    assert (free.severity, free.subject) == (Severity.WARNING, "a.u")


def test_calls_in_python_make_the_same_case() -> None:
    made = wall.system(1e-2, 1.0)
    case = Case(made, 1e-2, 1.0, Algorithm("newton", PARALLEL, 1, Correction(NEWTON)))
    names = {"Algorithm": Algorithm, "Correction": Correction, "system": made}
    caught: dict[str, object] = {}
    eval(in_python(case), {**names, "simulate": lambda *_, **given: caught.update(given)})
    assert caught == {"stop_time": 1.0, "step": 1e-2, "algorithm": case.algorithm}
    plain = in_python(case.but(algorithm=ALGORITHMS["jacobi"], order=("mass", "wall")))
    assert plain == "simulate(system, stop_time=1, step=0.01, algorithm='jacobi', order=['mass', 'wall'])"


@pytest.mark.parametrize(
    ("isolate", "said"),
    [(True, "isolate=True"), ("wall", "isolate=Isolation(components=('wall',))")],
)
def test_the_call_says_what_is_isolated(isolate: bool | str, said: str) -> None:
    case = Case(wall.system(1e-2, 1.0), 1e-2, 1.0, ALGORITHMS["jacobi"], isolation=Isolation.of(isolate))
    assert in_python(case) == f"simulate(system, stop_time=1, step=0.01, algorithm='jacobi', {said})"


def test_a_diagnosis_shows_itself() -> None:
    worst = Finding("stability", Severity.ERROR, "a.x", "It <grows>.", {"growth": np.inf}, "Do this.", "simulate(s)")
    diagnosis = Diagnosis("s", "jacobi", 1e-3, 1.0, (worst, replace(worst, severity=Severity.NOTE)))
    assert repr(diagnosis) == "<Diagnosis of s, jacobi with a step of 0.001 s: 1 error, 0 warnings, 1 note>"
    assert not diagnosis.healthy
    assert "error: stability, a.x: It <grows>." in str(diagnosis)
    assert "It &lt;grows&gt;." in diagnosis._repr_html_()
    assert json.loads(diagnosis.json())["findings"][0]["figures"] == {"growth": None}


def test_a_page_shows_what_hides_in_the_texts_of_strangers() -> None:
    turned = Finding("run", Severity.ERROR, "a\u202e.x", "It failed:\u2066 <b>\x1b[2J.", {}, "Do\u202e this.", "")
    page = Diagnosis("s", "jacobi", 1e-3, 1.0, (turned,))._repr_html_()
    assert not set(page) & set("\u202e\u2066\x1b")
    assert r"It failed:\u2066 &lt;b&gt;\x1b[2J. Do\u202e this." in page


@pytest.mark.parametrize(("given", "named"), [({"budget": 0.0}, "budget"), ({"step": 0.0}, "step")])
def test_what_cannot_be_examined_is_refused(given: dict[str, float], named: str) -> None:
    with pytest.raises(SystemDescriptionError, match=named):
        diagnose(wall.system(1e-2, 1.0), **given)  # type: ignore[arg-type]
