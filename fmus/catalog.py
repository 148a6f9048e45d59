"""The catalog of the project's models, by model identifier."""

from collections.abc import Callable
from functools import partial

from adaptimp_fmu import Model
from fmus.actuator import actuator
from fmus.craig_adaptive_impedance import craig_adaptive_impedance
from fmus.force_sensor import force_sensor
from fmus.hogan_impedance import hogan_impedance
from fmus.plant import plant
from fmus.slotine_li_adaptive_impedance import slotine_li_adaptive_impedance
from fmus.spong_ortega_adaptive_impedance import spong_ortega_adaptive_impedance
from fmus.virtual_trajectory import virtual_trajectory

MODELS: dict[str, Callable[[], Model]] = {
    "VirtualTrajectory": virtual_trajectory,
    "ForceSensor": force_sensor,
    "HoganImpedance": hogan_impedance,
    "CraigAdaptiveImpedance": craig_adaptive_impedance,
    "SlotineLiAdaptiveImpedance": slotine_li_adaptive_impedance,
    "SpongOrtegaAdaptiveImpedance": spong_ortega_adaptive_impedance,
    "Actuator": actuator,
    "Plant": plant,
    "HoganImpedance3R": partial(hogan_impedance, 3, "HoganImpedance3R"),
    "Actuator3R": partial(actuator, 3, "Actuator3R"),
    "Plant3R": partial(plant, 3, "Plant3R"),
}
