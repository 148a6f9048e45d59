"""How the noise of a sampled model is drawn: anew at each tick, held for some ticks, or not at all."""

import math

import casadi as ca
import pytest

from tests.unit.adaptimp_fmu.test_model import sampled


@pytest.mark.parametrize(
    ("active", "ticks", "expected"),
    [(2.5, None, 1), (0.0, 7.0, 0), (1.0, 7.0, 7), (1.0, 0.0, 1), (1.0, 1e300, 2.0**53), (1.0, math.inf, 2.0**53)],
)
def test_ticks_that_share_a_draw(active: float, ticks: float | None, expected: float) -> None:
    model = sampled()
    model.random(lambda u: u[0], active=ca.SX(active), seed="seed", ticks=None if ticks is None else ca.SX(ticks))
    assert model.noise is not None
    assert float(ca.DM(ca.evalf(model.noise.ticks_per_draw))) == expected
