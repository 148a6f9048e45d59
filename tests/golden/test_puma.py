"""The run ``puma`` has the bits of the last release: a hash for each group of its columns."""

import hashlib
import json
from collections.abc import Callable

from orchestration import simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.spatial_numbers import FIRST_OF_PAYLOAD, TEN
from orchestration.paper.spatial_scenarios import SPATIAL

GROUPS = {
    "joints": [f"plant.{name}[{i}]" for name in ("q", "dq") for i in range(1, 7)],
    "wrench": [f"{name}[{i}]" for name in ("plant.F_ext", "sensor.F_hat") for i in range(1, 7)],
    "torques": [f"{name}[{i}]" for name in ("controller.tau_cmd", "actuator.tau") for i in range(1, 7)],
    "payload": [f"controller.p_hat[{i}]" for i in range(FIRST_OF_PAYLOAD, FIRST_OF_PAYLOAD + TEN)],
}


def test_the_run_keeps_its_bits(assert_golden: Callable[[str, str], None]) -> None:
    scenario = SPATIAL["puma"]
    columns = [column for group in GROUPS.values() for column in group]
    result = simulate(scenario.system(fmus(scenario.models.values())), record=columns)
    found = {
        name: hashlib.sha256(b"".join(result[column].astype("<f8").tobytes() for column in group)).hexdigest()
        for name, group in GROUPS.items()
    }
    assert_golden("puma.json", f"{json.dumps(found, indent=2)}\n")
