"""Evidence for PlantWristPayload: Newton's law beyond the wrist sensor, and the bits of Plant."""

from collections.abc import Callable

import numpy as np
import pytest

from orchestration.fmi.codes import Status
from tests.driver import Driver
from tests.variant_files import file_of

Open = Callable[..., Driver]
H = 1e-3  # s
GRAVITY, PAYLOAD = 9.81, 0.4  # m/s2, kg
# The tip starts in the wall, so that F_ext is not zero.
START = {"q_start[1]": -0.7, "q_start[2]": 1.4, "dq_start[1]": 2.0, "dq_start[2]": -1.0, "gravity": GRAVITY}
IN_WALL = {**START, "wall_normal[1]": 1.0, "wall_offset": 1.52, "tau[1]": 20.0, "tau[2]": -5.0}
OUTPUTS = [f"{name}[{i}]" for name in ("q", "dq", "ddq", "x", "dx", "F_ext") for i in (1, 2)]
VECTORS = ("q", "dq", "ddq", "F_ext", "F_wrist")


def rows(plant: Driver, start: dict[str, float], names: list[str]) -> np.ndarray:
    """Outputs after initialization and after each of twenty steps, shape (21, len(names))."""
    plant.initialize(IN_WALL | start)
    found = [plant.get(*names)]
    for k in range(20):
        plant.step(k * H, H)
        found.append(plant.get(*names))
    return np.array(found)


def test_without_a_payload_it_is_the_plant(open_fmu: Open) -> None:
    heavy = open_fmu(file_of("PlantWristPayload"))
    names = [*OUTPUTS, "F_wrist[1]", "F_wrist[2]"]
    found = rows(heavy, {}, names)
    np.testing.assert_array_equal(found[:, :12], rows(open_fmu("Plant"), {}, OUTPUTS))
    np.testing.assert_array_equal(found[:, 12:], found[:, 10:12])
    assert np.abs(found[:, 10]).max() > 10  # N: the tip touched the wall


def test_a_payload_does_not_change_the_motion(open_fmu: Open) -> None:
    found = rows(open_fmu(file_of("PlantWristPayload")), {"payload": PAYLOAD}, OUTPUTS)
    np.testing.assert_array_equal(found, rows(open_fmu("Plant"), {}, OUTPUTS))


def test_the_wrist_carries_the_payload(open_fmu: Open) -> None:
    names = [f"{name}[{i}]" for name in VECTORS for i in (1, 2)]
    found = rows(open_fmu(file_of("PlantWristPayload")), {"payload": PAYLOAD}, names)
    q, dq, ddq, F_ext, F_wrist = (found[:, 2 * k : 2 * k + 2] for k in range(len(VECTORS)))
    angle, rate, turn = q.cumsum(axis=1), dq.cumsum(axis=1), ddq.cumsum(axis=1)  # of links of 1 m
    along = np.stack([np.cos(angle), np.sin(angle)], axis=2)
    across = np.stack([-np.sin(angle), np.cos(angle)], axis=2)
    ddx = (turn[:, :, None] * across - rate[:, :, None] ** 2 * along).sum(axis=1)
    # Newton: the wrist pushes the payload, the wall and gravity push it back.
    expected = F_ext + PAYLOAD * (ddx + np.array([0.0, GRAVITY]))
    # Accelerations reach 1e3 m/s2; a hundred roundings of them.
    np.testing.assert_allclose(F_wrist, expected, rtol=0, atol=1e-11)
    assert np.abs(F_wrist - F_ext).max() > 1


@pytest.mark.parametrize(("payload", "accepted"), [(1.0, True), (1.0 + 1e-9, False)])
def test_a_payload_is_part_of_the_last_mass(open_fmu: Open, payload: float, accepted: bool) -> None:
    plant = open_fmu(file_of("PlantWristPayload"))
    plant.set({"payload": payload})
    plant.enter()
    status = plant.instance.status("fmi2ExitInitializationMode")
    assert status == (Status.OK if accepted else Status.ERROR)
    assert accepted or any("payload must be at most the last element of m" in text for text in plant.messages)
