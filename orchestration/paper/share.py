"""The share of cases that answer yes, with its confidence.

Source: E. B. Wilson, "Probable inference, the law of succession, and statistical inference", J. Am. Stat. Assoc. 22
(1927).
"""

from dataclasses import dataclass
from math import sqrt

QUANTILE = 1.959963984540054  # of the normal distribution, for 95 %


@dataclass(frozen=True)
class Share:
    """How many of n cases answer yes.

    Attributes
    ----------
    low, high
        Ends of Wilson's confidence interval of the share, at 95 %.
    """

    yes: int
    n: int

    @property
    def value(self) -> float:
        """The share, from 0 to 1; NaN of no case."""
        return self.yes / self.n if self.n else float("nan")

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self._interval()[0]

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self._interval()[1]

    def _interval(self) -> tuple[float, float]:
        if not self.n:
            return 0.0, 1.0
        z2 = QUANTILE**2 / self.n
        middle = (self.value + z2 / 2) / (1 + z2)
        half = QUANTILE / (1 + z2) * sqrt(self.value * (1 - self.value) / self.n + z2 / (4 * self.n))
        return (
            0.0 if self.yes == 0 else middle - half,
            1.0 if self.yes == self.n else middle + half,
        )
