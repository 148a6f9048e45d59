"""The ready studies by name, for the command line."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from orchestration.campaigns.study import Study
from orchestration.paper.studies.claims_at import SCENARIOS
from orchestration.paper.studies.gain_map import gain_map
from orchestration.paper.studies.payload import payload_and_wall
from orchestration.paper.studies.robustness import laboratory
from orchestration.paper.studies.seeds import seeds_study
from orchestration.paper.studies.tuning import GAINS, gains_study

FINE = 25  # values of each gain in a fine map
MANY = 256  # points of the space of gains


@dataclass(frozen=True)
class ReadyStudy:
    """A study that needs no further choice.

    Attributes
    ----------
    summary
        What it is, in one line.
    make
        Makes the study, and builds its FMUs if they are not there.
    """

    summary: str
    make: Callable[[], Study]


def _seeds(name: str) -> Study:
    return seeds_study(name, laboratory())


def _gains() -> Study:
    return gains_study().samples({name: f"{low:g}:{high:g} log" for name, (low, high) in GAINS.items()}, n=MANY)


READY_STUDIES: Mapping[str, ReadyStudy] = {
    "gains-1": ReadyStudy("C11: algorithm 1 at 7 x 7 values of Psi and Gamma", partial(gain_map, "fig5")),
    "gains-2": ReadyStudy("C11: algorithm 2 at 7 x 7 values of Psi and Gamma", partial(gain_map, "fig7")),
    "gains-1-fine": ReadyStudy(f"the same of algorithm 1 at {FINE} x {FINE} values", partial(gain_map, "fig5", FINE)),
    "gains-2-fine": ReadyStudy(f"the same of algorithm 2 at {FINE} x {FINE} values", partial(gain_map, "fig7", FINE)),
    **{
        f"seeds-{name}": ReadyStudy(f"1,000 seeds of the noise in {name}, for C4 to C10 and C16", partial(_seeds, name))
        for name in SCENARIOS
    },
    "payload": ReadyStudy("payloads of 0.5 to 5 kg and walls of 1e3 to 1e6 N/m, both algorithms", payload_and_wall),
    "gains-of-fig7": ReadyStudy(f"{MANY} points of the space of Psi, Gamma and K_d of algorithm 2", _gains),
}
