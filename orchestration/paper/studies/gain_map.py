"""C11 as a map: where an algorithm is stable and accurate in two decades of Psi and Gamma."""

from typing import TYPE_CHECKING, Any

from orchestration.campaigns.design.factor import Factor
from orchestration.campaigns.study import Study
from orchestration.paper.claims.criteria import ACCURATE_CONTACT, ACCURATE_FREE, M2_IN_CONTACT
from orchestration.paper.ready import scenario
from orchestration.paper.scenarios import SCENARIOS, UNSATURATED
from orchestration.paper.studies.summary_measure import summary_measure

if TYPE_CHECKING:
    import xarray as xr

GAMMA = "controller.Gamma[2]"
MIDDLE = 100.0  # 1/s, of the values of Psi
CRITERIA = {"e_free": ACCURATE_FREE, "e_contact": ACCURATE_CONTACT, "m2_in_contact": M2_IN_CONTACT}


def gain_map(name: str, n: int = 7) -> Study:
    """The runs of a map without limits of torque: n values of Psi around `MIDDLE`, n of Gamma around the chosen one.

    Parameters
    ----------
    name
        ``fig5`` for algorithm 1, ``fig7`` for algorithm 2.
    n
        Values of each gain, evenly in the logarithm from a tenth to ten times the middle one; 7 are those of C11.

    Examples
    --------
    >>> from orchestration.paper.studies.gain_map import accurate, gain_map
    >>> table = gain_map("fig7", 3).run()
    >>> accurate(table).sizes["Psi"], int(accurate(table).sum())
    (3, 5)
    """
    factors = [10.0 ** ((2 * k - (n - 1)) / (n - 1)) for k in range(n)]
    chosen = SCENARIOS[name].values[GAMMA].number
    study = Study(scenario(name).set(UNSATURATED), measure=summary_measure())
    return study.grid(
        Factor("Psi", "controller.Psi", [MIDDLE * factor for factor in factors]),
        Factor("Gamma", GAMMA, [chosen * factor for factor in factors]),
    )


def accurate(table: "xr.Dataset") -> "xr.DataArray":
    """Whether each run of a map is stable and accurate, as C11 asks; a run that failed is not."""
    found: Any = table["status"] == "complete"
    for measure, criterion in CRITERIA.items():
        found = found & (
            table[measure] < criterion.limit if criterion.comparison == "<" else table[measure] <= criterion.limit
        )
    return found
