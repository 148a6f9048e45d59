"""Five systems as people share them, each with one fault, as SSP packages of small FMUs.

uv run python -m tests.scenarios.clinic FOLDER    writes the packages
"""

import re
import sys
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import casadi as ca

from adaptimp_fmu import POSITIVE, ContinuousModel, Model, SampledModel, build
from orchestration import System


def room() -> ContinuousModel:
    """A heated room: C dT/dt = P - (T - T_out) / R."""
    model = ContinuousModel("Room", "A room with a heater and walls", dt_max=10.0)
    C = model.parameter("C", 1e5, unit="J/K", limits=POSITIVE, description="Heat capacity")
    R = model.parameter("R", 0.01, unit="K/W", limits=POSITIVE, description="Resistance of the walls")
    T_out = model.parameter("T_out", 0.0, unit="K", description="Temperature outside")
    P = model.input("P", 0.0, unit="W", description="Heating power")
    T = model.state("T", ca.SX(15.0))
    model.derivative(T, (P - (T - T_out) / R) / C)
    model.output("T", T, unit="K", description="Temperature", scalar=True)
    return model


def thermostat() -> ContinuousModel:
    """A heater whose power is proportional to what is missing."""
    model = ContinuousModel("Thermostat", "A proportional thermostat")
    T = model.input("T", 288.0, unit="K", description="Temperature of the room")
    T_set = model.parameter("T_set", 293.15, unit="K", description="Wanted temperature")
    k = model.parameter("k", 500.0, unit="W/K", limits=POSITIVE, description="Gain")
    model.output("P", k * (T_set - T), unit="W", description="Heating power", scalar=True)
    return model


def in_celsius(fmu: Path) -> None:
    """Declare that the temperature of the room, whose numbers are in degC already, is in degC and a difference."""
    _patch(
        fmu,
        (r'(<ScalarVariable name="T" .*?<Real [^>]*?)unit="K"', r'\1unit="degC" relativeQuantity="true"'),
        (r'(<Unit name="K">.*?</Unit>)', r'\1<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>'),
    )


def _patch(fmu: Path, *changes: tuple[str, str]) -> None:
    with zipfile.ZipFile(fmu) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    text = entries["modelDescription.xml"].decode()
    for pattern, replacement in changes:
        changed = re.sub(pattern, replacement, text, count=1, flags=re.DOTALL)
        assert changed != text, pattern
        text = changed
    with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in {**entries, "modelDescription.xml": text.encode()}.items():
            archive.writestr(name, content)


def thermal(folder: Path) -> System:
    """A room in degC, declared as a difference, before a thermostat in K, declared as an absolute value."""
    fmus = {"room": build(room(), folder), "thermostat": build(thermostat(), folder)}
    in_celsius(fmus["room"])
    return _system("thermal", fmus, ("room.T -> thermostat.T", "thermostat.P -> room.P"), 10.0, 3600.0)


def dc_motor() -> ContinuousModel:
    """A direct-current motor: L di/dt = u - R i - K w, J dw/dt = K i - d w."""
    model = ContinuousModel("DcMotor", "A direct-current motor", dt_max=1e-3)
    names = (
        ("R", 1.0, "W/A2"),
        ("L", 5e-3, "W.s/A2"),
        ("K", 0.05, "N.m/A"),
        ("J", 1e-4, "kg.m2"),
        ("d", 1e-5, "N.m.s/rad"),
    )
    R, L, K, J, d = (
        model.parameter(name, value, unit=unit, limits=POSITIVE, description=name) for name, value, unit in names
    )
    u = model.input("u", 0.0, unit="W/A", description="Voltage")
    i, w = model.state("i", ca.SX(0)), model.state("w", ca.SX(0))
    model.derivative(i, (u - R * i - K * w) / L)
    model.derivative(w, (K * i - d * w) / J)
    model.output("i", i, unit="A", description="Current", scalar=True)
    model.output("w", w, unit="rad/s", description="Speed", scalar=True)
    return model


def speed_controller() -> SampledModel:
    """A digital PI controller of a speed."""
    model = SampledModel("SpeedController", "A PI controller", sample_time=5e-3)
    w = model.input("w", 0.0, unit="rad/s", description="Measured speed")
    w_set = model.parameter("w_set", 100.0, unit="rad/s", description="Wanted speed")
    k_p = model.parameter("k_p", 0.05, unit="W.s/A.rad", description="Proportional gain")
    k_i = model.parameter("k_i", 0.02, unit="W.s/A.rad", description="Gain of the sum, for each tick")
    total = model.state("total", ca.SX(0))
    model.update(total, total + w_set - w)
    model.output("u", k_p * (w_set - w) + k_i * total, unit="W/A", description="Voltage", scalar=True)
    return model


def amplifier() -> SampledModel:
    """A digital amplifier with a limited voltage."""
    model = SampledModel("Amplifier", "An amplifier", sample_time=5e-3)
    u = model.input("u_cmd", 0.0, unit="W/A", description="Wanted voltage")
    u_max = model.parameter("u_max", 24.0, unit="W/A", limits=POSITIVE, description="Largest voltage")
    model.output("u_amp", ca.fmin(ca.fmax(u, -u_max), u_max), unit="W/A", description="Voltage", scalar=True)
    return model


DRIVE = ("controller.u -> amplifier.u_cmd", "amplifier.u_amp -> motor.u", "motor.w -> controller.w")


def drive(folder: Path) -> System:
    """A motor with a digital controller, whose amplifier steps before the controller that feeds it."""
    models = {"amplifier": amplifier, "controller": speed_controller, "motor": dc_motor}
    return _system("drive", _built(models, folder), DRIVE, 5e-3, 0.5)


def sampled(folder: Path) -> System:
    """The same drive in the right order, with a step that does not divide the sampling period."""
    models = {"controller": speed_controller, "amplifier": amplifier, "motor": dc_motor}
    return _system("sampled", _built(models, folder), DRIVE, 2e-3, 0.5)


def body() -> ContinuousModel:
    """A quarter of a car's body on its spring and damper."""
    model = ContinuousModel("CarBody", "A quarter of a car's body", dt_max=1e-3)
    m = model.parameter("m", 300.0, unit="kg", limits=POSITIVE, description="Mass")
    k = model.parameter("k", 2e4, unit="N/m", limits=POSITIVE, description="Stiffness of the spring")
    d = model.parameter("d", 1.5e3, unit="N.s/m", limits=POSITIVE, description="Damping")
    z_w = model.input("z_w", 0.0, unit="m", description="Height of the wheel")
    v_w = model.input("v_w", 0.0, unit="m/s", description="Velocity of the wheel")
    z, v = model.state("z", ca.SX(0)), model.state("v", ca.SX(0))
    F = k * (z_w - z) + d * (v_w - v)
    model.derivative(z, v)
    model.derivative(v, F / m)
    model.output("z", z, unit="m", description="Height of the body", scalar=True)
    model.output("F", F, unit="N", description="Force on the body", scalar=True)
    return model


def wheel() -> ContinuousModel:
    """A wheel whose tyre is far too stiff, on a road with a step."""
    model = ContinuousModel("Wheel", "A wheel on a road", dt_max=1e-3)
    m = model.parameter("m", 40.0, unit="kg", limits=POSITIVE, description="Mass")
    k_t = model.parameter("k_t", 2e5, unit="N/m", limits=POSITIVE, description="Stiffness of the tyre")
    z_r = model.parameter("z_r", 0.05, unit="m", description="Height of the road")
    F = model.input("F", 0.0, unit="N", description="Force of the wheel on the body")
    z, v = model.state("z", ca.SX(0)), model.state("v", ca.SX(0))
    model.derivative(z, v)
    model.derivative(v, (k_t * (z_r - z) - F) / m)
    model.output("z", z, unit="m", description="Height of the wheel", scalar=True)
    model.output("v", v, unit="m/s", description="Velocity of the wheel", scalar=True)
    return model


def quarter_car(folder: Path) -> System:
    """A quarter car whose tyre swings faster than the sub-steps of the wheel can follow."""
    wires = ("wheel.z -> body.z_w", "wheel.v -> body.v_w", "body.F -> wheel.F")
    system = _system("quarter car", _built({"body": body, "wheel": wheel}, folder), wires, 1e-3, 1.0)
    return system.set({"wheel.k_t": 4e7})


def tank() -> ContinuousModel:
    """A tank with a lossy neck: its pressure follows the flow at once."""
    model = ContinuousModel("Tank", "A tank with a neck", dt_max=0.1)
    h_start = model.parameter("h_start", 1.0, unit="m", description="Level at the start")
    A = model.parameter("A", 0.1, unit="m2", limits=POSITIVE, description="Area")
    R = model.parameter("R", 2e5, unit="N.s/m5", limits=POSITIVE, description="Resistance of the neck")
    q = model.input("q", 0.0, unit="m3/s", description="Flow out of the tank")
    h = model.state("h", h_start)
    model.derivative(h, -q / A)
    model.output("p", 9810 * h - R * q, unit="N/m2", description="Pressure behind the neck", scalar=True)
    return model


def pipe() -> ContinuousModel:
    """A pipe without inertia: its flow follows the pressures at once."""
    model = ContinuousModel("Pipe", "A pipe between two tanks")
    R = model.parameter("R", 1e6, unit="N.s/m5", limits=POSITIVE, description="Resistance")
    p_1 = model.input("p_1", 0.0, unit="N/m2", description="Pressure at the left end")
    p_2 = model.input("p_2", 0.0, unit="N/m2", description="Pressure at the right end")
    q = (p_1 - p_2) / R
    model.output("q_1", q, unit="m3/s", description="Flow out of the left tank", scalar=True)
    model.output("q_2", -q, unit="m3/s", description="Flow out of the right tank", scalar=True)
    return model


def two_tanks(folder: Path) -> System:
    """Two tanks and a pipe, all of which answer at once: an algebraic loop on each side."""
    wires = ("left.p -> pipe.p_1", "right.p -> pipe.p_2", "pipe.q_1 -> left.q", "pipe.q_2 -> right.q")
    fmus = _built({"left": tank, "pipe": pipe, "right": tank}, folder)
    return _system("two tanks", fmus, wires, 1.0, 120.0).set({"right.h_start": 0.2})


def _built(models: Mapping[str, Callable[[], Model]], folder: Path) -> dict[str, Path]:
    made = {declare: build(declare(), folder) for declare in dict.fromkeys(models.values())}
    return {name: made[declare] for name, declare in models.items()}


def _system(name: str, fmus: Mapping[str, Path], wires: Sequence[str], step: float, stop_time: float) -> System:
    return replace(System.of(fmus, name).connect(*wires), step=step, stop_time=stop_time)


CASES: Mapping[str, Callable[[Path], System]] = {
    "thermal": thermal,
    "drive": drive,
    "sampled": sampled,
    "quarter-car": quarter_car,
    "two-tanks": two_tanks,
}


def write(folder: Path) -> None:
    """Write the five packages, and the FMUs beside them."""
    for name, make in CASES.items():
        fmus = folder / f"{name}-fmus"
        fmus.mkdir(parents=True)
        make(fmus).write(folder / f"{name}.ssp")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
