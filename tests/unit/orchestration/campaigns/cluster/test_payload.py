"""A task arrives at a worker as it was sent, once for each content, and with the code of its measures."""

import importlib
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from orchestration.campaigns.cluster.payload import Payload
from orchestration.campaigns.measuring.measure import Measure
from orchestration.errors import ClusterError
from orchestration.fmi.isolation import Isolation
from tests.unit.orchestration.campaigns.cluster.engines import Arithmetic, Measuring, a_task, refuse, some_points

BESIDE = """SCALE = 3.0

def scaled(number):
    return SCALE * number
"""


@pytest.fixture
def beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """A module that belongs to no package, such as a file beside a user's program."""
    (tmp_path / "my_own_measures.py").write_text(BESIDE)
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("my_own_measures")
    sys.modules.pop("my_own_measures", None)


def test_a_task_arrives_with_the_same_identity() -> None:
    task = replace(a_task(), isolation=Isolation(["plant"]))
    arrived = Payload.of(task, Arithmetic).engine()
    assert isinstance(arrived, Arithmetic)
    assert arrived.task.identity == task.identity  # FMUs, structure, all start values
    assert arrived.task.isolation == task.isolation
    assert [m.identity for m in arrived.task.measures] == [m.identity for m in task.measures]


def test_a_payload_holds_no_path_of_this_machine() -> None:
    task = a_task()
    payload = Payload.of(task, Arithmetic)
    folder = str(task.system["plant"].path.parent).encode()
    assert folder not in payload.package
    assert folder not in payload.rest


def test_equal_tasks_have_equal_names_and_others_have_others() -> None:
    task = a_task()
    other = replace(task, system=task.system.set({"plant.mu": 0.1}))
    names = [Payload.of(one, Arithmetic).name for one in (task, a_task(), other, replace(task, stop_time=1.0))]
    assert names[0] == names[1]
    assert len(set(names)) == 3
    assert Payload.of(task, refuse).name not in names


def test_the_code_of_a_file_beside_the_program_travels(beside: ModuleType) -> None:
    task = replace(a_task(), measures=(Measure.of(beside.scaled),))
    payload = Payload.of(task, Measuring)
    del sys.modules["my_own_measures"]  # as on a worker
    sys.path[:] = sys.path[1:]
    assert payload.engine().make(some_points(3)).measured.tolist() == [[0.0], [3.0], [6.0]]


def test_a_measure_that_cannot_be_sent_is_told(tmp_path: Path) -> None:
    message = r"A function among the measures logged cannot be sent to workers: .*files"
    with (tmp_path / "log").open("w") as log:
        task = replace(a_task(), measures=(Measure.of(lambda result: log.write(str(result)), "logged"),))
        with pytest.raises(ClusterError, match=message):
            Payload.of(task, Arithmetic)
