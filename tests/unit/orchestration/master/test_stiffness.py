"""Evidence that a run warns of springs that are too stiff where its error is large, and is silent where it is small."""

import math
import warnings
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import ContinuousModel, build
from orchestration import StiffnessWarning, System, compare, scenario, simulate
from orchestration.master.stiffness import stiff_components
from orchestration.paper.scenarios import SCENARIOS, VARIANTS

LARGE, SMALL = 1e-2, 1e-3  # error over the range of a signal


def warned(system: System) -> tuple[list[str], float]:
    """What a run warns of, and its largest error over the range of a signal against a run with tiny sub-steps."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", StiffnessWarning)
        result = simulate(system)
        said = [str(w.message) for w in caught]
        assert {w.filename for w in caught} <= {__file__}
    # A fiftieth of a radian for each sub-step: (omega dt)^4 / 120 is 1e-9 per radian.
    dt_max, K_f = (float(np.max(system["plant"][name])) for name in ("dt_max", "K_f"))
    fine = min(dt_max, 0.02 / math.sqrt(K_f), system.run_step() / 10)
    with warnings.catch_warnings():
        warnings.simplefilter("error", StiffnessWarning)
        exact = simulate(system.set({"plant.dt_max": fine}))
    return said, compare(exact, result).worst.relative


@pytest.mark.parametrize("name", ["fig2", "fig4"])
@pytest.mark.parametrize("K_f", [1e5, 1e6, 1e7, 1e8, 1e9])
def test_a_stiff_wall_is_announced_where_it_matters(name: str, K_f: float) -> None:
    said, error = warned(scenario(name).set({"plant.K_f": K_f}))
    if error > LARGE:
        assert len(said) == 1, error
        assert said[0].startswith(f"plant: K_f = {K_f:g} N/m on m[2] = 1 kg swings at")
    if error < SMALL:
        assert said == [], error
    assert bool(said) == (K_f >= 1e8)


@pytest.mark.parametrize(("name", "K_f"), [("fig2", 3e7), ("fig2", 1e8), ("fig4", 3e7)])
def test_the_advised_sub_step_does(name: str, K_f: float) -> None:
    system = scenario(name).set({"plant.K_f": K_f})
    advised = stiff_components(system, 1e-4)[0].advised
    said, error = warned(system.set({"plant.dt_max": advised}))
    assert said == []
    assert error < SMALL


@pytest.mark.parametrize("name", [*SCENARIOS, *VARIANTS])
def test_no_figure_of_the_paper_is_stiff(name: str) -> None:
    system = scenario(name)
    assert stiff_components(system, system.run_step()) == []


def test_the_step_counts_where_it_is_shorter_than_the_sub_step() -> None:
    system = scenario("fig2").set({"plant.K_f": 1e8})
    found = {step: stiff_components(system, step) for step in (1e-4, 1.5e-4, 1e-6)}
    assert [one.sub_step for one in found[1e-4]] == [1e-4]
    assert [one.sub_step for one in found[1.5e-4]] == [7.5e-5]  # two equal parts
    assert found[1e-6] == []


def test_the_lightest_mass_and_the_stiffest_spring_decide() -> None:
    stiff = scenario("fig2").set({"plant.K_f": 1e8, "plant.m": [0.25, 4.0]})
    (found,) = stiff_components(stiff, 1e-4)
    assert found.rate == pytest.approx(2e4)  # rad/s, sqrt(1e8 / 0.25)
    assert "m[1] = 0.25 kg" in str(found)


def test_only_components_that_tell_their_sub_step_count() -> None:
    system = scenario("fig2").set({"controller.K": 1e9})  # N/m, beside M in kg; the controller integrates nothing
    assert stiff_components(system, 1e-4) == []


def test_moments_of_single_bodies_are_not_taken_for_the_inertia_of_a_joint(tmp_path: Path) -> None:
    """A torsion spring on a moment of 1e-6 kg m2 swings fast; beside a mass, the moment is one of a body's numbers."""
    for units, said in (("kg.m2", 1), (["kg.m2", "kg"], 0)):
        model = ContinuousModel("Spring", "A spring")
        model.parameter("k", 1e4, unit="N.m/rad", description="Stiffness")
        model.parameter("I", [1e-6, 1e-6], unit=units, description="Moment of inertia, and another number")
        x = model.state("x", 0.0)
        model.derivative(x, -x)
        model.output("x", x, description="State")
        system = System.connected_by_name("torsion", {"plant": build(model, tmp_path)})
        assert len(stiff_components(system, 1e-4)) == said
