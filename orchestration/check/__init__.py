"""Checks whether an FMU keeps FMI 2.0 and the interface of its role: rules about files, and experiments.

    report = check(Path("X.fmu"))
    report.failed, report.findings, report.facts

Rules have numbers: 1 to 8 are about files, 9 to 18 about calls; `orchestration.check.rules` lists them. The calls are
made in a confined process of their own, so every file gets a report, even one that crashes. The caller gives the roles,
and a trial that runs the FMU in its role.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from orchestration.check import interface
from orchestration.check.dynamic import supervision as dynamic
from orchestration.check.findings import Finding, Report, Severity, capped
from orchestration.check.interface import Role
from orchestration.check.static import archive_rules, binary_rules, description_rules, structure_rules, variable_rules
from orchestration.check.static.binary_rules import host_library
from orchestration.errors import ArchiveError
from orchestration.sandbox.missing import require_file

__all__ = ["Candidate", "Finding", "Report", "Role", "Severity", "Trial", "check"]

STATIC = (
    archive_rules.entries_are_unique,
    archive_rules.sources_are_complete,
    archive_rules.tool_is_not_needed,
    description_rules.combinations_are_legal,
    description_rules.starts_are_where_needed,
    description_rules.names_are_unique_and_structured,
    description_rules.units_are_declared,
    description_rules.limits_hold,
    description_rules.experiment_makes_sense,
    description_rules.capabilities_agree,
    variable_rules.time_is_one_variable,
    variable_rules.aliases_agree,
    variable_rules.attributes_are_for_co_simulation,
    structure_rules.indices_exist,
    structure_rules.outputs_are_complete,
    structure_rules.initial_unknowns_are_complete,
    structure_rules.derivatives_name_their_states,
    structure_rules.dependencies_are_declared,
    binary_rules.binary_is_for_this_machine,
    binary_rules.binaries_are_named_after_the_model,
    binary_rules.functions_are_exported,
)


@dataclass(frozen=True)
class Candidate:
    """An FMU that passed all rules so far, and that a trial runs in its role.

    Attributes
    ----------
    count
        Number of elements of each counted signal; see `orchestration.check.interface.Signal`.
    formed
        Number of elements of each signal with `Signal.forms`.
    mapping
        The FMU's names of variables, by the names in the role.
    failed
        Whether the rules, the experiments or the interface have shown an error.

    Examples
    --------
    A trial gets a candidate, and returns findings and facts:

    >>> from orchestration import scenario
    >>> from orchestration.check import Candidate, Role, check
    >>> from orchestration.check.interface import COUNTED, Signal
    >>> def trial(candidate: Candidate):
    ...     return [], [f"{candidate.path.name} has {candidate.count} actuators."]
    >>> actuators = Role("actuators", "tau", {"tau": Signal("N.m", COUNTED)})
    >>> report = check(scenario("fig2")["actuator"].path, actuators, trial=trial)
    >>> report.facts[-1]
    'Actuator.fmu has 2 actuators.'
    """

    path: Path
    role: Role
    count: int
    formed: int
    mapping: Mapping[str, str]
    failed: bool


Trial = Callable[[Candidate], tuple[Sequence[Finding], Sequence[str]]]
"""Runs an FMU in its role; returns findings, and sentences about what was measured or not tried."""


def check(
    path: Path,
    role: Role | Iterable[Role] = (),
    *,
    mapping: Mapping[str, str] | None = None,
    trial: Trial | None = None,
    timeout: float = dynamic.TIMEOUT,
    total: float = dynamic.TOTAL,
) -> Report:
    """Examine an FMU file and report every rule that it breaks.

    Parameters
    ----------
    role
        The role whose interface the FMU must have. Of several roles, the FMU has the one whose defining output
        it has. By default no interface is compared.
    mapping
        The FMU's names of variables by the names in the role, as for `orchestration.System.replace`.
    trial
        Function that runs the FMU in its role at the end, if the FMU has a role and could be run.
    timeout
        Longest time of a call into the FMU, s.
    total
        Longest time of all experiments, s. What could not be tried within it is a fact of the report.

    Raises
    ------
    ArchiveError
        If there is no such file.

    Examples
    --------
    >>> from orchestration import scenario
    >>> from orchestration.check import check
    >>> report = check(scenario("fig2")["sensor"].path)  # any FMU of yours
    >>> report.summary(), report.failed
    ('ForceSensor.fmu: no findings', False)
    """
    require_file(path, "file")
    _require_readable(path)
    path = path.resolve()
    mapping, taken = mapping or {}, role if isinstance(role, Role) else None
    try:
        package = archive_rules.open_package(path)
    except archive_rules.UnreadableError as ended:
        return _report(path, taken, [ended.finding], ["Nothing further could be examined."])
    document = package.document.renamed(mapping)
    if not isinstance(role, Role):
        taken = interface.told_role(document, role)
    findings = [finding for rule in STATIC for finding in capped(rule(package))]
    findings += capped(interface.mapping_finds(package.document, mapping))
    if taken is not None:
        findings += capped(interface.interface_is_kept(document, taken))
    if not host_library(package):
        return _report(path, taken, findings, ["The binary was not run."])
    outcome = dynamic.experiment_on(package, timeout, total)
    findings += outcome.findings
    facts = [*outcome.facts, *_not_confined(outcome.confinement)]
    if taken is not None and trial is not None:
        failed = any(finding.severity == Severity.ERROR for finding in findings)
        sizes = interface.count(document, taken), interface.form(document, taken)
        found, measured = trial(Candidate(path, taken, *sizes, mapping, failed))
        findings += found
        facts += measured
    return _report(path, taken, findings, facts, outcome.confinement)


def _not_confined(measures: Sequence[str]) -> Iterator[str]:
    """Yield a sentence about what the system does not keep a binary from; nothing if no process has begun."""
    if measures and "folders" not in measures:
        yield "This system does not keep the binary from changing files; check unknown FMUs elsewhere."
    if measures and "calls" not in measures:
        yield "This system does not keep the binary from the network and from other processes."


def _require_readable(path: Path) -> None:
    try:
        with path.open("rb"):
            pass
    except OSError as failed:
        msg = f"{path} cannot be read: {failed.strerror}."
        raise ArchiveError(msg) from failed


def _report(
    path: Path, role: Role | None, findings: list[Finding], facts: list[str], confinement: Sequence[str] = ()
) -> Report:
    """Report the findings, the worst first and each once."""
    order = list(Severity)
    once = sorted(dict.fromkeys(findings), key=lambda finding: order.index(finding.severity))
    return Report(path, None if role is None else role.name, tuple(once), tuple(facts), tuple(confinement))
