"""The catalog of the project's models, by model identifier: `MODELS`, and `VARIANTS` of them that a user names.

A model is imported when it is declared. So the names are known where CasADi, which the equations need, is not.
"""

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from adaptimp_fmu.files.parts import imported

if TYPE_CHECKING:
    from adaptimp_fmu import Model


def _declared(module: str, *arguments: Any, **options: Any) -> "Model":
    """The model that the function of a module's name declares."""
    return getattr(imported(f"fmus.{module}"), module)(*arguments, **options)


def _of_arm(module: str, name: str, *, pose: bool = False) -> "Model":
    """The model for a planar arm with three joints, whose task is a position, or also an angle."""
    robot = imported("fmus.robots.planar_robot").PlanarRobot(3, pose=pose)
    return _declared(module, name=name, robot=robot)


def _of_pose(module: str, name: str) -> "Model":
    """The model for a task of position and angle."""
    task = imported("fmus.robots.planar_robot").PlanarRobot(3, pose=True).task
    return _declared(module, name=name, task=task)


def _of_puma(module: str, name: str) -> "Model":
    """The model for the PUMA 560, an arm of six joints in space."""
    robot = imported("fmus.robots.puma560").PUMA
    return _declared(module, name=name, robot=robot)


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

MODELS: "dict[str, Callable[[], Model]]" = {
    "VirtualTrajectory": partial(_declared, "virtual_trajectory"),
    "ForceSensor": partial(_declared, "force_sensor"),
    "HoganImpedance": partial(_declared, "hogan_impedance"),
    "CraigAdaptiveImpedance": partial(_declared, "craig_adaptive_impedance"),
    "SlotineLiAdaptiveImpedance": partial(_declared, "slotine_li_adaptive_impedance"),
    "SpongOrtegaAdaptiveImpedance": partial(_declared, "spong_ortega_adaptive_impedance"),
    "Actuator": partial(_declared, "actuator"),
    "Plant": partial(_declared, "plant"),
    "HoganImpedance3R": partial(_of_arm, "hogan_impedance", "HoganImpedance3R"),
    "Actuator3R": partial(_declared, "actuator", 3, "Actuator3R"),
    "Plant3R": partial(_of_arm, "plant", "Plant3R"),
}

VARIANTS: "dict[str, Callable[[], Model]]" = {
    "FailingForceSensor": partial(_declared, "force_sensor", "FailingForceSensor", failing=True),
    "PlantCorner": partial(_declared, "plant", name="PlantCorner", walls=2),
    "VirtualTrajectoryCorner": partial(_declared, "virtual_trajectory", "VirtualTrajectoryCorner", 2),
    "PlantWristPayload": partial(_declared, "plant", name="PlantWristPayload", wrist=True),
    "HoganImpedanceMobility": partial(_declared, "hogan_impedance", name="HoganImpedanceMobility", form="mobility"),
    "HoganImpedanceFull": partial(_declared, "hogan_impedance", name="HoganImpedanceFull", full=True),
    _CRAIG: partial(_declared, "craig_adaptive_impedance", _CRAIG, full=True),
    _SLOTINE_LI: partial(_declared, "slotine_li_adaptive_impedance", _SLOTINE_LI, full=True),
    _SPONG_ORTEGA: partial(_declared, "spong_ortega_adaptive_impedance", _SPONG_ORTEGA, full=True),
    _NO_CORIOLIS: partial(_declared, "slotine_li_adaptive_impedance", _NO_CORIOLIS, coriolis_of_s=False),
    "VirtualTrajectoryPose": partial(_of_pose, "virtual_trajectory", "VirtualTrajectoryPose"),
    "ForceSensorPose": partial(_of_pose, "force_sensor", "ForceSensorPose"),
    "HoganImpedance3RPose": partial(_of_arm, "hogan_impedance", "HoganImpedance3RPose", pose=True),
    _CRAIG_POSE: partial(_of_arm, "craig_adaptive_impedance", _CRAIG_POSE, pose=True),
    _SLOTINE_LI_POSE: partial(_of_arm, "slotine_li_adaptive_impedance", _SLOTINE_LI_POSE, pose=True),
    _SPONG_ORTEGA_POSE: partial(_of_arm, "spong_ortega_adaptive_impedance", _SPONG_ORTEGA_POSE, pose=True),
    "Plant3RPose": partial(_of_arm, "plant", "Plant3RPose", pose=True),
    "VirtualTrajectoryPuma560": partial(_of_puma, "spatial_trajectory", "VirtualTrajectoryPuma560"),
    "ForceSensorPuma560": partial(_of_puma, "wrench_sensor", "ForceSensorPuma560"),
    "HoganImpedancePuma560": partial(_of_puma, "hogan_impedance", "HoganImpedancePuma560"),
    "CraigAdaptiveImpedancePuma560": partial(_of_puma, "craig_adaptive_impedance", "CraigAdaptiveImpedancePuma560"),
    "SlotineLiAdaptiveImpedancePuma560": partial(
        _of_puma, "slotine_li_adaptive_impedance", "SlotineLiAdaptiveImpedancePuma560"
    ),
    "SpongOrtegaAdaptiveImpedancePuma560": partial(
        _of_puma, "spong_ortega_adaptive_impedance", "SpongOrtegaAdaptiveImpedancePuma560"
    ),
    "ActuatorPuma560": partial(_declared, "actuator", 6, "ActuatorPuma560"),
    "PlantPuma560": partial(_of_puma, "plant", "PlantPuma560"),
}
"""Models with other equations than those of the same name in `MODELS`."""


def model(identifier: str) -> "Model":
    """Declare the model of an identifier in `MODELS` or `VARIANTS`.

    Raises
    ------
    KeyError
        If neither has it.

    Examples
    --------
    >>> from fmus.catalog import MODELS, model
    >>> len(MODELS), model("Plant").description
    (11, 'Planar arm with point masses against a compliant wall')
    """
    return (MODELS | VARIANTS)[identifier]()
