"""Physical units, and what a number in one of them is in another.

A unit says how its numbers become numbers in SI base units (FMI 2.0.4, 2.2.2; SSP 1.0, 4.4.2):

    base value = factor * value + offset
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
UNCHANGED = (1.0, 0.0)


@dataclass(frozen=True)
class Unit:
    """What a physical unit means: exponents of the SI base units, factor and offset to them.

    Attributes
    ----------
    exponents
        Those that are not zero, in the order of `BASE_UNITS`.
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
        """The same with the radian taken for a number."""
        return Unit(tuple(power for power in self.exponents if power[0] != "rad"), self.factor, self.offset)


@dataclass(frozen=True)
class UnitDefinition:
    """A physical unit by name; its meaning is None if nothing but the name is known."""

    name: str
    meaning: Unit | None = Unit()

    def equivalent(self, other: "UnitDefinition") -> bool:
        """Whether a number means the same in both units; names decide only where definitions lack."""
        return conversion(self, other) == UNCHANGED


@dataclass(frozen=True)
class Linear:
    """target = factor * source + offset."""

    factor: float = 1.0
    offset: float = 0.0

    def __call__(self, value: float) -> float:
        """The target's value; the very same one if nothing changes."""
        return value if self.trivial else self.factor * value + self.offset

    @property
    def trivial(self) -> bool:
        """Whether nothing changes."""
        return (self.factor, self.offset) == UNCHANGED

    def then(self, after: "Linear") -> "Linear":
        """What both do, the other one last."""
        if self.trivial or after.trivial:
            return after if self.trivial else self
        return Linear(after.factor * self.factor, after.factor * self.offset + after.offset)


AS_IS = Linear()


def conversion(
    source: UnitDefinition | None, target: UnitDefinition | None, *, relative: bool = False
) -> tuple[float, float] | None:
    """Factor and offset with target = factor * source + offset; None if there are none.

    Parameters
    ----------
    source, target
        An end without a unit (None) agrees with all.
    relative
        Whether the value is a difference, such as one of temperatures: offsets do not count.
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
    """A unit by name: None if there is no name, a bare name if it has no definition."""
    if not name:
        return None
    return units.get(name) or UnitDefinition(name, None)
