"""Values that change at given times of a run."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestration import Algorithm, Options, SimulationError, System, SystemDescriptionError, prepare, simulate
from tests.unit.orchestration.runs import ADAPTIVE, ALGORITHMS
from tests.unit.orchestration.small_models import H, system

STEPS = 16
every_algorithm = pytest.mark.parametrize("algorithm", ALGORITHMS.values(), ids=ALGORITHMS.keys())


@pytest.fixture
def plant(small: dict[str, Path]) -> System:
    """Return x' = u, with a free u."""
    return system(small, {"plant": "Integrator"}, steps=STEPS)


@every_algorithm
@pytest.mark.parametrize(("at", "seen"), [(4 * H, 4), (4.5 * H, 5), (4 * H + 1e-12, 4), (0.0, 0)])
def test_a_change_acts_from_the_first_communication_point_on(
    plant: System, algorithm: Algorithm, at: float, seen: int
) -> None:
    result = simulate(plant, algorithm=algorithm, changes={at: {"plant.u": 2.0}})
    when = at if algorithm.control is not None else seen * H  # controlled steps end on a change
    np.testing.assert_allclose(result["plant.x"], 2 * np.maximum(0, result.time - when), rtol=0, atol=1e-11)
    assert json.loads(result.metadata["changes"]) == [[pytest.approx(when), "plant.u", 2.0]]


def test_changes_are_made_in_the_order_of_their_times(plant: System) -> None:
    changes = {6.2 * H: {"plant.u": 3.0}, 2 * H: {"plant.u": 1.0}, 6.1 * H: {"plant.u": 7.0}}
    result = simulate(plant, changes=changes)
    slopes = np.repeat([0.0, 1.0, 3.0], [2, 5, STEPS - 7])
    np.testing.assert_array_equal(np.diff(result["plant.x"]), H * slopes)


def test_a_change_is_what_set_does(fig2: System) -> None:
    """Of an array with one value for each element, too."""
    with prepare(fig2, 0.02) as run:
        run.run(until=0.01)
        run.set({"controller.K[1]": 2000.0, "controller.K[2]": 1000.0})
        run.run()
        expected = run.result()
    changed = simulate(fig2, 0.02, changes={0.01: {"controller.K": [2000.0, 1000.0]}})
    assert changed.rows.tobytes() == expected.rows.tobytes()
    assert changed.metadata["changes"] == expected.metadata["changes"]
    assert changed.rows.tobytes() != simulate(fig2, 0.02).rows.tobytes()


@every_algorithm
def test_going_back_repeats_the_changes(plant: System, algorithm: Algorithm) -> None:
    changes = {4 * H: {"plant.u": 1.0}, 8 * H: {"plant.u": -3.0}}
    whole = simulate(plant, algorithm=algorithm, changes=changes)
    with prepare(plant, algorithm=algorithm, changes=changes) as run:
        for at in (2 * H, 4 * H, 6 * H) if algorithm is not ADAPTIVE else (4 * H,):
            run.run(until=at)
            snapshot = run.save()
            for _ in range(2):
                run.run()
                assert run.result().rows.tobytes() == whole.rows.tobytes()
                assert run.result().metadata["changes"] == whole.metadata["changes"]
                run.restore(snapshot)


@every_algorithm
def test_a_change_that_the_fmu_refuses_keeps_the_rows(fig2: System, algorithm: Algorithm) -> None:
    """The stiffness of the controller must be positive, which only the FMU knows."""
    with pytest.raises(
        SimulationError, match=r"^The change at t = 0\.005 s \(step \d+\) is refused: controller: fmi2SetReal .*K\[1\]"
    ) as refused:
        simulate(fig2, 0.01, algorithm=algorithm, changes={0.005: {"controller.K[1]": -5.0}})
    assert refused.value.result is not None
    assert refused.value.result.time[-1] == pytest.approx(0.005)


WRONG: list[tuple[dict[Any, Any], str]] = [
    ({2.5: {"plant.u": 1.0}}, r"^changes: t = 2\.5 s lies outside of the run from 0 s to 2 s\.$"),
    ({-1e-3: {"plant.u": 1.0}}, r"t = -0\.001 s lies outside of the run from 0 s to 2 s"),
    ({2.0: {"plant.u": 1.0}}, r"a change at t = 2 s would do nothing; the last step begins at 1\.875 s"),
    ({"1": {"plant.u": 1.0}}, r"^changes: '1' is not a time; a finite number in s is needed\.$"),
    ({float("nan"): {"plant.u": 1.0}}, r"nan is not a time"),
    ({1.0: {"plant.x": 1.0}}, r"plant\.x is of causality output; only tunable"),
    ({1.0: {"plant.x_start": 1.0}}, r"plant\.x_start is a fixed parameter; only tunable parameters and inputs"),
    ({1.0: {"relay.u": 1.0}}, r"relay\.u takes its value from plant\.x, which would overwrite the change"),
    ({1.0: {"plant.u": "much"}}, r"plant\.u = 'much'"),
    ({1.0: 3.0}, r"at t = 1 s, 3\.0 is not a mapping"),
    ({1.0: {"plant.v": 3.0}}, r"plant has no variable v"),
]


@pytest.mark.parametrize(("changes", "words"), WRONG, ids=[str(changes) for changes, _ in WRONG])
def test_wrong_changes_are_refused_before_the_run(small: dict[str, Path], changes: dict, words: str) -> None:
    made = system(small, {"plant": "Integrator", "relay": "Relay"}, "plant.x -> relay.u", steps=STEPS)
    with pytest.raises(SystemDescriptionError, match=words) as refused:
        prepare(made, options=Options(changes=changes))
    assert len(str(refused.value)) <= 300


def test_an_input_with_a_series_cannot_be_changed(plant: System) -> None:
    given = {"plant.u": (np.array([0.0, STEPS * H]), np.zeros(2))}
    with pytest.raises(SystemDescriptionError, match=r"plant\.u takes its value from a time series"):
        prepare(plant, inputs=given, changes={1.0: {"plant.u": 1.0}})
    with (
        prepare(plant, inputs=given) as run,
        pytest.raises(SystemDescriptionError, match=r"plant\.u takes its value from a time series"),
    ):
        run.set({"plant.u": 1.0})
