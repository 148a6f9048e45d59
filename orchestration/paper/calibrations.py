"""Calibrations: named sets of values for everything that the paper leaves open in Figs. 2 to 7.

A calibration gives every open value one number, and one calibration serves all figures. The chosen one is
``section-v``, which docs/calibration.md explains. The earlier one, ``first``, is kept with its results.
The table of what is open, with ranges and reasons, is `orchestration.paper.studies.open_values`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

Setting = Mapping[str, float]
"""A number for each open value, by name; units are those of the table of open values."""

EACH_JOINT, LARGEST, NORM = 0.0, 1.0, 2.0
"""Readings of "75 % of the maximum torque": of each joint's own largest torque, one limit for both joints from the
largest torque of either, or one limit for both from the largest Euclidean norm."""


@dataclass(frozen=True)
class Calibration:
    """A value for everything that the paper leaves open, and the two constants that follow from runs.

    Attributes
    ----------
    name
        Name of the set.
    values
        Number of each open value, by name.
    noise_bound
        Bound of the sensor's error, N: a share of the largest |F_ext| of fig5 without noise.
    torque_limits
        Limits of the actuators in Figs. 6 and 7, N.m, from fig5 with noise.
    """

    name: str
    values: Setting
    noise_bound: float
    torque_limits: tuple[float, float]

    @property
    def numbers(self) -> Mapping[str, float]:
        """All numbers of the calibration, by name: two calibrations with the same ones give the same runs."""
        limits = {f"torque_limit_{joint}": limit for joint, limit in enumerate(self.torque_limits, start=1)}
        return {**self.values, "noise_bound": self.noise_bound, **limits}


_SIMPLEST: Setting = {
    "noise_share": 0.15,
    "contact_gated": 1.0,
    "acc_filter_time": 1e-4,
    "D_f": 0.0,
    "mu": 0.0,
    "starts_moving": 1.0,
    "elbow": 1.0,
}

FIRST = Calibration(
    "first",
    MappingProxyType(
        {
            **_SIMPLEST,
            "sample_time": 2e-5,
            "noise_hold": 2e-5,
            "noise_ratio": 3.0,
            "wall_offset": 1.45,
            "depth": 10e-3,
            "Psi_1": 100.0,
            "Gamma_1": 5.0,
            "gamma_margin": 1.5,
            "gamma_eps": 1e-4,
            "torque_reading": EACH_JOINT,
            "Psi_2": 100.0,
            "Gamma_2": 4.0,
            "K_d": 100.0,
        }
    ),
    noise_bound=91.12,
    torque_limits=(533.61, 306.83),
)
"""The earlier calibration: one value after the other was chosen for C4, C5, C6, C8 and C9."""

CHOSEN_CALIBRATION = Calibration(
    "section-v",
    MappingProxyType(
        {
            **_SIMPLEST,
            "sample_time": 1e-5,
            "noise_hold": 4e-5,
            "noise_ratio": 4.0,
            "wall_offset": 1.436,
            "depth": 15e-3,
            "Psi_1": 97.0,
            "Gamma_1": 6.2,
            "gamma_margin": 2.1,
            "gamma_eps": 2.2e-4,
            "torque_reading": LARGEST,
            "Psi_2": 52.0,
            "Gamma_2": 19.0,
            "K_d": 47.0,
        }
    ),
    noise_bound=103.91,
    torque_limits=(549.44, 549.44),
)
"""The calibration of the scenarios: chosen for all sentences of Section V."""

CALIBRATIONS: Mapping[str, Calibration] = {one.name: one for one in (CHOSEN_CALIBRATION, FIRST)}
"""The calibrations by name."""
