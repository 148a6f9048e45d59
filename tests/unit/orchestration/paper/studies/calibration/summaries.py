"""Trials with known numbers."""

from dataclasses import replace

import numpy as np

from orchestration.paper.measure import Summary
from orchestration.paper.studies.calibration.trial import Trial

GOOD = Summary(
    m2_settled=0.23,
    m2_at_contact=0.025,
    m2_in_contact=0.1,
    m2_fluctuation=0.1,
    m2_recovery=0.05,
    torque=np.array([100.0, 50.0]),
    e_start=2.5e-3,
    e_free=5e-5,
    e_contact=1e-4,
    e_contact_rms=1e-5,
    e_max=2.5e-3,
    force_error=10.0,
    end=5e-4,
)
RATIOS = (1.1, 1.2, 1.3)


def trial(**changes: float) -> Trial:
    """A trial of three seeds at which all sentences hold; the changes are those of Fig. 7."""
    larger = [replace(GOOD, e_contact=ratio * GOOD.e_contact, force_error=ratio * GOOD.force_error) for ratio in RATIOS]
    two = [replace(one, **{"torque": np.array([60.0, 30.0]), **changes}) for one in larger]
    runs = {"fig5": [GOOD] * 3, "fig6": larger, "fig7": two, "spong-ortega": [GOOD]}
    return Trial(runs, replace(GOOD, e_start=1e-2), 90.0, np.array([75.0, 37.5]))
