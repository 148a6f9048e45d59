"""What the calibration rests on, as one JSON file: the search, the calibrations put to the proof, and further runs."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.paper.studies.calibration.keeping import Proof
from orchestration.paper.studies.calibration.search import Found


@dataclass(frozen=True)
class Period:
    """A sampling period and what m2_hat does in contact there, over some seeds.

    Attributes
    ----------
    period
        The sampling period, s.
    failed
        Number of runs that fail.
    low, high
        Ends of the range of m2_hat's deviation in contact, kg; NaN if all runs fail.
    """

    period: float
    failed: int
    low: float
    high: float


@dataclass(frozen=True)
class Nudges:
    """How far tiny changes of the start move the torque limits of Fig. 6.

    Attributes
    ----------
    runs
        Number of runs.
    largest
        Largest change of the first angle, rad.
    moved
        Largest relative change of each joint's limit, shape (2,).
    """

    runs: int
    largest: float
    moved: tuple[float, float]


@dataclass(frozen=True)
class Record:
    """What docs/calibration.md shows.

    Attributes
    ----------
    found
        What the search has found.
    proofs
        The calibrations, put to the proof, by name.
    periods
        Sampling periods that were compared.
    nudges
        The torque limits after tiny changes of the start.
    """

    found: Found
    proofs: Mapping[str, Proof]
    periods: tuple[Period, ...]
    nudges: Nudges

    def write(self, path: Path) -> None:
        """Write the record as JSON."""
        write_whole(path, f"{json.dumps(asdict(self), indent=1)}\n".encode())

    @classmethod
    def read(cls, path: Path) -> "Record":
        """Read a record."""
        given = json.loads(path.read_text(encoding="utf-8"))
        found = given["found"]
        nudges = given["nudges"]
        return cls(
            found=Found(
                **{
                    **found,
                    "first_costs": tuple(found["first_costs"]),
                    "proofs": tuple(_proof(proof) for proof in found["proofs"]),
                }
            ),
            proofs={name: _proof(proof) for name, proof in given["proofs"].items()},
            periods=tuple(Period(**period) for period in given["periods"]),
            nudges=Nudges(**{**nudges, "moved": tuple(nudges["moved"])}),
        )


def _proof(given: Mapping[str, Any]) -> Proof:
    return Proof(**{**given, "torque_limits": tuple(given["torque_limits"])})
