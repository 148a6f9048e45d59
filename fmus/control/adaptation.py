"""Adaptation of the arm's parameters, shared by the adaptive controllers, eqs. (19) and (33).

    dp_hat/dt = -Gamma g,   g = W_c' H_hat_x^-1 e*  or  W_s' s

by explicit Euler every N = update_divisor ticks of length Ts:

    p_hat[k + N] = clip(p_hat[k] - N Ts Gamma g[k])

The gain Gamma is diagonal, or a symmetric positive semidefinite matrix; a row of zeros means that the parameter is
known. Adaptation pauses inside the dead zone, |e*| or |s| <= dead_zone, and, if asked for, while an actuator is
saturated. Clipping keeps the Lyapunov functions from growing only if Gamma does not couple parameters, so projection
needs a diagonal Gamma. Norms of errors that have angles are those of `fmus.mechanics.task`, with the length L.
"""

from dataclasses import dataclass, field

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Formula, Formulas, Limits, Type
from fmus.control.controller import Controller
from fmus.control.gain_units import gain_units
from fmus.control.gains import declare_gain, require_definite, require_semidefinite
from fmus.elements import of_axes
from fmus.mechanics.algebra import is_diagonal, times
from fmus.mechanics.task import Metric
from fmus.metric import declare_metric

UNLIMITED = 1e9  # a bound of p that is none
# Assumed, of a payload of 3 cm: its first moment per kg, m, and its moment of inertia per kg, m2. A gain goes with the
# square of its element's size, so that errors of all ten elements count alike. With one gain for all, algorithm 1
# is unstable on a UR3 and on a UR10, and with 5 cm the variant of Spong and Ortega on a light arm.
SIZES = {"kg.m": 0.03, "kg.m2": 0.03**2}


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


@dataclass(frozen=True)
class Adaptation:
    """Parameters of the adaptation, as symbols.

    Attributes
    ----------
    Gamma
        Adaptation gain: its diagonal, shape (r,), or a matrix, shape (r, r).
    Psi
        Gain of the error filter, 1/s: its diagonal, shape (m,), or a matrix, shape (m, m).
    metric
        Lengths of errors and forces.
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
    metric: Metric = field(default_factory=Metric)

    def filtered_error(self) -> ca.SX:
        """Augmented error de + Psi e, m/s or rad/s, shape (m,): e* of eq. (14), s of eq. (30)."""
        controller = self.controller
        return controller.dx - controller.dx_t + times(self.Psi, controller.e)

    def next_estimate(self, p_hat: ca.SX, gradient: ca.SX, error: ca.SX) -> ca.SX:
        """p_hat after an update, shape (r,).

        Parameters
        ----------
        gradient
            g above, shape (r,).
        error
            e* or s, m/s or rad/s, shape (m,).
        """
        interval = self.update_divisor * self.controller.model.period
        active = ca.logic_and(ca.norm_2(self.metric.motion(error)) > self.dead_zone, ca.logic_not(self.paused))
        step = ca.if_else(active, interval, 0)
        moved = p_hat - times(step * self.Gamma, gradient)
        projected = ca.fmin(ca.fmax(moved, self.p_min), self.p_max)
        return ca.if_else(self.projection, projected, moved)


def declare_adaptation(controller: Controller, gain: float, per: str) -> Adaptation:
    """Declare the parameters and the optional input of the adaptation.

    Parameters
    ----------
    gain
        Start of the elements of Gamma whose parameters are uncertain; the others start at 0.
    per
        Unit of a gain apart from those of its two parameters, such as ``1/N.m``.
    """
    model, robot = controller.model, controller.robot
    saturated = model.input(
        "saturated",
        [False] * robot.n,
        type=Type.BOOLEAN,
        description=robot.joints.texts("Whether the actuator is saturated (optional)"),
    )
    Gamma = _declare_Gamma(controller, gain, per)
    Psi = declare_gain(
        model,
        "Psi",
        [100.0] * robot.task.size,
        full=controller.full,
        unit="1/s",
        limits=POSITIVE,
        description=of_axes("Gain of the error filter de + Psi e", robot.task, full=controller.full),
    )
    if controller.full:
        require_definite(model, Psi, "Psi must be positive definite")
    r, units = len(robot.parameters), controller.units_of_p
    p_min = model.parameter(
        "p_min",
        [-UNLIMITED if parameter.signed else 0.0 for parameter in robot.parameters],
        unit=units,
        description=controller.texts_of_p("Lower bound of the"),
    )
    p_max = model.parameter(
        "p_max",
        [UNLIMITED] * r,
        unit=units,
        description=controller.texts_of_p("Upper bound of the"),
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
    for i in range(r):
        inside = ca.logic_and(p_min[i] <= controller.p_start[i], controller.p_start[i] <= p_max[i])
        model.require(
            ca.logic_or(ca.logic_not(projection), inside) - 0.5,
            f"p_start[{i + 1}] must lie within p_min[{i + 1}] and p_max[{i + 1}] when projection is on",
        )
    paused = ca.logic_and(freeze, ca.sum1(saturated) > 0)
    if controller.repulsion is not None:  # a push at the end of a range is no load
        paused = ca.logic_or(paused, ca.sum1(ca.fabs(controller.repulsion)) > 0)
    metric = declare_metric(model, robot.task)
    return Adaptation(controller, Gamma, Psi, p_min, p_max, projection, dead_zone, paused, divisor, metric)


def _declare_Gamma(controller: Controller, gain: float, per: str) -> ca.SX:
    """Declare the adaptation gain; a full one must be positive semidefinite."""
    model, robot = controller.model, controller.robot
    r, units = len(robot.parameters), gain_units(controller.units_of_p, per)
    places = [(i, j) for i in range(r) for j in range(r) if controller.full or i == j]
    diagonal = controller.texts_of_p("Adaptation gain (0 = known) of the")
    Gamma = declare_gain(
        model,
        "Gamma",
        [
            gain * SIZES.get(unit, 1.0) ** 2 if uncertain else 0.0
            for unit, uncertain in zip(controller.units_of_p, robot.uncertain, strict=True)
        ],
        full=controller.full,
        unit=[units[i][j] for i, j in places],
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
