"""Does an FMU keep its contract? Static rules, experiments in a process of its own, its role's interface.

    report = check(Path("X.fmu"))
    report.failed, report.findings, report.facts

Rules have numbers: 1 to 8 are about files, 9 to 16 about calls. Whatever the file holds, there is a report.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

from orchestration.check import roles
from orchestration.check.closed_loop import Loop, try_loop
from orchestration.check.dynamic import supervision as dynamic
from orchestration.check.findings import Finding, Report, Severity, capped
from orchestration.check.static import archive_rules, binary_rules, description_rules, structure_rules
from orchestration.check.static.binary_rules import host_library
from orchestration.errors import ArchiveError, SystemDescriptionError

__all__ = ["Finding", "Loop", "Report", "Severity", "check"]

STATIC = (
    archive_rules.sources_are_complete,
    archive_rules.tool_is_not_needed,
    description_rules.combinations_are_legal,
    description_rules.starts_are_where_needed,
    description_rules.names_are_unique_and_structured,
    description_rules.units_are_declared,
    description_rules.limits_hold,
    description_rules.experiment_makes_sense,
    description_rules.capabilities_agree,
    structure_rules.indices_exist,
    structure_rules.outputs_are_complete,
    structure_rules.initial_unknowns_are_complete,
    structure_rules.derivatives_name_their_states,
    structure_rules.dependencies_are_declared,
    binary_rules.binary_is_for_this_machine,
    binary_rules.binaries_are_named_after_the_model,
    binary_rules.functions_are_exported,
)


def check(
    path: Path,
    role: str | None = None,
    *,
    mapping: Mapping[str, str] | None = None,
    loop: Callable[[int], Loop | None] | None = None,
    timeout: float = dynamic.TIMEOUT,
) -> Report:
    """Examine an FMU.

    Parameters
    ----------
    role
        Whose interface it must have; guessed from its outputs if None.
    mapping
        The FMU's names by ours, as for `orchestration.System.replace`.
    loop
        The loop to try a controller in, by the number of joints; none if None.
    timeout
        How long an experiment may take, s.

    Raises
    ------
    ArchiveError
        If there is no such file.
    SystemDescriptionError
        If there is no such role, or a mapped name is unknown.
    """
    if role is not None and role not in roles.ROLES:
        msg = f"There is no role {role}; there are {', '.join(roles.ROLES)}."
        raise SystemDescriptionError(msg)
    if not path.is_file():
        msg = f"{path}: there is no such file."
        raise ArchiveError(msg)
    _require_readable(path)
    path = path.resolve()
    try:
        package = archive_rules.open_package(path)
    except archive_rules.UnreadableError as ended:
        return Report(path, role, (ended.finding,), ("Nothing further could be examined.",))
    document = package.document.renamed(mapping or {})
    role = role or roles.guess(document)
    findings = [finding for rule in STATIC for finding in capped(rule(package))]
    findings += capped(roles.mapping_finds(package.document, mapping or {}))
    if role is not None:
        findings += capped(roles.interface_is_kept(document, role))
    facts: list[str] = []
    if not host_library(package):
        return _report(path, role, findings, ["The binary was not run."])
    outcome = dynamic.experiment_on(package, timeout)
    findings += outcome.findings
    facts += outcome.facts
    if role == "controller" and loop is not None:
        failed = any(finding.severity == Severity.ERROR for finding in findings)
        given = None if failed else loop(roles.joints(document, roles.ROLES[role]))
        if given is None:
            facts.append("The closed loop was not tried" + (": there are errors." if failed else "."))
        else:
            more, measured = try_loop(path, given, mapping or {})
            findings += more
            facts += measured
    return _report(path, role, findings, facts)


def _require_readable(path: Path) -> None:
    try:
        with path.open("rb"):
            pass
    except OSError as failed:
        msg = f"{path} cannot be read: {failed.strerror}."
        raise ArchiveError(msg) from failed


def _report(path: Path, role: str | None, findings: list[Finding], facts: list[str]) -> Report:
    """The worst first, each once."""
    order = list(Severity)
    once = sorted(dict.fromkeys(findings), key=lambda finding: order.index(finding.severity))
    return Report(path, role, tuple(once), tuple(facts))
