"""The space that the search for a calibration moves in: some of the open values, each as a share of its range."""

from collections.abc import Iterator, Sequence

import numpy as np

from orchestration.paper.calibrations import FIRST, LARGEST, Setting
from orchestration.paper.numbers import LARGEST_PSI, SEMI_AXIS
from orchestration.paper.studies.open_values import OPEN_VALUES, sobol_points

SAMPLE_TIME = 1e-5  # s; with 2e-5 s the chatter of F_c leaves C5 and C6 no room where saturation matters
NOISE_HOLD = 4e-5  # s, a multiple of all sampling periods that are compared
SEARCHED = (
    "noise_ratio",
    "wall_offset",
    "depth",
    "Psi_1",
    "Gamma_1",
    "gamma_margin",
    "gamma_eps",
    "Psi_2",
    "Gamma_2",
    "K_d",
)
"""Values that the search varies. Both joints have one limit of the torque, and the other values are those of the
calibration ``first``."""
DIGITS = 2  # of the values of a candidate; a third digit changes nothing that noise does not
PERTURBATION = 0.05
_BY_NAME = {value.name: value for value in OPEN_VALUES}


def setting_at(shares: np.ndarray) -> Setting:
    """The setting at shares of the ranges of `SEARCHED`, shape (n_searched,), each in [0, 1]."""
    inside = np.clip(shares, 0, np.nextafter(1, 0))
    values = {name: float(_BY_NAME[name].at(share)) for name, share in zip(SEARCHED, inside, strict=True)}
    return {**FIRST.values, "sample_time": SAMPLE_TIME, "noise_hold": NOISE_HOLD, "torque_reading": LARGEST, **values}


def shares_of(setting: Setting) -> np.ndarray:
    """The shares of the ranges at which a setting lies, shape (n_searched,)."""
    return np.array([_share(name, setting[name]) for name in SEARCHED])


def rounded(setting: Setting) -> Setting:
    """A setting with few digits: the wall in mm, the depth in half mm, a hold of the noise in whole ticks."""
    found = {name: _round(value) for name, value in setting.items()}
    ticks = max(1, round(setting["noise_hold"] / setting["sample_time"]))
    return {
        **found,
        "noise_share": setting["noise_share"],
        "noise_hold": float(f"{ticks * setting['sample_time']:.6g}"),
        "wall_offset": round(setting["wall_offset"], 3),
        "depth": round(2000 * setting["depth"]) / 2000,
    }


def perturbed(setting: Setting, n: int) -> Iterator[Setting]:
    """Settings of which every continuous value differs by up to 5 %: the first n Sobol points of this box.

    Of the wall it is the distance that the ellipse would reach behind it which differs by up to 5 %: the wall's own
    distance from the origin says nothing about how long the contact lasts.
    """
    names = [value.name for value in OPEN_VALUES if not value.choices]
    for row in sobol_points(n, len(names)):
        factors = 1 + PERTURBATION * (2 * row - 1)
        found = dict(setting)
        for name, factor in zip(names, factors.tolist(), strict=True):
            behind = SEMI_AXIS[0] - setting["wall_offset"]
            found[name] = SEMI_AXIS[0] - behind * factor if name == "wall_offset" else setting[name] * factor
        found["Psi_1"] = min(found["Psi_1"], np.nextafter(LARGEST_PSI, 0))
        yield found


def starts(near: Sequence[Setting], anywhere: int, around: int, width: float) -> np.ndarray:
    """Points to start from, as shares, shape (n, n_searched): given settings, Sobol points around them, and anywhere.

    Parameters
    ----------
    anywhere, around
        Number of Sobol points in the whole space, and around each of the given settings.
    width
        Width of the box around a setting, as a share of each range.
    """
    given = np.array([shares_of(setting) for setting in near])
    box = sobol_points(around, len(SEARCHED)) - 0.5
    boxes = [np.clip(middle + width * box, 0, 1) for middle in given]
    return np.vstack([given, *boxes, sobol_points(anywhere, len(SEARCHED))])


def _share(name: str, number: float) -> float:
    value = _BY_NAME[name]
    if value.choices:
        return (value.choices.index(number) + 0.5) / len(value.choices)
    return float(np.clip(value.share_of(number), 0, 1))


def _round(number: float) -> float:
    return float(f"{number:.{DIGITS}g}")
