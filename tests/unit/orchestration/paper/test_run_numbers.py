"""The numbers of a run are its ready measures, those only whose columns were recorded."""

import pytest

from orchestration import Result, System, simulate
from orchestration.paper.measure import contact
from orchestration.paper.ready_measures import READY
from orchestration.paper.run_numbers import CHOSEN, columns_needed, run_numbers, sentences


@pytest.fixture(scope="module")
def result(fig2: System) -> Result:
    """The run of Fig. 2."""
    return simulate(fig2)


def test_numbers_are_ready_measures(result: Result) -> None:
    numbers = run_numbers(result)
    assert tuple(numbers) == CHOSEN
    for name, number in numbers.items():
        assert number.value == result.measure(READY[name][0])
    touch = contact(result)
    assert numbers["peak_force"].value == touch.peak
    assert (numbers["first_contact"].value, numbers["last_contact"].value) == (touch.first, touch.last)
    assert [numbers[name].unit for name in ("peak_force", "rms_e_free", "m2_hat", "share_saturated")] == [
        "N",
        "m",
        "kg",
        "",
    ]


def test_their_columns_suffice(fig2: System, result: Result) -> None:
    assert run_numbers(simulate(fig2, record=list(columns_needed()))) == run_numbers(result)


def test_numbers_without_their_columns_are_left_out(fig2: System) -> None:
    found = run_numbers(simulate(fig2, stop_time=0.1, record=["controller.p_hat", "plant.x"]))
    assert list(found) == ["m2_hat"]
    assert sentences(found) == ["estimate of m2 at the end: 1 kg"]


def test_a_run_without_contact_says_so(fig2: System) -> None:
    found = run_numbers(simulate(fig2, stop_time=0.1))
    assert found["first_contact"].value is None
    assert found["max_e_contact"].value is None
    said = sentences(found)
    assert said[0] == "contact: none"
    assert [line.partition(":")[0] for line in said[1:]] == [
        "tracking error in free motion",
        "estimate of m2 at the end",
        "actuators saturated",
    ]


def test_lines_tell_all_numbers(result: Result) -> None:
    said = "\n".join(sentences(run_numbers(result)))
    assert said.splitlines()[0] == "contact: from 0.9067 s to 1.085 s, peak force 633.1 N"
    assert said.count("rms") == 2
