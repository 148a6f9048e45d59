"""Whatever is done to an FMU, ours or a stranger's, `check` makes a report and `read_description` is clear.

Every file is changed by chance from a seed, which names the example when a test fails. A report, or an
`ArchiveError` of the master, is the only way out: no other exception, no crash, no hang.
"""

import random
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from orchestration import System
from orchestration.check import Report, Severity
from orchestration.errors import ArchiveError
from orchestration.fmi.description import read_description
from tests.interop.foreign.builders import container, python_slave, without_pythonfmu
from tests.unit.orchestration.check.test_robust import examined
from tests.unit.orchestration.checked import DESCRIPTION
from tests.unit.orchestration.mutated import damaged, entries_of, mutant, packed

DESCRIPTIONS, ARCHIVES, WHOLE = 20, 15, 2  # examples of each kind for each file
SLOW = "container"  # its runtime never returns from a step of NaN, which costs every example a timeout
LONGEST = 60.0  # s of this process, a hundred times what an example takes; workers that hang end by their own limit


@pytest.fixture(
    scope="module", params=["Actuator", "HoganImpedance", "Plant", "hand-written", "PythonFMU", "container"]
)
def victim(
    request: pytest.FixtureRequest, fmu_folder: Path, fig5: System, tmp_path_factory: pytest.TempPathFactory
) -> tuple[str, bytes]:
    """Name and bytes of an FMU; three are ours."""
    folder, name = tmp_path_factory.mktemp("victim"), request.param
    if name == "PythonFMU" and (why := without_pythonfmu()):
        pytest.skip(why)
    if name == "hand-written":
        path = request.getfixturevalue("right")
    elif name == "PythonFMU":
        path = python_slave(folder)
    elif name == "container":
        path = container(fig5, folder / "packed.fmu", sequential=True)
    else:
        path = fmu_folder / f"{name}.fmu"
    return name, path.read_bytes()


@contextmanager
def example(name: str, seed: int) -> Iterator[None]:
    """Says which one it was, and that it took too long."""
    started = time.process_time()
    try:
        yield
    except Exception as error:
        error.add_note(f"{name}, seed {seed}")
        raise
    assert time.process_time() - started < LONGEST, f"{name}, seed {seed}"


def survived(content: bytes, path: Path) -> Report:
    """The report; the master reads the description, or refuses the file."""
    path.write_bytes(content)
    with suppress(ArchiveError):
        read_description(path)
    return examined(content)


def test_descriptions(victim: tuple[str, bytes], tmp_path: Path) -> None:
    """Without a binary, so that nothing runs; one in five at least gets past the schema."""
    name, content = victim
    entries = entries_of(content, binaries=False)
    beyond = 0
    for seed in range(DESCRIPTIONS):
        with example(name, seed):
            changed = mutant(random.Random(seed), entries[DESCRIPTION])
            report = survived(packed({**entries, DESCRIPTION: changed}), tmp_path / "changed.fmu")
        assert report.failed
        beyond += not any(f.rule == "1" and f.severity == Severity.ERROR for f in report.findings)
    assert beyond > DESCRIPTIONS // 5


def test_archives(victim: tuple[str, bytes], tmp_path: Path) -> None:
    name, content = victim
    for seed in range(ARCHIVES):
        with example(name, seed):
            survived(damaged(random.Random(seed), content), tmp_path / "damaged.fmu")


def test_descriptions_of_binaries_that_run(victim: tuple[str, bytes], tmp_path: Path) -> None:
    """Changed value references, types and GUIDs meet a binary that knows better."""
    name, content = victim
    entries = entries_of(content, binaries=True)
    ran, seed = 0, 0
    while ran < (1 if name == SLOW else WHOLE):
        seed += 1
        with example(name, seed):
            changed = mutant(random.Random(seed), entries[DESCRIPTION])
            report = survived(packed({**entries, DESCRIPTION: changed}), tmp_path / "changed.fmu")
        ran += not any(f.rule in ("1", "6") and f.severity == Severity.ERROR for f in report.findings)
