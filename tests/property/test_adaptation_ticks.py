"""The adaptive controllers' FMUs against the paper's formulas in tip space, tick by tick, with random inputs.

Checked at each tick: tau_cmd of (10) with (22), (32) and remark 2; what the theory watches, (14), (23) to
(26); and that p_hat of the next tick is p_hat - Ts Gamma W_c' H_hat_x^-1 e*, or - Ts Gamma W_s' s.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from orchestration.paper.built_fmus import built
from tests.driver import Driver
from tests.property.operational import Answer, Gains, Tick, augmented, matrix
from tests.property.samples import EPS
from tests.property.ticks import (
    CONTROLLERS,
    CRAIG,
    FULL,
    SLOTINE_LI,
    SPONG_ORTEGA,
    Sample,
    answer,
    full_samples,
    run,
    samples,
    show,
)

SIZE, TICKS = 20, 4
WATCHED = {
    CRAIG: ("e_star", "alpha", "beta", "mu", "gamma", "gamma_bound", "F_c"),
    SPONG_ORTEGA: ("e_star", "alpha", "beta", "mu", "gamma", "gamma_bound", "F_c"),
    SLOTINE_LI: ("s",),
}


def rounding(controller: str, tick: Tick, gains: Gains) -> float:
    """Relative rounding of all that follows from e*: x - x_t cancels, which Psi and alpha see."""
    pose, p = tick.pose, gains.p_start if controller == SPONG_ORTEGA else tick.p_hat
    psi = np.linalg.eigvalsh(matrix(gains.Psi))
    error = min(np.linalg.norm(tick.e), np.linalg.norm(augmented(tick, gains)) / psi.max())
    return pose.rounding(p) * (1 + (np.linalg.norm(pose.x) + np.linalg.norm(pose.dx) / psi.min()) / error)


def require(actual: np.ndarray, expected: np.ndarray, tolerance: float, what: str) -> None:
    """A vector agrees within a norm."""
    miss = np.linalg.norm(actual - expected)
    assert miss <= tolerance, f"{what}: {actual} instead of {expected}, off by {miss:.2e}, allowed {tolerance:.2e}"


@dataclass(frozen=True)
class Walk:
    """All samples through one controller: of each the ticks, what the formulas give, what the FMU shows."""

    controller: str
    samples: list[Sample]
    seen: list[list[tuple[Tick, Answer, dict[str, np.ndarray]]]]


@pytest.fixture(scope="module", params=[*CONTROLLERS, *(f"{controller}{FULL}" for controller in CONTROLLERS)])
def walk(fmu_folder: Path, request: pytest.FixtureRequest) -> Iterator[Walk]:
    """A controller's walk; that of a variant with full matrices has gains which couple the axes."""
    controller, full = request.param.removesuffix(FULL), request.param.endswith(FULL)
    drawn = list((full_samples if full else samples)(SIZE, TICKS, seed=1983))
    driver = Driver(built(request.param) if full else fmu_folder / f"{controller}.fmu")
    names = ("tau_cmd", "e", *WATCHED[controller])
    seen = [
        [
            (tick, answer(controller, tick, sample.gains), {name: show(driver, name) for name in names})
            for tick in run(driver, controller, sample)
        ]
        for sample in drawn
    ]
    yield Walk(controller, drawn, seen)
    driver.close()


def test_torque_and_watched_quantities_are_the_papers(walk: Walk) -> None:
    active, bounds = 0, 0
    for sample, ticks in zip(walk.samples, walk.seen, strict=True):
        for k, (tick, expected, shown) in enumerate(ticks):
            relative = rounding(walk.controller, tick, sample.gains)
            assert relative < 1e-6  # the comparison means something
            require(shown["e"], tick.e, 4 * EPS * (np.linalg.norm(tick.pose.x) + sum(sample.arm[:2])), "e")
            for name, value in expected.outputs.items():
                # gamma* divides by alpha^2: two more relative errors of alpha, and a factor for its own
                # cancellation.
                factor = 10.0 if name == "gamma_bound" else 1.0
                require(shown[name], value, factor * relative * float(expected.scales[name]), f"{name}, tick {k}")
            if walk.controller != SLOTINE_LI:
                active += expected.outputs["gamma"][0] > 0
                bounds += expected.outputs["gamma_bound"][0] > 0
    if walk.controller != SLOTINE_LI:  # both sides of (25) and of case (c) occur
        assert SIZE // 2 < active < SIZE * TICKS - SIZE // 2
        assert SIZE // 2 < bounds < SIZE * TICKS - SIZE // 2


def test_adaptation_goes_the_papers_way(walk: Walk) -> None:
    moved = []
    for sample, ticks in zip(walk.samples, walk.seen, strict=True):
        Ts = sample.gains.sample_time
        np.testing.assert_array_equal(ticks[0][0].p_hat, sample.gains.p_start)
        for (tick, expected, _), (following, _, _) in pairwise(ticks):
            relative = rounding(walk.controller, tick, sample.gains)
            # Two roundings of p_hat itself; the variant with a fixed inverse takes it from p_start.
            own = 4 * EPS * (np.abs(tick.p_hat) + sample.gains.p_start).max()
            tolerance = relative * Ts * expected.scales["rate"] + own
            require(following.p_hat, tick.p_hat + Ts * expected.rate, tolerance, "p_hat")
            known = np.diag(matrix(sample.gains.Gamma)) == 0
            np.testing.assert_array_equal(following.p_hat[known], sample.gains.p_start[known])
            moved.append(np.linalg.norm(Ts * expected.rate) / tolerance)
    assert np.median(moved) > 1e6  # the movement is far above the tolerance
