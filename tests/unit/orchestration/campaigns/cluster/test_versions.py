"""A cluster with other versions is refused before the first run, with the machine, both versions and the remedy."""

from types import SimpleNamespace
from typing import Any

import pytest

from orchestration.campaigns.cluster.delivery import Delivery
from orchestration.campaigns.cluster.payload import Payload
from orchestration.campaigns.cluster.versions import require_equal
from orchestration.errors import ClusterError
from tests.unit.orchestration.campaigns.cluster.engines import Arithmetic, a_task

OURS = {"adaptimp": "1.2.3", "distributed": "2026.8.0", "python": "3.11.7.final.0", "numpy": "2.3.1", "numba": "0.62.0"}


def versions(scheduler: dict[str, Any] | None = None, worker: dict[str, Any] | None = None) -> dict[str, Any]:
    """Versions as Dask tells them: those of the client, with differences on the scheduler and on one of two workers."""
    workers = {"tcp://a:1": OURS, "tcp://b:2": {**OURS, **(worker or {})}}
    return {
        "client": {"packages": OURS},
        "scheduler": {"packages": {**OURS, **(scheduler or {})}},
        "workers": {address: {"packages": packages} for address, packages in workers.items()},
    }


@pytest.mark.parametrize(
    "worker", [{}, {"python": "3.11.9.final.0"}, {"numpy": "2.3.9"}, {"numba": "0.62.1"}, {"pandas": "1"}]
)
def test_versions_may_differ_where_that_changes_nothing(worker: dict[str, Any]) -> None:
    require_equal(versions(worker=worker))


def test_a_scheduler_needs_no_numbers() -> None:
    require_equal(versions(scheduler={"numpy": None, "numba": "0.1"}))


@pytest.mark.parametrize(
    ("worker", "sentence"),
    [
        (
            {"adaptimp": "1.2.4"},
            "Worker tcp://b:2 has adaptimp 1.2.4, but this program adaptimp 1.2.3; install adaptimp 1.2.3 there.",
        ),
        (
            {"adaptimp": None},
            "Worker tcp://b:2 has no adaptimp, but this program adaptimp 1.2.3; install adaptimp 1.2.3 there.",
        ),
        (
            {"python": "3.12.1.final.0"},
            "Worker tcp://b:2 has Python 3.12.1, but this program Python 3.11.7; start it with Python 3.11.",
        ),
        (
            {"numpy": "2.2.6"},
            "Worker tcp://b:2 has numpy 2.2.6, but this program numpy 2.3.1; install numpy 2.3.1 there.",
        ),
    ],
)
def test_a_difference_names_machine_versions_and_remedy(worker: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ClusterError) as caught:
        require_equal(versions(worker=worker))
    assert str(caught.value) == sentence


def test_a_scheduler_of_another_version_is_refused() -> None:
    with pytest.raises(ClusterError, match=r"The scheduler has distributed 2025\.1\.0, .* install distributed"):
        require_equal(versions(scheduler={"distributed": "2025.1.0"}))


def test_many_differences_are_counted() -> None:
    with pytest.raises(ClusterError, match=r"There are 2 more differences\.$"):
        require_equal(versions(worker=dict.fromkeys(OURS)))


def test_a_worker_that_joins_later_is_compared_too() -> None:
    delivery = Delivery(Payload.of(a_task(), Arithmetic), {**OURS, "adaptimp": "0.0.1"})
    delivery.setup(SimpleNamespace(address="tcp://late:1"))  # pyright: ignore[reportArgumentType]
    with pytest.raises(ClusterError, match=r"Worker tcp://late:1 has adaptimp .*, but this program adaptimp 0\.0\.1"):
        with delivery.engine():
            pass
