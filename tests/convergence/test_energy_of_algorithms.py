"""How much energy each algorithm adds to an undamped oscillator or takes from it.

The formula is that of `force_displacement.energy_drift`. Inputs that are held at the value of the end of the step are
younger than the values they stand for, by h / 2 on average. So all delays in the formula are -h / 2:

    dE/dt = h k_c (v1 v2 - v1^2 / 2)        and, at the wall, where both delays add up, -h k v^2 / 2
"""

import numpy as np
import pytest

from orchestration import simulate
from orchestration.master.algorithm import NEWTON, PARALLEL, Algorithm, Correction, Tolerance
from tests.reference.problems import force_displacement, wall

HELD = [Algorithm("iterative", PARALLEL, correction=Correction()), Algorithm("newton", correction=Correction(NEWTON))]


@pytest.mark.parametrize("algorithm", HELD, ids=["iterative", "newton"])
def test_held_corrected_inputs_take_energy(algorithm: Algorithm) -> None:
    h, t = 1e-3, np.linspace(0, 1, 2001)
    v1, v2 = (force_displacement.exact(t)[name] for name in ("left.v", "right.v"))
    energy = force_displacement.energy(simulate(force_displacement.system(h, 1.0), algorithm=algorithm))
    predicted = np.trapezoid(h * 20.0 * (v1 * v2 - v1**2 / 2), t)
    assert predicted < 0
    # The prediction is of first order in h. The next term is smaller by y / 2 <= 0.1 h / (step of `SPAN`, 5e-3) = 0.02.
    assert energy[-1] - energy[0] == pytest.approx(predicted, rel=0.02)
    energy = wall.energy(simulate(wall.system(h, 1.0), algorithm=algorithm))
    predicted = -np.trapezoid(h * 100.0 * wall.exact(t)["mass.v"] ** 2 / 2, t)
    # As above, 0.1 h / (step of `SPAN`, 2.5e-3) = 0.04.
    assert energy[-1] - energy[0] == pytest.approx(predicted, rel=0.04)


@pytest.mark.parametrize("module", [force_displacement, wall], ids=["two masses", "wall"])
def test_linear_corrected_inputs_keep_energy_over_100_periods(module) -> None:
    """Straight lines (order 1) keep the energy, where a parabola (order 2) gains by the third power of the step.

    A force that is linear between its values at both ends of the step makes the linear-acceleration method
    (N. M. Newmark, 1959, beta = 1/6, gamma = 1/2). Its eigenvalues lie on the unit circle while w h < 2 sqrt(3).
    """
    h, period = 5e-3, {force_displacement: 2.92, wall: 2 * np.pi / 10}[module]  # s; of the slower of two modes
    stop = h * round(100 * period / h)
    newton = {
        order: Algorithm("newton", order=order, correction=Correction(NEWTON, Tolerance(1e-12))) for order in (1, 2)
    }
    energy = module.energy(simulate(module.system(h, stop), algorithm=newton[1]))
    tenth = len(energy) // 10  # ten periods, so that what swings with them averages out
    # Each step meets the inputs within 1e-12; the random sum over 6e4 steps is 3e-10. The energy swings by
    # (w h)^2 / 12 = 2e-4, and the mean over ten periods keeps a thousandth of that from incomplete periods: 2e-7.
    assert abs(energy[-tenth:].mean() / energy[:tenth].mean() - 1) < 1e-6
    assert np.ptp(energy / energy[0]) < 3e-4
    energy = module.energy(simulate(module.system(h, stop), algorithm=newton[2]))
    assert energy[-tenth:].mean() / energy[:tenth].mean() - 1 > 1e-3
