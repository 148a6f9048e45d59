"""Three FMUs as another tool might have written them: a motor, an elastic shaft, and a pump that counts in rpm.

uv run python -m tests.scenarios.drive FOLDER    writes Motor.fmu, Shaft.fmu and Pump.fmu
"""

import math
import re
import sys
import zipfile
from pathlib import Path

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, ContinuousModel, build

RPM = math.pi / 30  # rad/s


def motor() -> ContinuousModel:
    """A motor whose torque is given, on a rotor with friction."""
    model = ContinuousModel("Motor", "A rotor with a torque that is given", dt_max=1e-3)
    J = model.parameter("J", 0.1, unit="kg.m2", limits=POSITIVE, description="Inertia of the rotor")
    d = model.parameter("d", 0.01, unit="N.m.s/rad", limits=NOT_NEGATIVE, description="Friction", tunable=True)
    T_set = model.input("T_set", 0.0, unit="N.m", description="Torque of the motor")
    T_load = model.input("T_load", 0.0, unit="N.m", description="Torque of the shaft on the rotor")
    phi, w = model.state("phi", 0.0), model.state("w", 0.0)
    model.derivative(phi, w)
    model.derivative(w, (T_set + T_load - d * w) / J)
    model.output("phi", phi, unit="rad", description="Angle")
    model.output("w", w, unit="rad/s", description="Angular velocity")
    return model


def shaft() -> ContinuousModel:
    """A shaft that is a spring with a damper."""
    model = ContinuousModel("Shaft", "An elastic shaft")
    c = model.parameter("c", 500.0, unit="N.m/rad", limits=POSITIVE, description="Stiffness")
    d = model.parameter("d", 0.02, unit="N.m.s/rad", limits=NOT_NEGATIVE, description="Damping")
    ends = [(model.input(f"phi_{end}", 0.0, unit="rad", description=f"Angle of end {end}")) for end in "AB"]
    rates = [(model.input(f"w_{end}", 0.0, unit="rad/s", description=f"Rate of end {end}")) for end in "AB"]
    T = c * (ends[1] - ends[0]) + d * (rates[1] - rates[0])
    model.output("T_A", T, unit="N.m", description="Torque on what turns end A")
    model.output("T_B", -T, unit="N.m", description="Torque on what turns end B")
    return model


def pump() -> ContinuousModel:
    """A pump whose torque grows with the square of its speed, and which must not run above its limit."""
    model = ContinuousModel("Pump", "A pump that counts its speed in rpm", dt_max=1e-3)
    J = model.parameter("J", 0.2, unit="kg.m2", limits=POSITIVE, description="Inertia of the wheel")
    k = model.parameter("k", 1e-3, unit="N.m.s2/rad2", limits=NOT_NEGATIVE, description="Torque over speed squared")
    n_max = model.parameter("n_max", 900.0, unit="rad/s", limits=POSITIVE, description="Highest speed allowed")
    T = model.input("T", 0.0, unit="N.m", description="Torque of the shaft")
    phi, w = model.state("phi", 0.0), model.state("w", 0.0)
    model.derivative(phi, w)
    model.derivative(w, (T - k * w * ca.fabs(w)) / J)
    model.output("phi", phi, unit="rad", description="Angle")
    model.output("n", w / RPM, unit="rad/s", description="Speed")
    model.require(n_max - w / RPM, "the pump runs too fast")
    return model


def in_rpm(fmu: Path) -> None:
    """Declare that all angular velocities of an FMU, whose numbers are in rpm already, have the unit rpm."""
    with zipfile.ZipFile(fmu) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    text = entries["modelDescription.xml"].decode().replace('"rad/s"', '"rpm"')
    scaled = re.sub(r'(<Unit name="rpm">\s*<BaseUnit [^/]*)/>', rf'\1 factor="{RPM!r}"/>', text)
    assert scaled != text
    with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in {**entries, "modelDescription.xml": scaled.encode()}.items():
            archive.writestr(name, content)


def write(folder: Path) -> None:
    """Write the three FMUs."""
    build(motor(), folder)
    build(shaft(), folder)
    in_rpm(build(pump(), folder))


if __name__ == "__main__":
    write(Path(sys.argv[1]))
