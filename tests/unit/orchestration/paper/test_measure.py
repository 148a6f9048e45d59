"""A run without contact is told as such, and no other mistake is taken for it."""

import numpy as np
import pytest

from orchestration import OrchestrationError
from orchestration.paper import laboratory as module
from orchestration.paper.built_fmus import fmus
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.measure import NoContactError, norms
from orchestration.paper.scenarios import SCENARIOS

AWAY = Job("fig2", {"plant.wall_offset": 10.0, "trajectory.wall_offset": 10.0})  # m, out of reach


@pytest.fixture(scope="module")
def laboratory() -> Laboratory:
    return Laboratory(fmus(SCENARIOS["fig2"].models.values()))


def test_a_run_that_never_touches_the_wall_says_so(laboratory: Laboratory) -> None:
    (found,) = laboratory.summaries([AWAY])
    assert isinstance(found, NoContactError)
    assert isinstance(found, OrchestrationError)
    assert str(found) == (
        "The tip never touched the wall from 0 s to 2 s: plant.F_ext is zero in every row;"
        " move the wall or let the run last longer."
    )


def test_another_mistake_is_no_run_without_contact(laboratory: Laboratory, monkeypatch: pytest.MonkeyPatch) -> None:
    """The error was a ValueError once, as is what NumPy raises for arrays of unequal shapes."""

    def wrong(*_: object) -> None:
        msg = "operands could not be broadcast together"
        raise ValueError(msg)

    monkeypatch.setattr(module, "summarize", wrong)
    with pytest.raises(ValueError, match="broadcast"):
        laboratory.summaries([AWAY])


def test_norms_have_the_bits_of_numpy_s() -> None:
    random = np.random.default_rng(7)
    vectors = random.standard_normal((1000, 2)) * 10.0 ** random.integers(-9, 9, (1000, 2))
    assert norms(vectors).tobytes() == np.linalg.norm(vectors, axis=1).tobytes()
