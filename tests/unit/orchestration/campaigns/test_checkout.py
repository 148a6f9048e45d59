"""The sources of adaptimp count for a run where they can change without a new version."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from orchestration import System
from orchestration.campaigns.engines import checkout as module
from orchestration.campaigns.engines.checkout import checkout
from orchestration.campaigns.engines.task import Task


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with packages of one file each, which are taken for those of adaptimp."""
    for package in module._PACKAGES:
        (tmp_path / package / "inner").mkdir(parents=True)
        (tmp_path / package / "inner" / "code.py").write_text("A = 1\n")
    monkeypatch.setattr(module, "files", lambda package: tmp_path / package)
    checkout.cache_clear()
    yield tmp_path
    checkout.cache_clear()


@pytest.mark.parametrize("package", module._PACKAGES)
@pytest.mark.parametrize("name", ["code.py", "runtime.c", "runtime.h"])
def test_a_changed_source_is_another_structure(sources: Path, fig2: System, package: str, name: str) -> None:
    before = Task(fig2, (), (), 0.1).structure
    assert Task(fig2, (), (), 0.1).structure == before
    (sources / package / "inner" / name).write_text("A = 2;\n")
    checkout.cache_clear()  # as in a new process
    assert Task(fig2, (), (), 0.1).structure != before


def test_what_is_installed_counts_by_its_version(sources: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert list(checkout()) == ["sources"]
    monkeypatch.setattr(module, "get_path", lambda _: str(sources))
    checkout.cache_clear()
    assert checkout() == {}
