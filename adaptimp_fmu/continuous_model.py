"""Models with derivatives, which the runtime integrates and in which it locates events."""

from dataclasses import dataclass, field

import casadi as ca

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.expressions import depends
from adaptimp_fmu.model import POSITIVE, Model


@dataclass(frozen=True)
class Event:
    """A quantity whose change of sign interrupts the integration; `mode` is 1 while the quantity is positive."""

    name: str
    mode: ca.SX
    indicator: ca.SX


@dataclass
class ContinuousModel(Model):
    """A model with derivatives, integrated by Runge-Kutta 4 with steps of at most ``dt_max``.

    Parameters
    ----------
    dt_max
        Start value of the parameter ``dt_max``, s.

    Examples
    --------
    A ball that falls on a soft floor:

    >>> import casadi as ca
    >>> from adaptimp_fmu import POSITIVE, ContinuousModel, build
    >>> ball = ContinuousModel("Ball", "A ball above a soft floor", dt_max=1e-3)
    >>> m = ball.parameter("m", 0.5, unit="kg", limits=POSITIVE, description="Mass")
    >>> F = ball.input("F", 0.0, unit="N", description="Force upwards")
    >>> x, v = ball.state("x", 1.0), ball.state("v", 0.0)
    >>> flying = ball.event("flying", x)  # 1 above the floor, 0 in the floor
    >>> ball.derivative(x, v)
    >>> ball.derivative(v, F / m - 9.81 - (1 - flying) * 1e4 * x / m)
    >>> ball.output("x", x, unit="m", description="Height")
    >>> build(ball).name
    'Ball.fmu'
    """

    dt_max: float = 1e-4
    events: list[Event] = field(default_factory=list)
    period_name: str = field(default="dt_max", init=False)

    def __post_init__(self) -> None:
        """Declare ``dt_max``."""
        self.parameter(
            "dt_max",
            self.dt_max,
            unit="s",
            limits=POSITIVE,
            description="Longest sub-step of the integrator (Runge-Kutta 4)",
        )

    def derivative(self, state: ca.SX, value: ca.SX) -> None:
        """Give the time derivative of a state."""
        self._evolve(state, value)

    def event(self, name: str, indicator: ca.SX) -> ca.SX:
        """Declare an event at the sign change of `indicator`, a function of states and parameters.

        Returns
        -------
        SX
            Mode of the event: 1 while the indicator is positive, else 0. Laws that switch use the mode, so
            that they are smooth between events.
        """
        if depends(indicator, self.input_symbols):
            msg = f"{self.name}: event {name} depends on inputs; it may depend on only states, time and parameters."
            raise DefinitionError(msg)
        mode = ca.SX.sym(f"mode_{name}")
        self.events.append(Event(name, mode, ca.SX(indicator)))
        return mode
