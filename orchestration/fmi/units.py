"""Physical units, and the conversion of numbers from one unit to another.

A unit defines how its numbers become numbers in SI base units (FMI 2.0.4, 2.2.2; SSP 1.0, 4.4.2):

    base value = factor * value + offset
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import numpy as np

Value = TypeVar("Value", float, "np.ndarray")

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
UNCHANGED = (1.0, 0.0)


@dataclass(frozen=True)
class Unit:
    """The definition of a physical unit: exponents of the SI base units, and factor and offset to base units.

    Attributes
    ----------
    exponents
        Exponents that are not zero, in the order of `BASE_UNITS`.
    """

    exponents: tuple[tuple[str, int], ...] = ()
    factor: float = 1.0
    offset: float = 0.0

    def __str__(self) -> str:
        """Factor and exponents, such as ``0.001 kg m2 s-2``."""
        powers = " ".join(f"{base}{'' if power == 1 else power}" for base, power in self.exponents)
        factor = "" if self.factor == 1 else f"{self.factor:g} "
        offset = f" + {self.offset:g}" if self.offset else ""
        return f"{factor}{powers or '1'}{offset}"

    @property
    def convertible(self) -> bool:
        """Whether numbers can be converted: factor and offset are finite, and the factor is not zero."""
        return math.isfinite(self.factor) and self.factor != 0 and math.isfinite(self.offset)

    def without_angle(self) -> "Unit":
        """Return the unit with the radian taken for a number."""
        return Unit(tuple(power for power in self.exponents if power[0] != "rad"), self.factor, self.offset)


@dataclass(frozen=True)
class UnitDefinition:
    """A physical unit with its name; its definition is None if only the name is known."""

    name: str
    meaning: Unit | None = Unit()

    def equivalent(self, other: "UnitDefinition") -> bool:
        """Whether a number means the same in both units; names decide only where definitions lack."""
        return conversion(self, other) == UNCHANGED


@dataclass(frozen=True)
class Linear:
    """A linear conversion of numbers: target = factor * source + offset."""

    factor: float = 1.0
    offset: float = 0.0

    def __call__(self, value: Value) -> Value:
        """Convert a value; a conversion that changes nothing returns the same object."""
        return value if self.trivial else self.factor * value + self.offset

    @property
    def trivial(self) -> bool:
        """Whether the conversion changes no value."""
        return (self.factor, self.offset) == UNCHANGED

    def then(self, after: "Linear") -> "Linear":
        """Return the conversion that does this one and then the other one."""
        if self.trivial or after.trivial:
            return after if self.trivial else self
        return Linear(after.factor * self.factor, after.factor * self.offset + after.offset)


AS_IS = Linear()


def conversion(
    source: UnitDefinition | None, target: UnitDefinition | None, *, relative: bool = False
) -> tuple[float, float] | None:
    """Return factor and offset with target = factor * source + offset; None if the units cannot be converted.

    Parameters
    ----------
    source, target
        Units of both ends; None, no unit, agrees with every unit.
    relative
        Whether the value is a difference, such as one of temperatures. Then offsets do not apply.
    """
    if source is None or target is None:
        return UNCHANGED
    given, wanted = source.meaning, target.meaning
    if given is None or wanted is None:
        return UNCHANGED if source.name == target.name else None
    if given.exponents != wanted.exponents:
        return None
    same_offset = relative or given.offset == wanted.offset
    if given.factor == wanted.factor and same_offset:
        return UNCHANGED
    offset = 0.0 if relative else (given.offset - wanted.offset) / wanted.factor
    return given.factor / wanted.factor, offset


def defined(name: str | None, units: Mapping[str, UnitDefinition]) -> UnitDefinition | None:
    """Return the unit of a name: None if the name is empty, a unit without definition if the name is unknown."""
    if not name:
        return None
    return units.get(name) or UnitDefinition(name, None)
