"""The values that the paper leaves open for Figs. 2 to 7, each with a plausible range and the reason for it.

A *setting* gives each of them a value. `settings` fills the space of all settings evenly with Sobol points. What is
assumed without a range stands in `FIXED`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from orchestration.paper.calibrations import CHOSEN_CALIBRATION, EACH_JOINT, FIRST, LARGEST, NORM, Setting

SOBOL_SEED = 1991
ADAPTIVE = "all of Figs. 5 to 7"
ALGORITHM_1, ALGORITHM_2 = "C4 to C8, C10 to C14, C16, C17, C19, C20", "C4 to C6, C8 to C12, C14, C19"


@dataclass(frozen=True)
class OpenValue:
    """A value that the paper leaves open.

    Attributes
    ----------
    name
        Its name in a setting.
    unit
        Physical unit; empty for a plain number.
    low, high
        Ends of the plausible range.
    reason
        Why the range is plausible.
    claims
        Claims that the value takes part in, as text.
    log
        Whether the range is filled evenly in the logarithm.
    choices
        The values that are possible, if they are not a range; `low` and `high` are then their ends. A value that stands
        here several times has a larger share of the settings.
    """

    name: str
    unit: str
    low: float
    high: float
    reason: str
    claims: str
    log: bool = False
    choices: tuple[float, ...] = ()

    @property
    def chosen(self) -> float:
        """The value in the scenarios."""
        return CHOSEN_CALIBRATION.values[self.name]

    def at(self, share: np.ndarray) -> np.ndarray:
        """The values at shares of the range, each in [0, 1)."""
        if self.choices:
            return np.array(self.choices)[(share * len(self.choices)).astype(int)]
        if self.log:
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share

    def share_of(self, value: float) -> float:
        """The share of the range at which a value lies; the inverse of `at` for a range."""
        if self.log:
            return float(np.log(value / self.low) / np.log(self.high / self.low))
        return (value - self.low) / (self.high - self.low)


def _choice(name: str, unit: str, choices: tuple[float, ...], texts: tuple[str, str]) -> OpenValue:
    return OpenValue(name, unit, min(choices), max(choices), *texts, choices=choices)


OPEN_VALUES = (
    _choice(
        "sample_time",
        "s",
        (1e-4, 5e-5, 2e-5, 1e-5),
        (
            "10 kHz is fast for the controller of a robot, and 100 kHz is practically continuous for F_c",
            ADAPTIVE,
        ),
    ),
    OpenValue(
        "noise_hold",
        "s",
        1e-5,
        1e-3,
        "a draw of the noise is held for this time, rounded to a whole number of ticks: from noise that is white at the"
        " control rate to a force sensor of about 1 kHz",
        ADAPTIVE,
        log=True,
    ),
    OpenValue(
        "noise_share",
        "",
        0.12,
        0.18,
        'the bound of the noise over the peak force; the paper says "about 15 %"',
        ADAPTIVE,
    ),
    OpenValue(
        "noise_ratio",
        "",
        2.0,
        5.0,
        "the bound of the noise over its standard deviation; the largest of the draws of one contact lies at two to"
        " five standard deviations",
        ADAPTIVE,
    ),
    _choice(
        "contact_gated",
        "",
        (1.0, 1.0, 1.0, 0.0),
        (
            "1, in three of four settings: no noise without contact, as in the free motion of the figures; 0: a real"
            " sensor is always noisy",
            ADAPTIVE,
        ),
    ),
    OpenValue(
        "wall_offset",
        "m",
        1.38,
        1.46,
        'the ellipse ends at 1.5 m; the contact then lasts 0.15 to 0.26 s of 2 s ("a small segment")',
        "all",
    ),
    OpenValue(
        "depth",
        "m",
        5e-3,
        25e-3,
        "the steady force of the segment, K depth, is then 20 to 100 N",
        "all",
    ),
    OpenValue(
        "Psi_1",
        "1/s",
        20.0,
        165.0,
        "algorithm 1 needs less than B/M = 170 1/s, eq. (14); below 20 1/s an error outlives the contact",
        ALGORITHM_1,
        log=True,
    ),
    OpenValue(
        "Gamma_1",
        "kg2.s2/m2",
        0.5,
        50.0,
        "a decade to either side of the value of the calibration `first`",
        ALGORITHM_1,
        log=True,
    ),
    OpenValue(
        "gamma_margin",
        "",
        1.0,
        4.0,
        "eq. (25) asks for more than 1; four times as much needs four times the force",
        ALGORITHM_1,
        log=True,
    ),
    OpenValue(
        "gamma_eps",
        "m/s",
        1e-5,
        1e-2,
        "the boundary layer of F_c: from practically none to the size of e* itself",
        ALGORITHM_1,
        log=True,
    ),
    _choice(
        "torque_reading",
        "",
        (EACH_JOINT, LARGEST, NORM),
        (
            '"75 % of the maximum torque", read as 0: each joint has 75 % of its own largest torque; 1: both have 75 %'
            " of the larger one; 2: both have 75 % of the largest norm of the two torques",
            "C4 to C10, C19, C20",
        ),
    ),
    OpenValue(
        "Psi_2",
        "1/s",
        20.0,
        300.0,
        "as Psi_1, and algorithm 2 has no upper limit",
        ALGORITHM_2,
        log=True,
    ),
    OpenValue(
        "Gamma_2",
        "kg.s2/m2",
        0.5,
        50.0,
        "about a decade to either side of the value of the calibration `first`",
        ALGORITHM_2,
        log=True,
    ),
    OpenValue(
        "K_d",
        "N.s/m",
        10.0,
        1000.0,
        "a decade to either side of the value of the calibration `first`",
        ALGORITHM_2,
        log=True,
    ),
    OpenValue(
        "acc_filter_time",
        "s",
        5e-5,
        5e-4,
        "the filter on the acceleration that the variant with a fixed inverse needs; several times longer is slower"
        " than the impact, shorter lets the loop diverge",
        "C16",
        log=True,
    ),
    _choice(
        "D_f",
        "s/m",
        (0.0, 0.0, 0.1, 0.3),
        (
            "0, in half of the settings: the paper names a stiffness alone; else the damping of the wall per rate of"
            " penetration, with which an impact at 1 m/s keeps about 93 % or 80 % of its speed, as on metal",
            "all",
        ),
    ),
    _choice(
        "mu",
        "",
        (0.0, 0.0, 0.1, 0.3),
        (
            "0, in half of the settings: the paper names no friction; else the coefficient of friction along the wall,"
            " of greased and of dry metal",
            "all",
        ),
    ),
    _choice(
        "starts_moving",
        "",
        (1.0, 1.0, 1.0, 0.0),
        (
            "1, in three of four settings: the tip starts with the velocity of the virtual trajectory, as the errors"
            " of the figures start at zero; 0: it starts at rest, as the paper states only the place",
            "all",
        ),
    ),
    _choice(
        "elbow",
        "",
        (1.0, -1.0),
        ("the sign of the elbow's angle q2; both put the tip at (1.5, 0)", "all"),
    ),
)
"""Values with a plausible range, in the order of the dimensions of the Sobol points."""

CHOSEN: Setting = CHOSEN_CALIBRATION.values
"""The setting of the scenarios."""

EARLIER: Setting = MappingProxyType(
    {
        **FIRST.values,
        "sample_time": 1e-5,
        "noise_hold": 6e-5,
        "noise_ratio": 4.0,
        "wall_offset": 1.43,
        "depth": 15e-3,
        "Psi_1": 86.0,
        "Gamma_1": 9.8,
        "gamma_margin": 2.7,
        "gamma_eps": 6e-4,
        "torque_reading": LARGEST,
        "Psi_2": 42.0,
        "Gamma_2": 7.6,
        "K_d": 73.0,
    }
)
"""A setting that independent code has found by optimization, for C4 to C10."""


def settings(n: int) -> Mapping[str, np.ndarray]:
    """The first n Sobol points of the space of settings, each value with shape (n,).

    The points are scrambled with a fixed seed. A longer sequence begins with the points of a shorter one.
    """
    shares = sobol_points(n, len(OPEN_VALUES))
    return {value.name: value.at(shares[:, i]) for i, value in enumerate(OPEN_VALUES)}


def settings_near(setting: Setting, n: int, width: float) -> Mapping[str, np.ndarray]:
    """The first n Sobol points of a box around a setting, each value with shape (n,).

    Parameters
    ----------
    width
        Width of the box, as a share of each range; the box ends where a range ends. Choices stay as they are.
    """
    shares = sobol_points(n, len(OPEN_VALUES))
    found = {}
    for i, value in enumerate(OPEN_VALUES):
        if value.choices:
            found[value.name] = np.full(n, setting[value.name])
        else:
            middle = value.share_of(setting[value.name])
            found[value.name] = value.at(np.clip(middle + width * (shares[:, i] - 0.5), 0, 1))
    return found


def sobol_points(n: int, dimensions: int) -> np.ndarray:
    """The first n Sobol points of the unit cube, shape (n, dimensions), the same on every machine."""
    from scipy.stats import qmc

    sobol = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(SOBOL_SEED))
    return sobol.random_base2(max(n - 1, 0).bit_length())[:n]


def setting_at(points: Mapping[str, np.ndarray], number: int) -> Setting:
    """One setting of many, by its number from 0 on."""
    return {name: float(values[number]) for name, values in points.items()}
