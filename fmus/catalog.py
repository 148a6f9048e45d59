"""The catalog of the project's models, by model identifier: `MODELS`, and `VARIANTS` of them that a user names."""

from collections.abc import Callable
from functools import partial

from adaptimp_fmu import Model
from fmus.actuator import actuator
from fmus.craig_adaptive_impedance import craig_adaptive_impedance
from fmus.force_sensor import force_sensor
from fmus.hogan_impedance import MOBILITY, hogan_impedance
from fmus.plant import plant
from fmus.robots.planar_robot import PlanarRobot
from fmus.slotine_li_adaptive_impedance import slotine_li_adaptive_impedance
from fmus.spong_ortega_adaptive_impedance import spong_ortega_adaptive_impedance
from fmus.virtual_trajectory import virtual_trajectory

_POSE = PlanarRobot(3, pose=True)

MODELS: dict[str, Callable[[], Model]] = {
    "VirtualTrajectory": virtual_trajectory,
    "ForceSensor": force_sensor,
    "HoganImpedance": hogan_impedance,
    "CraigAdaptiveImpedance": craig_adaptive_impedance,
    "SlotineLiAdaptiveImpedance": slotine_li_adaptive_impedance,
    "SpongOrtegaAdaptiveImpedance": spong_ortega_adaptive_impedance,
    "Actuator": actuator,
    "Plant": plant,
    "HoganImpedance3R": partial(hogan_impedance, PlanarRobot(3), "HoganImpedance3R"),
    "Actuator3R": partial(actuator, 3, "Actuator3R"),
    "Plant3R": partial(plant, PlanarRobot(3), "Plant3R"),
}

_CRAIG, _SLOTINE_LI, _SPONG_ORTEGA = (
    "CraigAdaptiveImpedanceFull",
    "SlotineLiAdaptiveImpedanceFull",
    "SpongOrtegaAdaptiveImpedanceFull",
)
_CRAIG_POSE, _SLOTINE_LI_POSE, _SPONG_ORTEGA_POSE = (
    "CraigAdaptiveImpedance3RPose",
    "SlotineLiAdaptiveImpedance3RPose",
    "SpongOrtegaAdaptiveImpedance3RPose",
)
_NO_CORIOLIS = "SlotineLiAdaptiveImpedanceNoCoriolis"
VARIANTS: dict[str, Callable[[], Model]] = {
    "FailingForceSensor": partial(force_sensor, "FailingForceSensor", failing=True),
    "PlantCorner": partial(plant, name="PlantCorner", walls=2),
    "VirtualTrajectoryCorner": partial(virtual_trajectory, "VirtualTrajectoryCorner", 2),
    "PlantWristPayload": partial(plant, name="PlantWristPayload", wrist=True),
    "HoganImpedanceMobility": partial(hogan_impedance, name="HoganImpedanceMobility", form=MOBILITY),
    "HoganImpedanceFull": partial(hogan_impedance, name="HoganImpedanceFull", full=True),
    _CRAIG: partial(craig_adaptive_impedance, _CRAIG, full=True),
    _SLOTINE_LI: partial(slotine_li_adaptive_impedance, _SLOTINE_LI, full=True),
    _SPONG_ORTEGA: partial(spong_ortega_adaptive_impedance, _SPONG_ORTEGA, full=True),
    _NO_CORIOLIS: partial(slotine_li_adaptive_impedance, _NO_CORIOLIS, coriolis_of_s=False),
    "VirtualTrajectoryPose": partial(virtual_trajectory, "VirtualTrajectoryPose", task=_POSE.task),
    "ForceSensorPose": partial(force_sensor, "ForceSensorPose", _POSE.task),
    "HoganImpedance3RPose": partial(hogan_impedance, _POSE, "HoganImpedance3RPose"),
    _CRAIG_POSE: partial(craig_adaptive_impedance, _CRAIG_POSE, _POSE),
    _SLOTINE_LI_POSE: partial(slotine_li_adaptive_impedance, _SLOTINE_LI_POSE, _POSE),
    _SPONG_ORTEGA_POSE: partial(spong_ortega_adaptive_impedance, _SPONG_ORTEGA_POSE, _POSE),
    "Plant3RPose": partial(plant, _POSE, "Plant3RPose"),
}
"""Models with other equations than those of the same name in `MODELS`; built when a user names them."""


def model(identifier: str) -> Model:
    """Declare the model of an identifier in `MODELS` or `VARIANTS`.

    Raises
    ------
    KeyError
        If neither has it.
    """
    return (MODELS | VARIANTS)[identifier]()
