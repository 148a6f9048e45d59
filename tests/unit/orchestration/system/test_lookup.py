"""Components, start values and names are looked up as in a mapping, and notebooks complete the names."""

import numpy as np
import pytest

from orchestration import OrchestrationError, System, simulate


def test_a_system_is_a_mapping_of_components(fig2: System) -> None:
    names = ["trajectory", "sensor", "controller", "actuator", "plant"]
    assert list(fig2) == names
    assert [fig2[name].name for name in fig2] == names
    assert fig2._ipython_key_completions_() == names


def test_start_values_in_force_are_looked_up(fig2: System) -> None:
    changed = fig2.set({"controller.K": [1.0, 2.0], "plant.mu": 0.3})
    np.testing.assert_array_equal(changed["controller"]["K"], [1.0, 2.0])
    assert changed["controller"]["K[2]"] == 2.0
    assert changed["plant"]["mu"] == 0.3
    assert changed["plant"]["dt_max"] == 1e-4  # the FMU's own
    assert fig2["controller"]["K[2]"] == 4000.0


def test_names_of_components_are_variables_and_arrays(fig2: System) -> None:
    plant = fig2["plant"]
    assert {"q", "q[1]", "mu"} <= {name for name in (*plant, "q") if name in plant}
    assert "k" not in plant
    completed = plant._ipython_key_completions_()
    assert {"m", "m[1]", "m[2]", "mu", "tau", "tau[1]"} <= set(completed)
    assert "x" not in completed  # an output without a start value
    for name in completed:
        assert np.all(np.isfinite(plant[name]))


@pytest.mark.parametrize(
    ("name", "words"),
    [("K_F", "are case-sensitive: did you mean K_f"), ("x[1]", "no start value")],
)
def test_what_is_not_there_is_a_key_error_with_near_names(fig2: System, name: str, words: str) -> None:
    with pytest.raises(KeyError) as caught:
        fig2["plant"][name]
    assert isinstance(caught.value, OrchestrationError)
    assert words in str(caught.value)


def test_results_complete_arrays_and_elements(fig2: System) -> None:
    result = simulate(fig2, 2e-4, record="plant.*")
    completed = result._ipython_key_completions_()
    assert {"time", "plant.x", "plant.x[1]", "plant.gap"} <= set(completed)
    for name in completed:
        assert len(result[name]) == 3
