"""Names of factors: what they set in a system, and what they are called in tables."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestration import Factor, OrchestrationError, Study, StudyError, System, SystemDescriptionError
from tests.unit.orchestration.small_models import H, chain

MEASURE = "max(plant.x)"


@pytest.fixture
def study(loop: System) -> Study:
    """A study without a factor."""
    return Study(loop, MEASURE)


@pytest.fixture
def relays(small: dict[str, Path]) -> Study:
    """A study of a source and two relays, which have start values of the same names."""
    return Study(chain(small, 2), "max(relay2.y)")


@pytest.mark.parametrize("name", ["plant.x_start", "x_start"])
def test_a_variable_alone_names_the_only_start_value_of_that_name(study: Study, name: str) -> None:
    extended = study.grid({name: [1, 2]})
    assert extended.points["x_start"].tolist() == [1.0, 2.0]
    assert extended.points.attrs["sets"] == {"x_start": "plant.x_start"}


def test_a_name_that_several_components_have_is_refused(relays: Study) -> None:
    with pytest.raises(StudyError, match=r"^Factor offset: .* write relay1\.offset or relay2\.offset\.$"):
        relays.grid({"offset": [1, 2]})


def test_columns_have_whole_names_where_last_parts_are_equal(relays: Study) -> None:
    points = relays.grid({"relay1.offset": [1, 2], "relay2.offset": [3], "source.sample_time": [H]}).points
    assert points.columns.tolist() == ["relay1.offset", "relay2.offset", "sample_time"]


def test_an_array_gets_one_value_for_all_elements(fig2: System) -> None:
    study = Study(fig2, "max(abs(controller.e[1]))").grid({"controller.K": [1000.0, 2000.0]})
    job = study._setting.job("fig2", study._design)
    assert job.task.varied == ("controller.K[1]", "controller.K[2]")
    assert job.points(np.array([0, 1])).values.tolist() == [[1000.0, 1000.0], [2000.0, 2000.0]]


def test_a_factor_of_several_variables_has_one_column(relays: Study) -> None:
    study = relays.grid(Factor("both", ["relay1.offset", "relay2.offset"], "0:1:3"))
    assert study.points.columns.tolist() == ["both"]
    assert study._setting.job("small", study._design).points(np.array([1])).values.tolist() == [[0.5, 0.5]]


def test_the_sample_time_is_the_step_and_every_period(study: Study) -> None:
    extended = study.grid({"sample_time": [H, H / 2]})
    job = extended._setting.job("small", extended._design)
    assert job.task.varied == ("source.sample_time", "relay.sample_time", "switch.sample_time")
    points = job.points(np.array([0, 1]))
    assert points.steps.tolist() == [H, H / 2]
    assert points.values.tolist() == [[H] * 3, [H / 2] * 3]


def test_the_step_alone_leaves_periods_as_they_are(study: Study) -> None:
    extended = study.grid({"step": [H, H / 4]})
    job = extended._setting.job("small", extended._design)
    assert job.task.varied == ()
    assert job.points(np.array([0, 1])).steps.tolist() == [H, H / 4]


def test_blocks_are_combined_with_the_last_one_changing_fastest(study: Study) -> None:
    points = study.grid({"x_start": [1, 2], "offset": [5, 6, 7]}).points
    assert points.to_numpy().tolist() == [[1, 5], [1, 6], [1, 7], [2, 5], [2, 6], [2, 7]]


def test_a_study_is_a_value(study: Study) -> None:
    extended = study.grid({"x_start": [1, 2]})
    assert (len(study), len(extended), len(extended.grid({"offset": [1, 2]})), len(extended)) == (1, 2, 4, 2)


def test_a_measure_takes_the_short_name_of_a_factor(loop: System) -> None:
    study = Study(loop, "x_start = max(plant.x)").grid({"plant.x_start": [1, 2]})
    assert study.points.columns.tolist() == ["plant.x_start"]


NO_MAPPING: Any = "x_start"
WRONG: dict[str, tuple[Callable[[Study], Any], type[OrchestrationError], str]] = {
    "unknown component": (lambda s: s.grid({"plont.x_start": [1]}), StudyError, "plont.x_start: no component"),
    "unknown variable": (lambda s: s.grid({"plant.x_strat": [1]}), SystemDescriptionError, "plant.x_start"),
    "unknown short name": (lambda s: s.grid({"x_strat": [1]}), StudyError, "did you mean x_start"),
    "an output": (lambda s: s.grid({"plant.x": [1]}), SystemDescriptionError, "only parameters, inputs"),
    "no whole number": (lambda s: s.grid({"relay.n": [1.5]}), SystemDescriptionError, "an integer of 32 bits"),
    "no Boolean": (lambda s: s.grid({"switch.flag": [2]}), SystemDescriptionError, "true or false is needed"),
    "a text for a Real": (lambda s: s.grid({"x_start": "fast"}), SystemDescriptionError, "a plain number"),
    "the same twice": (lambda s: s.grid({"x_start": [1]}).grid({"x_start": [2]}), StudyError, "given twice"),
    "the same by two names": (lambda s: s.grid({"x_start": [1], "plant.x_start": [2]}), StudyError, "both set plant"),
    "two steps": (lambda s: s.grid({"step": [H], "sample_time": [H]}), StudyError, "both set the communication step"),
    "a negative step": (lambda s: s.grid({"step": [-H]}), StudyError, "finite and positive"),
    "a text for the step": (lambda s: s.grid({"step": "fast"}), StudyError, "give a number"),
    "no factor": (lambda s: s.grid({}), StudyError, "A grid needs a factor"),
    "no mapping": (lambda s: s.grid(NO_MAPPING), StudyError, "give values by name"),
    "no seed": (lambda s: s.seeds("1-3"), StudyError, "no component has a start value of this name"),
    "a reserved name": (lambda s: s.grid(Factor("status", "x_start", [1])), StudyError, "name of its own"),
    "no name": (lambda s: s.grid(Factor("", "x_start", [1])), StudyError, "no name"),
    "no variable": (lambda s: s.grid(Factor("x", [], [1])), StudyError, "sets no variable"),
    "an endless number of runs": (
        lambda s: s.grid({"x_start": "0:1:1000000", "offset": "0:1:1000000", "relay.u": [1, 2]}),
        StudyError,
        "at most",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_factor_is_refused_when_it_is_given(study: Study, case: str) -> None:
    make, kind, message = WRONG[case]
    with pytest.raises(kind, match=message):
        make(study)


def test_a_factor_must_fit_every_variant(loop: System, small: dict[str, Path]) -> None:
    other = replace(chain(small, 1), name="other")
    study = Study({"loop": loop, "chain": other}, "max(source.u)")
    with pytest.raises(StudyError, match=r"plant\.x_start"):
        study.grid({"plant.x_start": [1, 2]})
