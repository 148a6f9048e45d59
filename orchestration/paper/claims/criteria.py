"""What each claim must meet, as data: a quantity, a comparison, a limit and its unit, each once.

Verdicts, the prose of ``docs/claims.md`` and the choice of the open values (`orchestration.paper.calibrate`)
read the limits here. All of them were fixed before the claims were measured.
"""

import operator
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from orchestration.paper.measure import RECOVERED, SETTLED
from orchestration.paper.numbers import N_STATES, TARGET_STIFFNESS, TIP_START, TORQUE_SHARE, TRUE_M2

_COMPARE = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
SCALED = ("mm", "N")
"""Units of limits that go with the size and the stiffness of a task."""
SHOWN_PER_SI = {"mm": 1e3, "%": 1e2}  # units that people read better, in what the numbers are kept in


@dataclass(frozen=True)
class Criterion:
    """A limit of a measured quantity.

    Attributes
    ----------
    quantity
        What is measured.
    comparison
        ``"<"``, ``"<="``, ``">"`` or ``">="``.
    limit
        In SI units.
    unit
        The unit in which the limit is shown: an SI unit, mm or %; empty for a plain number.
    beyond
        Another measured quantity from which the limit counts; then the difference of both is what is compared.
    why
        Where the limit comes from.
    """

    quantity: str
    comparison: str
    limit: float
    unit: str = ""
    beyond: str = ""
    why: str = ""

    def met(self, values: float | Sequence[float] | np.ndarray) -> bool:
        """Whether every value keeps the limit, in SI units; NaN does not, nor does an empty list."""
        found = np.asarray(values, dtype=float)
        return bool(found.size and np.all(_COMPARE[self.comparison](found, self.limit)))

    def share(self, values: float | Sequence[float] | np.ndarray) -> float:
        """The largest value over the limit."""
        return float(np.max(np.asarray(values, dtype=float)) / self.limit)

    def scaled(self, factor: float) -> "Criterion":
        """The criterion for an arm on which lengths and forces are so many times those of the paper's arm."""
        if factor == 1 or self.unit not in SCALED:
            return self
        return replace(self, limit=factor * self.limit, why=f"{factor:g} of the limit of the paper's arm")

    def margin(self, values: float | Sequence[float] | np.ndarray) -> str:
        """The worst of measured values beside the limit, such as ``worst 0.158 of <= 1 mm``; empty without a value."""
        found = np.asarray(values, dtype=float)
        if not found.size:
            return ""
        worst = found.max() if self.comparison.startswith("<") else found.min()
        factor = SHOWN_PER_SI.get(self.unit, 1.0)
        return f"worst {worst * factor:.4g} of {self.comparison} {self.limit * factor:.4g} {self.unit}".rstrip()

    def __str__(self) -> str:
        """The criterion as a phrase, such as ``|e| <= 1 mm``."""
        limit = f"{self.limit * SHOWN_PER_SI.get(self.unit, 1.0):.4g} {self.unit}".rstrip()
        if self.beyond:
            limit = f"{self.beyond} + {limit}" if self.limit else self.beyond
        return f"{self.quantity} {self.comparison} {limit}{f' ({self.why})' if self.why else ''}"


_M2 = f"|m2_hat - {TRUE_M2:g} kg|"
_RATIO = "lower end of the 95 % interval of the median ratio of"
_START = f"({TIP_START[0]:g}, {TIP_START[1]:g})"

# Conventional control and the TIRT.
TIRT_BEFORE_CONTACT = Criterion("|x_t - x_v| before the first contact", "<=", 1e-5, "mm")
TIRT_GROWTH = Criterion("ratio of the largest |x_t - x_v| after the first contact to the largest before", ">=", 100.0)
TIRT_AT_END = Criterion("|x_t - x_v| when contact ends", "<=", 1e-3, "mm", why=f"{TARGET_STIFFNESS * 1e-3:g} N by K")
TRUE_MASS_ERROR = Criterion("|e|", "<=", 1e-3, "mm")
SLIDE_ENDS = Criterion("distances of the first contact from a and of the last from b", "<=", 0.05, "mm")
BOUNCES = Criterion("number of bounces", "<=", 2.0, why="the wall is elastic")
SLIDE_SHARE = Criterion("share of the contact in which the tip touches", ">=", 2 / 3, "%", why="two thirds")
END = Criterion(f"distance from {_START} at the end", "<=", 1e-3, "mm")
WRONG_MASS_ERROR = Criterion("largest |e|", ">=", 5e-3, "mm", why=f"{TARGET_STIFFNESS * 5e-3:g} N by K")
WRONG_MASS_GROWTH = Criterion("ratio of the largest |e| to that of Fig. 2", ">=", 10.0)
WRONG_MASS_FORCE = Criterion(
    "larger of the ratios of peak and steady force to those of Fig. 2", ">=", 1.1, why="a difference that one can see"
)

# Adaptive control.
M2_SETTLED = Criterion(
    f"time from which {_M2} <= {SETTLED:g} kg until contact", "<=", 0.46, "s", why="about half of the free motion"
)
M2_AT_CONTACT = Criterion(f"{_M2} at the first contact", "<=", 0.05, "kg")
M2_IN_CONTACT = Criterion(f"{_M2} from first to last contact", "<", 0.2, "kg")
M2_FLUCTUATION = Criterion(
    "median range of m2_hat from first to last contact",
    ">=",
    0.05,
    "kg",
    why="2 % of the 2.5 kg that panel (b) shows",
)
M2_RECOVERY = Criterion(f"time after the last contact from which {_M2} <= {RECOVERED:g} kg for good", "<=", 0.1, "s")
BOUNDED_ERROR = Criterion("|e|", "<=", 5e-3, "mm")
SATURATED_ERROR = Criterion(f"{_RATIO} |e| in contact to that without saturation", ">", 1.0)
SATURATED_FORCE = Criterion(f"{_RATIO} the force error to that without saturation", ">", 1.0)
CLEARLY_LARGER = Criterion(
    "median ratio of an error in contact to that of Fig. 5", ">=", 1.1, why="a difference that one can see"
)
TORQUE_RATIO = Criterion("median ratio of each joint's largest torques", "<=", TORQUE_SHARE)
TORQUE_WITHIN = Criterion("median of each joint's largest command", "<=", 0.0, "N.m", "the limit of Fig. 6")
START_ERROR = Criterion("|e| during the first free motion", "<=", 5e-3, "mm")
FIXED_MASS_RATIO = Criterion(
    "ratio of |e| during the first free motion to that without adaptation", "<=", 0.5, why="adaptation halves it"
)
FREE_ERROR = Criterion("|e| in the second half of the first free motion", "<=", 1e-4, "mm")
LARGER_ERROR = Criterion(f"{_RATIO} |e| in contact to that of algorithm 1", ">", 1.0)
SLIGHTLY_LARGER_ERROR = Criterion(
    "median |e| in contact", "<=", 5e-4, "mm", "that of algorithm 1", why=f"{TARGET_STIFFNESS * 5e-4:g} N by K"
)
LARGER_FORCE = Criterion(f"{_RATIO} the force error to that of algorithm 1", ">", 1.0)
SLIGHTLY_LARGER_FORCE = Criterion(
    "median force error", "<=", 30.0, "N", "that of algorithm 1", why="5 % of an impact of 600 N"
)

# Sensitivity and cost.
ACCURATE_FREE = Criterion("|e| in the second half of the first free motion", "<=", 1e-3, "mm")
ACCURATE_CONTACT = Criterion("|e| in contact", "<=", 1e-3, "mm")
STABLE = (BOUNDED_ERROR, END)
ACCURATE = (ACCURATE_FREE, ACCURATE_CONTACT, M2_IN_CONTACT)
MORE_STABLE_RUNS = Criterion("number of stable runs of algorithm 2", ">", 0.0, beyond="that of algorithm 1")
MORE_ACCURATE_RUNS = Criterion(
    "number of stable and accurate runs of algorithm 2", ">", 0.0, beyond="that of algorithm 1"
)
FEWER_SIMPLE = Criterion("simple operations per tick of algorithm 2", "<", 0.0, beyond="those of algorithm 1")
FEWER_COSTLY = Criterion("costly operations per tick of algorithm 2", "<", 0.0, beyond="those of algorithm 1")
SLOW_UPDATE_ERROR = Criterion("|e| in contact at a lower rate", "<=", 1e-4, "mm", "twice that at the full rate")

# Equations and Lyapunov functions.
CRAIG_GROWTH = Criterion("largest V_c in contact over V_c at the first contact", "<=", 1.0)
CRAIG_ORDER = Criterion(
    "order in the sampling period at which the rises of V_c outside beta < eps/sqrt(margin - 1) fall", ">=", 1.0
)
RISE = Criterion("rises of V_s where |s| >= delta/k_d, relative to V_s(0)", "<=", 0.01, "%")
RMS = Criterion("ratio of rms(s) to delta/k_d + sqrt(V_s(0)/(k_d T))", "<=", 1.0)
FALLS_WITH_GAIN = Criterion("ratio of the largest |s| from contact on to that at the next smaller K_d", "<", 1.0)
ERROR_BOUND = Criterion("ratio of |e| to |e0| + sup|s|/psi", "<=", 1.0)
FORMS = Criterion(f"relative differences at {N_STATES} random states", "<=", 1e-10)
CASE_C = Criterion("number of ticks in case (c)", ">=", 1.0)
GAMMA = Criterion("ratio of (2 mu delta - alpha)/beta^2 to gamma* at every tick in case (c)", "<=", 1 + 1e-9)
SKEW = Criterion(f"symmetric part relative to the norm at {N_STATES} random states", "<=", 1e-10)

# Saturation, (27) and (28). V_c falls outside of the region (28) names; a sampled law may rise by as much as V_s may.
SATURATION_BOUND = Criterion(
    "rises of V_c beyond the time integral of (28) while saturated, relative to V_c(0)", "<=", 0.01, "%"
)
RISES_OUTSIDE = Criterion("number of saturated ticks outside of the region of (28) at which V_c rises", "<=", 0.0)
SATURATED_ENERGY = Criterion("ratio of the largest V_c from the first saturation on to V_c(0)", "<=", 1.0)
ENERGY_AT_END = Criterion("V_c at the end, relative to V_c(0)", "<=", 0.01, "%")

# The computations of section IV-B.
INVERSE_DYNAMICS = Criterion(
    "relative difference of the recursion and the Lagrangian equations at random states", "<=", 1e-10
)
NO_CORIOLIS_ERROR = Criterion("|e| in contact without C_x s", "<=", 1e-4, "mm", "twice that with it")
NO_CORIOLIS_FORCE = Criterion(
    "median force error without C_x s", "<=", 30.0, "N", "that with it", why="5 % of an impact of 600 N"
)

# A sensor that fails, and torques far too small, IV-A.
FAILURE_GROWTH = Criterion("share of runs in which |e| exceeds that of the healthy run", ">", 0.5, why="likely")
FAILURE_ERROR = Criterion(
    "|e| from the contact on", "<=", 50e-3, "mm", why="ten times what a run without a failure may have"
)
FAILURE_END = Criterion("|e| at the end", "<=", 1e-3, "mm")
