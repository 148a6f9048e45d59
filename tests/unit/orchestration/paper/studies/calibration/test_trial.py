"""The runs of a setting: a chain of bounds and limits, and sketches that agree with whole runs."""

import numpy as np
import pytest

from orchestration.paper.calibrate import laboratory, noise_bound, torque_limits
from orchestration.paper.calibrations import CHOSEN_CALIBRATION, FIRST, LARGEST
from orchestration.paper.studies.calibration.trial import Bench
from orchestration.paper.studies.native_runs import NativeLaboratory

# The chosen gains of F_c need a period of 1e-5 s, so the coarse runs have those of the earlier calibration.
COARSE = {**FIRST.values, "sample_time": 5e-5, "noise_hold": 5e-5, "torque_reading": LARGEST}


@pytest.fixture(scope="module")
def natives() -> NativeLaboratory:
    return NativeLaboratory(laboratory().fmus)


def test_constants_are_those_of_the_calibration(natives: NativeLaboratory) -> None:
    """The same numbers as those of the scenarios' runs by the master, but for the digits that are kept of the bound."""
    bench = Bench(natives, CHOSEN_CALIBRATION.values)
    assert bench.noise_bound() == noise_bound(natives)
    limits = bench.torque_limits(CHOSEN_CALIBRATION.noise_bound)
    assert limits.tolist() == list(torque_limits(natives))


def test_a_sketch_has_the_free_motion_of_whole_runs_and_other_noise(natives: NativeLaboratory) -> None:
    bench = Bench(natives, COARSE)
    whole, sketch = bench.trial([1, 2]), bench.sketch([1, 2])
    assert sketch.noise_bound == whole.noise_bound
    assert sketch.torque_limits.tolist() == whole.torque_limits.tolist()
    assert sketch.fixed_mass.e_start == whole.fixed_mass.e_start
    for figure in ("fig5", "fig6", "fig7"):
        for one, other in zip(sketch.runs[figure], whole.runs[figure], strict=True):
            for name in ("m2_settled", "m2_at_contact", "e_start", "e_free"):
                assert getattr(one, name) == getattr(other, name), name
            # The noise has other draws, so what it decides agrees in size alone.
            assert one.e_contact != other.e_contact
            assert 1 / 3 < one.e_contact / other.e_contact < 3
            assert 1 / 3 < one.m2_fluctuation / other.m2_fluctuation < 3
    assert (np.abs(sketch.runs["fig7"][0].torque / whole.runs["fig7"][0].torque - 1) < 0.3).all()


def test_limits_are_those_of_the_first_seed(natives: NativeLaboratory) -> None:
    found = Bench(natives, COARSE).trial([1])
    largest = found.runs["fig5"][0].torque
    np.testing.assert_array_equal(found.torque_limits, 0.75 * largest.max())
