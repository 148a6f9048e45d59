"""Models that are updated at every tick of a clock and hold their outputs in between."""

from collections.abc import Callable
from dataclasses import dataclass, field

import casadi as ca

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.model import POSITIVE, Model
from adaptimp_fmu.variables import Role, Type, Variable


@dataclass(frozen=True)
class Noise:
    """Random numbers, drawn anew after every `ticks` ticks: a function of four uniform numbers in (0, 1)."""

    symbol: ca.SX
    uniforms: ca.SX
    value: ca.SX
    active: ca.SX
    seed_name: str
    ticks: ca.SX

    @property
    def ticks_per_draw(self) -> ca.SX:
        """The number of ticks that share a draw, a whole number from 1 to 2^53; 0 while the noise is off."""
        return ca.if_else(self.active > 0, ca.fmin(ca.fmax(self.ticks, 1), 2.0**53), 0)


@dataclass
class SampledModel(Model):
    """A model that is updated every ``sample_time`` and holds its outputs in between.

    Parameters
    ----------
    sample_time
        Start value of the parameter ``sample_time``, s.

    Examples
    --------
    A controller that sums up the error, once in a millisecond:

    >>> from adaptimp_fmu import NOT_NEGATIVE, SampledModel, build
    >>> controller = SampledModel("Integral", "Integral controller", sample_time=1e-3)
    >>> gain = controller.parameter("gain", 2.0, unit="N/m.s", limits=NOT_NEGATIVE, description="Gain", tunable=True)
    >>> error = controller.input("error", 0.0, unit="m", description="Wanted less measured position")
    >>> F = controller.state("F", 0.0)
    >>> controller.update(F, F + controller.period * gain * error)
    >>> controller.output("F", F, unit="N", description="Force")
    >>> build(controller).name
    'Integral.fmu'

    A sensor with noise, whose mean over all ticks is updated at every tenth tick:

    >>> from adaptimp_fmu import Limits, Type
    >>> sensor = SampledModel("Sensor", "A sensor")
    >>> seed = sensor.parameter("seed", 1, type=Type.INTEGER, description="Key of the noise")
    >>> n = sensor.parameter("n", 10, type=Type.INTEGER, limits=Limits(1), description="Ticks for each update")
    >>> x = sensor.input("x", 0.0, unit="m", description="Position")
    >>> noise = sensor.random(lambda u: 1e-3 * (u[0] - 0.5), active=1.0, seed="seed")
    >>> mean = sensor.state("mean", 0.0)
    >>> sensor.update_slowly(mean, 0.9 * mean + 0.1 * x, divisor="n")
    >>> sensor.output("measured", x + noise, unit="m", description="Measured position")
    >>> sensor.output("mean", mean, unit="m", description="Mean position")
    >>> sensor.require_named_parameters()  # seed and n are what they must be; `build` asks the same
    """

    sample_time: float = 1e-4
    noise: Noise | None = None
    divisor_name: str | None = field(default=None, init=False)
    period: ca.SX = field(init=False)
    period_name: str = field(default="sample_time", init=False)

    def __post_init__(self) -> None:
        """Declare ``sample_time``."""
        self.period = self.parameter(
            "sample_time", self.sample_time, unit="s", limits=POSITIVE, description="Sampling period"
        )

    def update(self, state: ca.SX, value: ca.SX) -> None:
        """Give the value of a state at the next tick."""
        self._evolve(state, value)

    def update_slowly(self, state: ca.SX, value: ca.SX, *, divisor: str) -> None:
        """Give the value of a state after every n-th tick; in between it is held and `value` costs nothing.

        Parameters
        ----------
        divisor
            Name of the Integer parameter n, the same for all slow states of the model. The minimum of n must be at
            least 1. The parameter may be declared later.

        Raises
        ------
        DefinitionError
            If the model has another divisor, or n is not such a parameter (when the model is built, if n is declared
            later).
        """
        if self.divisor_name not in (None, divisor):
            names = f"{self.divisor_name} and {divisor}"
            msg = f"{self.name}: slow states have the divisors {names}; one serves all."
            raise DefinitionError(msg)
        if self._has(divisor):
            self._require_divisor(divisor)
        self.divisor_name = divisor
        self._evolve(state, value)
        next(s for s in self.states if s.symbol is state).slow = True

    def random(self, value: Callable[[ca.SX], ca.SX], *, active: ca.SX, seed: str, ticks: ca.SX | None = None) -> ca.SX:
        """Declare noise that is drawn at every tick, or after every so many ticks and held in between.

        Parameters
        ----------
        value
            Maps four independent uniform numbers in (0, 1), shape (4,), to the noise, shape (n,).
        active
            The noise is zero, and costs nothing, unless this function of parameters is positive.
        seed
            Name of the Integer parameter that is the generator's key. The parameter may be declared later.
        ticks
            Number of ticks that share a draw, a whole number that is a function of parameters; 1 by default. Draw k
            serves the ticks from k `ticks` on.

        Returns
        -------
        SX
            The noise, shape (n,).

        Raises
        ------
        DefinitionError
            If the model already has noise, or the key is not such a parameter (when the model is built, if the key is
            declared later).
        """
        if self.noise is not None:
            msg = f"{self.name} already declares noise."
            raise DefinitionError(msg)
        if self._has(seed):
            self._require_integer(seed, f"the seed {seed} of the noise must be an Integer parameter")
        uniforms = ca.SX.sym("uniforms", 4)
        drawn = ca.vec(ca.SX(value(uniforms)))
        symbol = ca.SX.sym("noise", drawn.numel())
        self.noise = Noise(symbol, uniforms, drawn, ca.SX(active), seed, ca.SX(1 if ticks is None else ticks))
        return symbol

    def require_named_parameters(self) -> None:
        """Refuse a divisor or a seed with which the runtime could not calculate.

        Raises
        ------
        DefinitionError
            If a name is unknown, or its variable is not a parameter of the right type and range.
        """
        if self.divisor_name is not None:
            self._require_divisor(self.divisor_name)
        if self.noise is not None:
            seed = self.noise.seed_name
            self._require_integer(seed, f"the seed {seed} of the noise must be an Integer parameter")

    def _has(self, name: str) -> bool:
        return any(variable.name == name for variable in self.variables)

    def _require_divisor(self, name: str) -> None:
        demand = f"the divisor {name} of slow states must be an Integer parameter with a minimum of at least 1"
        variable = self._require_integer(name, demand)
        if not variable.minimum >= 1:
            msg = f"{self.name}: {demand}; its minimum is {variable.minimum:.0f}."
            raise DefinitionError(msg)

    def _require_integer(self, name: str, demand: str) -> Variable:
        """Return the Integer parameter of a name; `demand` begins the error if the model has none."""
        variable = self.ordered_variables()[self.reference(name)]
        if not variable.role.is_parameter:
            msg = f"{self.name}: {demand}; {name} is an {'input' if variable.role is Role.INPUT else 'output'}."
            raise DefinitionError(msg)
        if variable.type is not Type.INTEGER and variable.stands_for is not Type.INTEGER:
            msg = f"{self.name}: {demand}; {name} is a {variable.type.value}."
            raise DefinitionError(msg)
        return variable
