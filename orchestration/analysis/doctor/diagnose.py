"""Examines a co-simulation from all sides: whether it is right, and what to do where it is not.

A run that makes no error message may still be wrong. The examination asks, in this order:

    the wiring        sampling periods, algebraic loops, delays, units, what other tools would lose
    the FMUs          whether their sub-steps are short enough for their stiffest springs, and their walls are the same
    stability         the verdict of `orchestration.analysis.stability`, weighed with the duration of the run
    accuracy          the same run with halved steps
    energy            what the coupling adds to the power bonds that physical units show
"""

import warnings
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from orchestration.analysis.doctor.accuracy import APART, accuracy_findings
from orchestration.analysis.doctor.bonds import energy_findings
from orchestration.analysis.doctor.case import Case, Spelling, in_python
from orchestration.analysis.doctor.diagnosis import Diagnosis, sorted_by_severity
from orchestration.analysis.doctor.finding import Finding, Severity
from orchestration.analysis.doctor.portability import portability_findings
from orchestration.analysis.doctor.sampling import fit_findings, fitting_step, period_findings
from orchestration.analysis.doctor.stability import Ways, failed_run, stability_finding
from orchestration.analysis.doctor.study import SignalError, failure_of, study
from orchestration.analysis.doctor.wiring import DELAYS, delay_findings, loop_findings
from orchestration.analysis.stability.verdict import Verdict, stability
from orchestration.errors import InitializationError, OrchestrationError
from orchestration.fmi.given import positive, require_type
from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import Algorithm, find_algorithm
from orchestration.master.stiffness import SUB_STEP, stiff_components
from orchestration.master.walls import different_walls
from orchestration.stages import stage
from orchestration.system.system import System

BUDGET = 10.0  # s
TRIALS = 8  # share of the budget that a trial of a proposed change may take


def diagnose(
    system: System | str | Path,
    stop_time: float | None = None,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    order: Sequence[str] | None = None,
    budget: float = BUDGET,
    isolate: bool | str | Collection[str] | Isolation | None = None,
    spell: Spelling = in_python,
) -> Diagnosis:
    """Examine a co-simulation: stability, accuracy, energy, delays, and what other tools would lose.

    Parameters
    ----------
    system
        System; or the path of an SSP package.
    stop_time, step
        Stop time and communication step, s. Default: those of the system.
    algorithm
        Co-simulation algorithm, or its name.
    order
        Component names in the order of stepping. Default: the order of the system.
    budget
        Time for the runs with halved steps, s. What does not fit is left out, and that is said.
    isolate
        Components whose FMUs live in processes of their own, as of `orchestration.simulate`. Default: none.
    spell
        Function that says how a user runs a changed case. Default: a call of `orchestration.simulate`.

    Returns
    -------
    Diagnosis
        Findings, the worst first.

    Raises
    ------
    SystemDescriptionError
        If there is no step or no stop time, or the system cannot be run for another reason than its sampling periods.
    InitializationError
        If a component refuses its start values.

    Examples
    --------
    >>> from orchestration import diagnose, scenario
    >>> late = scenario("fig5").with_sample_time(2e-3)  # s; two hundred times the period of the figure
    >>> diagnosis = diagnose(late, algorithm="jacobi")
    >>> diagnosis.of("stability").severity, diagnosis.of("stability").subject
    (<Severity.ERROR: 'error'>, 'plant.dq[2]')
    >>> print(diagnosis.of("stability").advice)  # a run with it has been tried
    Use a step of 0.0002 s.
    """
    if not isinstance(system, System):
        system = System.read(system)
    require_type("The budget", budget, (int, float), "give a time in s, as 10.0")
    positive("The budget", budget)
    if order is not None:
        system = system.ordered(order)
    step, chosen = positive("The step", system.run_step(step)), find_algorithm(algorithm)
    stop = positive("The stop time", system.run_stop_time(stop_time))
    asked = Case(system, step, stop, chosen, isolation=Isolation.of(isolate))
    findings = list(_examined(asked, spell))
    fitting = fitting_step(system, step, asked.duration)
    unfit = list(fit_findings(asked, fitting, spell))
    findings += unfit
    case, signals = asked, ()
    if unfit:
        case = None if fitting is None else asked.but(step=fitting)
    if case is not None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # findings say the same, and more
            seen, signals = _of_runs(case, budget, spell)
            if any(finding.severity == Severity.ERROR for finding in seen):  # what was tried against these goes first
                findings = [replace(f, advice="", command="") if f.id == DELAYS else f for f in findings]
            findings += seen
    return Diagnosis(system.name, chosen.name, step, asked.stop_time, sorted_by_severity(findings), signals)


def _examined(case: Case, spell: Spelling) -> Iterator[Finding]:
    """Findings that need no run."""
    yield from _stiffness(case, spell)
    yield from _walls(case, spell)
    yield from loop_findings(case, spell)
    yield from delay_findings(case, spell)
    yield from period_findings(case)
    yield from portability_findings(case.system)


def _of_runs(case: Case, budget: float, spell: Spelling) -> tuple[list[Finding], tuple[SignalError, ...]]:
    """Findings from the verdict and from the runs with halved steps, and the errors of the signals."""
    made, findings = study(case, budget), []
    ways = Ways(lambda changed: failure_of(changed, budget / TRIALS), spell)
    judged = _judged(case)
    if isinstance(judged, Finding):
        findings.append(judged)
    else:
        findings.append(stability_finding(case, judged, made, ways))
    if made.failure:
        unexplained = isinstance(judged, Finding) or judged.stable
        findings.append(failed_run(case, made, ways if unexplained else None))
    findings += accuracy_findings(case, made, spell)
    if made.result is not None and made.signals and made.signals[0].relative <= APART:
        findings += energy_findings(case, made.result)
    return findings, made.signals


def _judged(case: Case) -> Verdict | Finding:
    """The predicted stability, or a note on why there is none."""
    try:
        with stage("judging the stability of the algorithm", "judged the stability of the algorithm"):
            return stability(case.system, case.step, case.algorithm, isolation=case.isolation)
    except InitializationError:
        raise
    except OrchestrationError as error:
        return Finding("stability", Severity.NOTE, case.system.name, f"There is no verdict on stability: {error}")


def _stiffness(case: Case, spell: Spelling) -> Iterator[Finding]:
    for found in stiff_components(case.system, case.step):
        path = f"{found.component}.{SUB_STEP}"
        yield Finding(
            "stiffness",
            Severity.WARNING,
            path,
            f"{found.stiffness} on {found.inertia} swings at {found.rate:.3g} rad/s, too fast for sub-steps of"
            f" {found.sub_step:.3g} s: the FMU's own errors reach per cents of the range.",
            {"rate": found.rate, "sub_step": found.sub_step, "advised": found.advised},
            f"Set {path} to {found.advised:g} s or less.",
            spell(case.but(values={path: found.advised})),
        )


def _walls(case: Case, spell: Spelling) -> Iterator[Finding]:
    for found in different_walls(case.system):
        one, other = found.told
        yield Finding(
            "different-walls",
            Severity.WARNING,
            f"{found.components[0]}.{found.name}",
            f"{one}, but {other}: both are told of one wall, so the arm pushes with a wrong force, or not at all.",
            dict(zip(found.components, (list(values) for values in found.values), strict=True)),
            f"Set both to the same value, such as that of {found.components[1]}.",
            spell(case.but(values=found.agreed)),
        )
