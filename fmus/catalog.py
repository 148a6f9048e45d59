"""The units that exist, by model identifier."""

from collections.abc import Callable

from adaptimp_fmu import Model
from fmus.actuator import actuator
from fmus.force_sensor import force_sensor
from fmus.hogan_impedance import hogan_impedance
from fmus.plant import plant
from fmus.virtual_trajectory import virtual_trajectory

UNITS: dict[str, Callable[[], Model]] = {
    "VirtualTrajectory": virtual_trajectory,
    "ForceSensor": force_sensor,
    "HoganImpedance": hogan_impedance,
    "Actuator": actuator,
    "Plant": plant,
}
