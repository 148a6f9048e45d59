"""Both algorithms with payloads of 0.5 to 5 kg against walls of 1e3 to 1e6 N/m."""

from orchestration.campaigns.design.factor import Factor
from orchestration.campaigns.study import Study
from orchestration.paper.ready import scenario
from orchestration.paper.scenarios import UNSATURATED

LINK = 0.5  # kg at the end of the second link, without the payload; V
LIGHTEST, HEAVIEST = 0.5, 5.0  # kg
SOFTEST, HARDEST = 1e3, 1e6  # N/m
MEASURES = ("peak_force", "max_e_contact", "m2_at_contact", "m2_in_contact", "end_error")


def payload_and_wall(n: int = 10) -> Study:
    """The runs of both algorithms over n payloads and n stiffnesses of the wall, without limits of torque.

    The estimate of the second mass starts at the 2.5 kg of the paper. The second mass is the payload and `LINK`.

    Examples
    --------
    >>> from orchestration.paper.studies.payload import payload_and_wall
    >>> table = payload_and_wall(2).run()
    >>> table["K_f"].values.tolist(), table["m2"].values.tolist()
    ([1000.0, 1000000.0], [1.0, 5.5])
    >>> bool((table["peak_force"].sel(K_f=1e6) > table["peak_force"].sel(K_f=1e3)).all())
    True
    """
    systems = {name: scenario(name).set(UNSATURATED) for name in ("fig5", "fig7")}
    masses = f"{LIGHTEST + LINK:g}:{HEAVIEST + LINK:g}:{n}"
    return Study(systems, measure=MEASURES).grid(
        Factor("m2", "plant.m[2]", masses), {"plant.K_f": f"{SOFTEST:g}:{HARDEST:g}:{n}log"}
    )
