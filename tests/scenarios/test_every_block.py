"""Every fence and every indented command of README and docs is run by a test, or has a reason why none can."""

import importlib.util
import re
from pathlib import Path

import pytest

from tests.faults.test_cli_examples import PAGES_OF_COMMANDS
from tests.scenarios.pages import ELSEWHERE, PAGES, ROOT, WITH_BLOCKS
from tests.scenarios.test_guides import GUIDES
from tests.scenarios.tutorial import blocks

FOLLOWED = {
    "docs/campaigns.md": "tests.scenarios.test_campaigns_page",
    "docs/containers.md": "tests.scenarios.test_containers_page",
    "docs/write-your-own-controller.md": "tests.scenarios.test_tutorial",
    "docs/your-robot.md": "tests.scenarios.test_your_robot",
}
"""Pages that a test follows from beginning to end, files included: ``PAGE`` of the test."""
OTHER_TESTS = {
    ("README.md", "sh"): "tests.scenarios.test_first_swap",
    ("docs/cluster.md", "indented"): "tests.scenarios.test_cluster_page",
    ("docs/report.md", "sh"): "tests.scenarios.test_report_page",
}
"""Tests of single fences, and of indented commands, which name the page."""
MODULE = re.compile(r"^    (?:uv run )?python -m ([\w.]+)(.*)$", re.MULTILINE)
ADAPTIMP = re.compile(r"^    (?:uv run )?(adaptimp \w.*)$", re.MULTILINE)


def run_by_a_test(page: str, kind: str, *, named: bool) -> bool:
    """Whether a fence of a kind is run, on a page; a named fence is a file."""
    if page in FOLLOWED:
        return True
    if kind == "python":
        return page in WITH_BLOCKS or page in ELSEWHERE
    if kind == "text":  # what a fence before it shows
        return page in WITH_BLOCKS or page in GUIDES
    commands = page in GUIDES or page in PAGES_OF_COMMANDS or (page, kind) in OTHER_TESTS
    return kind == "sh" and commands and not named


@pytest.mark.parametrize("page", PAGES)
def test_every_fence_is_run(page: str) -> None:
    for block in blocks(ROOT / page):
        assert block.kind, f"{page}, line {block.line}: say of what language the fence is, so that a test can run it"
        known = run_by_a_test(page, block.kind, named=bool(block.file))
        assert known, f"{page}, line {block.line}: no test runs the fence of {block.kind}; tests.scenarios has the ways"


@pytest.mark.parametrize("page", PAGES)
def test_every_command_of_adaptimp_is_run(page: str) -> None:
    prose = re.sub(r"^```.*?^```$", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    known = page in PAGES_OF_COMMANDS or (page, "indented") in OTHER_TESTS
    assert known or not ADAPTIMP.findall(prose), f"{page}: add it to PAGES_OF_COMMANDS"


@pytest.mark.parametrize("page", PAGES)
def test_modules_of_commands_exist_and_know_their_options(page: str) -> None:
    """Such commands measure for minutes or rewrite a page of docs; so they are not run here."""
    for name, arguments in MODULE.findall((ROOT / page).read_text(encoding="utf-8")):
        spec = importlib.util.find_spec(name)
        assert spec is not None, f"{page}: there is no module {name}"
        assert spec.origin is not None
        place = Path(spec.origin)
        sources = place.parent.rglob("*.py") if place.name == "__init__.py" else [place]
        text = "".join(source.read_text(encoding="utf-8") for source in sources)
        for option in re.findall(r"--[a-z-]+", arguments.partition("#")[0]):
            assert f'"{option}"' in text or f"{option} " in text, f"{page}: {name} does not know {option}"


@pytest.mark.parametrize(("page", "module"), [*FOLLOWED.items(), *((p, m) for (p, _), m in OTHER_TESTS.items())])
def test_the_tests_that_follow_pages_name_them(page: str, module: str) -> None:
    source = importlib.util.find_spec(module)
    assert source is not None
    assert source.origin is not None
    assert Path(page).name in Path(source.origin).read_text(encoding="utf-8")


def test_a_fence_that_nothing_runs_is_noticed() -> None:
    assert not run_by_a_test("docs/new.md", "python", named=False)
    assert not run_by_a_test("docs/objects/system.md", "sh", named=False)
    assert not run_by_a_test("docs/first-ten-minutes.md", "toml", named=True)
    assert ADAPTIMP.findall("    adaptimp run fig2\n    $ adaptimp compare a b\n") == ["adaptimp run fig2"]
