"""Physical units, and what a number in one of them is in another.

A unit says how its numbers become numbers in SI base units (FMI 2.0.4, 2.2.2; SSP 1.0, 4.4.2):

    base value = factor * value + offset
"""

from collections.abc import Mapping
from dataclasses import dataclass

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
UNCHANGED = (1.0, 0.0)


@dataclass(frozen=True)
class UnitDefinition:
    """A physical unit: exponents of the SI base units, factor and offset to them.

    Attributes
    ----------
    exponents
        Those that are not zero, in the order of `BASE_UNITS`; None if nothing but the name is known.
    """

    name: str
    exponents: tuple[tuple[str, int], ...] | None = ()
    factor: float = 1.0
    offset: float = 0.0

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
    if source.exponents is None or target.exponents is None:
        return UNCHANGED if source.name == target.name else None
    if source.exponents != target.exponents:
        return None
    same_offset = relative or source.offset == target.offset
    if source.factor == target.factor and same_offset:
        return UNCHANGED
    offset = 0.0 if relative else (source.offset - target.offset) / target.factor
    return source.factor / target.factor, offset


def defined(name: str | None, units: Mapping[str, UnitDefinition]) -> UnitDefinition | None:
    """A unit by name: None if there is no name, a bare name if it has no definition."""
    if not name:
        return None
    return units.get(name) or UnitDefinition(name, None)
