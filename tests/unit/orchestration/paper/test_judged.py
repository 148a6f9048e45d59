"""Figures are called worse than others only if the paired ratio of their errors is surely above 1."""

import numpy as np

from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims import judged
from tests.unit.orchestration.paper.test_cost import summary


def runs(name: str, e: list[float], force: list[float]) -> judged.Noise:
    """Runs of a figure beside runs of Fig. 5 with errors of 1 mm and 10 N."""
    five = [summary(e_contact=1e-3, force_error=10.0) for _ in e]
    return {"fig5": five, name: [summary(e_contact=a, force_error=b) for a, b in zip(e, force, strict=True)]}


def test_larger_at_nearly_all_seeds_is_larger() -> None:
    noise = runs("fig6", [*[1.1e-3] * 29, 0.5e-3], [11.0] * 30)
    assert judged.met(judged.saturation(noise))


def test_larger_by_chance_is_not_larger() -> None:
    """The median is larger, yet 18 of 30 seeds say little."""
    noise = runs("fig6", [*[1.1e-3] * 18, *[0.9e-3] * 12], [11.0] * 30)
    values = judged.saturation(noise)
    assert not limits.SATURATED_ERROR.met(values[limits.SATURATED_ERROR])
    assert limits.SATURATED_FORCE.met(values[limits.SATURATED_FORCE])


def test_one_seed_is_judged_by_its_ratio() -> None:
    assert judged.met(judged.saturation(runs("fig6", [1.01e-3], [10.1])))
    assert not judged.met(judged.saturation(runs("fig6", [1.01e-3], [9.9])))


def test_much_larger_is_not_slightly_larger() -> None:
    assert judged.met(judged.contact_errors(runs("fig7", [1.4e-3] * 30, [35.0] * 30)))
    assert not judged.met(judged.contact_errors(runs("fig7", [1.6e-3] * 30, [35.0] * 30)))
    assert not judged.met(judged.contact_errors(runs("fig7", [1.4e-3] * 30, [41.0] * 30)))


def test_an_estimate_that_stands_still_does_not_fluctuate() -> None:
    noise = {name: [summary(m2_fluctuation=0.06), summary(m2_fluctuation=0.04)] for name in judged.FIGURES}
    assert judged.met(judged.fluctuation(noise)), "the median is the limit, 0.05 kg"
    noise["fig7"] = [summary(m2_fluctuation=np.nan)]
    assert not judged.met(judged.fluctuation(noise))


def test_a_number_that_is_missing_at_any_seed_meets_nothing() -> None:
    runs = [summary(m2_settled=0.1), summary(m2_settled=np.nan), summary(m2_settled=0.2)]
    assert not judged.met(judged.approach(dict.fromkeys(judged.FIGURES, runs)))
