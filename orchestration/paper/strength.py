"""How strongly each claim holds: shares of the space of open values and of the seeds, and the values that decide.

The numbers are those of the studies in `orchestration.paper.studies.robustness`, which writes them to the data file of
this package. Measuring them takes about an hour, so they come with the package.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.paper.calibrations import Calibration
from orchestration.paper.share import Share

NAME = "strength.json"
"""Name of the data file, in the folder ``data`` of the package `orchestration.paper`."""

LEAST_SHARE = 0.05
"""Share of the space from which a claim that holds at the calibration is said to hold."""


def strength_word(holds: bool, space: Share) -> str:
    """What is said of a claim: its verdict at the calibration and its share of the space in one phrase.

    Examples
    --------
    >>> from orchestration.paper.share import Share
    >>> from orchestration.paper.strength import strength_word
    >>> strength_word(True, Share(2, 100)), strength_word(False, Share(2, 100))
    ('holds at the calibration only', 'fails here, holds elsewhere')
    """
    if holds:
        return "holds" if space.value >= LEAST_SHARE else "holds at the calibration only"
    return "fails here, holds elsewhere" if space.yes else "holds nowhere in the space searched"


@dataclass(frozen=True)
class ClaimStrength:
    """How strongly one claim holds.

    Attributes
    ----------
    space
        Settings of the open values at which the claim holds; None if it was not judged there.
    seeds
        Seeds of the noise at which the claim holds, by the name of a calibration; each seed is judged alone.
    deciding
        Names of the open values that decide most, each with its first-order index, the largest first.
    """

    space: Share | None = None
    seeds: Mapping[str, Share] = field(default_factory=dict)
    deciding: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Effect:
    """How much larger a quantity is in one figure than in another with the same noise.

    Attributes
    ----------
    median, low, high
        Median of the ratio over the seeds, and ends of its confidence interval at 95 %.
    larger
        Share of the seeds at which the ratio is above 1.
    """

    median: float
    low: float
    high: float
    larger: Share


@dataclass(frozen=True)
class Strength:
    """How strongly the claims hold.

    Attributes
    ----------
    settings
        Number of settings of the open values.
    seeds
        Number of seeds, by the name of a calibration.
    claims
        By claim.
    effects
        By the name of a calibration, and by what is compared, such as ``fig6/fig5 e_contact``.
    calibrations
        Numbers of the calibrations that the seeds were judged at, by name, as `Calibration.numbers` gives them.
    """

    settings: int
    seeds: Mapping[str, int]
    claims: Mapping[str, ClaimStrength]
    effects: Mapping[str, Mapping[str, Effect]]
    calibrations: Mapping[str, Mapping[str, float]]

    def stale(self, present: Mapping[str, Calibration]) -> list[str]:
        """Names of the calibrations whose seeds were judged at other numbers than those of today.

        Parameters
        ----------
        present
            The calibrations of today, by name.
        """
        return [
            name
            for name in self.seeds
            if name not in present or dict(self.calibrations[name]) != dict(present[name].numbers)
        ]

    def at(self, present: Mapping[str, Calibration]) -> "Strength":
        """The same without what was measured over seeds at other numbers than those of the calibrations of today."""
        kept = self.seeds.keys() - self.stale(present)
        claims = {
            claim: replace(one, seeds={name: share for name, share in one.seeds.items() if name in kept})
            for claim, one in self.claims.items()
        }
        return replace(
            self,
            seeds={name: n for name, n in self.seeds.items() if name in kept},
            claims=claims,
            effects={name: found for name, found in self.effects.items() if name in kept},
        )

    def write(self, path: Path) -> None:
        """Write the numbers as JSON."""
        write_whole(path, f"{json.dumps(asdict(self), indent=1)}\n".encode())

    @classmethod
    def read(cls, text: str) -> "Strength":
        """The numbers from JSON."""
        record = json.loads(text)
        claims = {name: _claim(one) for name, one in record["claims"].items()}
        effects = {
            calibration: {name: effect_from(one) for name, one in found.items()}
            for calibration, found in record["effects"].items()
        }
        return cls(record["settings"], record["seeds"], claims, effects, record["calibrations"])


def read_strength() -> Strength:
    """How strongly the claims hold, from the data of the package.

    Examples
    --------
    >>> from orchestration.paper.strength import read_strength
    >>> found = read_strength().claims["C13"].space
    >>> found.yes, found.value
    (0, 0.0)
    """
    return Strength.read((files("orchestration.paper") / "data" / NAME).read_text(encoding="utf-8"))


def effect_from(record: Mapping[str, Any]) -> Effect:
    """An effect from the values that JSON has of it."""
    return Effect(**{**record, "larger": Share(**record["larger"])})


def _claim(record: Mapping[str, Any]) -> ClaimStrength:
    space = record["space"]
    return ClaimStrength(
        None if space is None else Share(**space),
        {name: Share(**one) for name, one in record["seeds"].items()},
        tuple((name, index) for name, index in record["deciding"]),
    )
