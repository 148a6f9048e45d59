"""The table of rules, the code that reports findings, and the page for users say the same."""

import ast
from pathlib import Path

import orchestration.check
from orchestration.check import rules
from orchestration.check.dynamic import supervision, watched_library
from orchestration.check.dynamic.supervision import MISTAKES, OTHER_RULE
from orchestration.check.findings import ROLE, Severity
from orchestration.check.rules import LOOP, RULES, rule_of
from orchestration.paper import closed_loop
from tests.golden.rules import PAGE, page

PACKAGE = Path(orchestration.check.__file__).parent
NAMES = {"ROLE": ROLE, "LOOP": LOOP, "RULE": watched_library.RULE, "REACHING_OUT": supervision.REACHING_OUT}


def written_out() -> set[tuple[str, str]]:
    """Pairs of rule and severity that stand in the code as such."""
    found = set()
    for path in [*PACKAGE.rglob("*.py"), Path(closed_loop.__file__)]:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.args):
                continue
            if node.func.id not in ("error", "warning", "note"):
                continue
            first = node.args[0]
            if isinstance(first, ast.Constant):
                found.add((str(first.value), node.func.id))
            elif isinstance(first, ast.Name) and first.id in NAMES:
                found.add((NAMES[first.id], node.func.id))
    return found


def of_experiments() -> set[tuple[str, str]]:
    """Pairs that an experiment decides: it fails or dies, a mistake is accepted, rows differ."""
    fails = {(rule, "error") for rule in (*supervision.RULES.values(), OTHER_RULE)}
    mistakes = {(supervision.RULES.get(name, OTHER_RULE), "warning") for name in MISTAKES}
    return fails | mistakes | {("13", "error"), ("14", "error"), ("14", "warning"), ("13", "note")}


def test_every_finding_has_a_rule_and_every_rule_a_finding() -> None:
    assert {(rule.id, str(rule.severity)) for rule in RULES} == written_out() | of_experiments()
    assert len({(rule.id, rule.severity) for rule in RULES}) == len(RULES)
    assert rules.LOOP == closed_loop.LOOP


def test_a_rule_is_found() -> None:
    found = rule_of("16", Severity.ERROR)
    assert found is not None
    assert found.section == "2.1.9"
    assert rule_of("trial", Severity.NOTE) is None


def test_every_rule_is_said_in_sentences() -> None:
    for rule in RULES:
        assert rule.fault.endswith(".")
        assert rule.remedy.endswith(".")
        assert "|" not in rule.fault + rule.remedy


def test_the_page_shows_the_table() -> None:
    """``python -m tests.golden.rules --write`` writes it."""
    assert PAGE.read_text(encoding="utf-8") == page(PAGE.read_text(encoding="utf-8"))
