"""The catalog of the project's models, by model identifier: `MODELS`, and `VARIANTS` of them that a user names.

A model is imported when it is declared. So the names are known where CasADi, which the equations need, is not.
"""

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from adaptimp_fmu.files.parts import imported

if TYPE_CHECKING:
    from adaptimp_fmu import Model
    from fmus.robots.spatial_robot import SpatialRobot


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


UNITS_OF_ARM = {
    "VirtualTrajectory": "spatial_trajectory",
    "ForceSensor": "wrench_sensor",
    "HoganImpedance": "hogan_impedance",
    "CraigAdaptiveImpedance": "craig_adaptive_impedance",
    "SlotineLiAdaptiveImpedance": "slotine_li_adaptive_impedance",
    "SpongOrtegaAdaptiveImpedance": "spong_ortega_adaptive_impedance",
    "Actuator": "actuator",
    "Plant": "plant",
}
"""The modules that declare the models of an arm in space, by what the names of these models begin with."""


def unit_of_arm(unit: str, robot: "SpatialRobot", suffix: str) -> "Model":
    """Declare a model of an arm in space.

    Parameters
    ----------
    unit
        One of `UNITS_OF_ARM`.
    suffix
        What the name of the model ends with: ``Puma560`` for ``PlantPuma560``.

    Raises
    ------
    DefinitionError
        If the model cannot be for this arm, as a law that inverts J for an arm of seven joints.
    """
    module = UNITS_OF_ARM[unit]
    known = {"joints": robot.joints} if module == "actuator" else {"robot": robot}
    return _declared(module, name=f"{unit}{suffix}", **known)


def _of_puma(unit: str) -> "Model":
    """The model for the PUMA 560, an arm of six joints in space."""
    return unit_of_arm(unit, imported("fmus.robots.puma560").PUMA, "Puma560")


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
    **{f"{unit}Puma560": partial(_of_puma, unit) for unit in UNITS_OF_ARM},
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
