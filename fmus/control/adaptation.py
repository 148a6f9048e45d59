"""Adaptation of the arm's parameters, shared by the adaptive controllers, eqs. (19) and (33).

    dp_hat/dt = -Gamma g,   g = W_c' H_hat_x^-1 e*  or  W_s' s

by explicit Euler every N = update_divisor ticks of length Ts:

    p_hat[k + N] = clip(p_hat[k] - N Ts Gamma g[k])

The gain Gamma is diagonal, or a symmetric positive semidefinite matrix; a row of zeros means that the parameter is
known. Adaptation pauses inside the dead zone, |e*| or |s| <= dead_zone, and, if asked for, while an actuator is
saturated. Clipping keeps the Lyapunov functions from growing only if Gamma does not couple parameters, so projection
needs a diagonal Gamma.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Formula, Formulas, Limits, Type
from fmus.control.controller import Controller, parameter_descriptions, parameter_units
from fmus.control.gains import declare_gain, require_definite, require_semidefinite
from fmus.elements import of_axes, of_joints
from fmus.mechanics.algebra import is_diagonal, times

UNLIMITED = 1e9  # an upper bound of p that is none
FORMULAS = Formulas(
    "Update of the estimates",
    [
        Formula(
            r"\hat{p}_{k+N} = \hat{p}_k - N\,T_s\,\Gamma\,g_k",
            "Every N-th tick (update_divisor) the estimates follow the gradient g of the law above. With projection"
            " they stay within p_min and p_max.",
        )
    ],
)


GainUnits = tuple[tuple[str, str, str], tuple[str, str], tuple[str]]
"""Units of Gamma for m, viscous and coulomb: the rows of the upper triangle of a 3 x 3 matrix."""


@dataclass(frozen=True)
class Adaptation:
    """Parameters of the adaptation, as symbols.

    Attributes
    ----------
    Gamma
        Adaptation gain: its diagonal, shape (3 n,), or a matrix, shape (3 n, 3 n).
    Psi
        Gain of the error filter, 1/s: its diagonal, shape (2,), or a matrix, shape (2, 2).
    """

    controller: Controller
    Gamma: ca.SX
    Psi: ca.SX
    p_min: ca.SX
    p_max: ca.SX
    projection: ca.SX
    dead_zone: ca.SX
    paused: ca.SX
    update_divisor: ca.SX

    def filtered_error(self) -> ca.SX:
        """Augmented error de + Psi e, m/s, shape (2,): e* of eq. (14), s of eq. (30)."""
        controller = self.controller
        return controller.dx - controller.dx_t + times(self.Psi, controller.e)

    def next_estimate(self, p_hat: ca.SX, gradient: ca.SX, error: ca.SX) -> ca.SX:
        """p_hat after an update, shape (3 n,).

        Parameters
        ----------
        gradient
            g above, shape (3 n,).
        error
            e* or s, m/s, shape (2,).
        """
        interval = self.update_divisor * self.controller.model.period
        active = ca.logic_and(ca.norm_2(error) > self.dead_zone, ca.logic_not(self.paused))
        step = ca.if_else(active, interval, 0)
        moved = p_hat - times(step * self.Gamma, gradient)
        projected = ca.fmin(ca.fmax(moved, self.p_min), self.p_max)
        return ca.if_else(self.projection, projected, moved)


def declare_adaptation(controller: Controller, gains: Sequence[float], gain_units: GainUnits) -> Adaptation:
    """Declare the parameters and the optional input of the adaptation.

    Parameters
    ----------
    gains
        Start of Gamma, shape (3 n,).
    gain_units
        Units of its elements.
    """
    model, n = controller.model, controller.arm.n
    saturated = model.input(
        "saturated",
        [False] * n,
        type=Type.BOOLEAN,
        description=of_joints("Whether the actuator is saturated (optional)", n),
    )
    Gamma = _declare_Gamma(controller, gains, gain_units)
    Psi = declare_gain(
        model,
        "Psi",
        [100.0, 100.0],
        full=controller.full,
        unit="1/s",
        limits=POSITIVE,
        description=of_axes("Gain of the error filter de + Psi e", full=controller.full),
    )
    if controller.full:
        require_definite(model, Psi, "Psi must be positive definite")
    units = parameter_units(n)
    p_min = model.parameter(
        "p_min",
        [0.0] * 3 * n,
        unit=units,
        description=parameter_descriptions(n, "Lower bound of the"),
    )
    p_max = model.parameter(
        "p_max",
        [UNLIMITED] * 3 * n,
        unit=units,
        description=parameter_descriptions(n, "Upper bound of the"),
    )
    projection = model.parameter(
        "projection", False, type=Type.BOOLEAN, description="Whether p_hat is kept within p_min and p_max"
    )
    dead_zone = model.parameter(
        "dead_zone",
        0.0,
        unit="m/s",
        limits=NOT_NEGATIVE,
        description="Norm of the filtered error up to which the adaptation pauses",
    )
    freeze = model.parameter(
        "freeze_when_saturated",
        False,
        type=Type.BOOLEAN,
        description="Whether the adaptation pauses while an actuator is saturated",
    )
    divisor = model.parameter(
        "update_divisor",
        1,
        type=Type.INTEGER,
        limits=Limits(1),
        description="Number of ticks between updates of p_hat",
    )
    if controller.full:
        coupled = ca.sum1(ca.sum2(ca.fabs(Gamma))) - ca.sum1(ca.fabs(ca.diag(Gamma)))
        model.require(
            0.5 - ca.logic_and(projection, coupled > 0),
            "projection needs a diagonal Gamma: clipping coupled estimates may make the error grow; set projection to"
            " false, or the elements of Gamma off the diagonal to 0",
        )
    for i in range(3 * n):
        inside = ca.logic_and(p_min[i] <= controller.p_start[i], controller.p_start[i] <= p_max[i])
        model.require(
            ca.logic_or(ca.logic_not(projection), inside) - 0.5,
            f"p_start[{i + 1}] must lie within p_min[{i + 1}] and p_max[{i + 1}] when projection is on",
        )
    paused = ca.logic_and(freeze, ca.sum1(saturated) > 0)
    return Adaptation(controller, Gamma, Psi, p_min, p_max, projection, dead_zone, paused, divisor)


def _declare_Gamma(controller: Controller, gains: Sequence[float], gain_units: GainUnits) -> ca.SX:
    """Declare the adaptation gain; a full one must be positive semidefinite."""
    model, n = controller.model, controller.arm.n
    kinds = [kind for kind in range(3) for _ in range(n)]
    places = [(i, j) for i in range(3 * n) for j in range(3 * n) if controller.full or i == j]
    diagonal = parameter_descriptions(n, "Adaptation gain (0 = known) of the")
    Gamma = declare_gain(
        model,
        "Gamma",
        list(gains),
        full=controller.full,
        unit=[gain_units[min(kinds[i], kinds[j])][abs(kinds[j] - kinds[i])] for i, j in places],
        limits=NOT_NEGATIVE,
        description=[
            diagonal[i] if i == j else f"Adaptation gain between p[{i + 1}] and p[{j + 1}]" for i, j in places
        ],
    )
    if not is_diagonal(Gamma):
        require_semidefinite(
            model, Gamma, "Gamma must be positive semidefinite, and a zero on its diagonal needs a row of zeros"
        )
    return Gamma
