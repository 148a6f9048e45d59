"""Each row of a campaign is the run that `simulate` makes, bit for bit, whichever engine made the row."""

from pathlib import Path

import numpy as np
import pytest

from orchestration import Study
from orchestration.campaigns import running
from orchestration.campaigns.engines.native import NativeEngine
from tests.unit.orchestration.campaigns.plain import PlainEngine
from tests.unit.orchestration.runs import SAMPLE_TIME, paper

ROWS = 200
STEPS = 24
FACTORS = {
    "plant.K_f": "1e3:1e6 log",
    "plant.m[2]": "normal(1, 0.1)",
    "plant.mu": "0:0.3",
    "controller.K": "1000:6000",
    "sensor.noise_std": "0:40",
    "sensor.seed": range(1, 1000),
    "sample_time": [SAMPLE_TIME, SAMPLE_TIME / 2],
    "plant.wall_normal[1]": [-1.0, -0.5],  # one of them is no unit vector, so that its runs fail
}
MEASURES = [
    "max(norm(plant.F_ext))",
    "rms(norm(controller.e), where=norm(plant.F_ext) > 0)",
    "integral(abs(actuator.tau[1]))",
    "time_of_max(plant.penetration)",
    "final(controller.p_hat[2]) - initial(controller.p_hat[2])",
]


@pytest.fixture
def study(fmu_folder: Path) -> Study:
    """Two hundred random points of the noisy loop of Fig. 7, in contact."""
    study = Study(paper(fmu_folder, "fig7"), MEASURES, stop_time=STEPS * SAMPLE_TIME)
    return study.samples(FACTORS, n=ROWS, method="latin-hypercube", seed=15)


@pytest.mark.filterwarnings("ignore::orchestration.DifferentWallsWarning")  # one of the walls is wrong on purpose
def test_rows_are_those_of_simulate(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "engine_for", NativeEngine)
    table = study.run(workers=2)
    monkeypatch.setattr(running, "engine_for", PlainEngine)
    plain = study.run(workers=2)
    assert (table["status"] == plain["status"]).all()
    assert set(table["status"]) == {"complete", "failed"}
    names = list(study.units)
    assert table[names].to_numpy().tobytes() == plain[names].to_numpy().tobytes()
    failed = table["status"] == "failed"
    assert table.loc[failed, "message"].str.contains("wall_normal").all()
    assert table.loc[failed, "message"].tolist() == plain.loc[failed, "message"].tolist()
    assert np.unique(table[names[0]].dropna()).size > ROWS / 4  # the points are no copies of each other
