"""What the pages in the FMUs of an arm in space say besides its variables: parameters by body, and first programs.

The programs need FMPy alone. `tests/conformance/test_spatial_pages.py` runs them as they stand on the page.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from adaptimp_fmu import Example, Grid, Numbers
from fmus.elements import TURNS
from fmus.mechanics.arm import ArmParameter
from fmus.mechanics.chain import Chain
from fmus.mechanics.joints import Joints

ARRAYS = ("p", "p_start", "p_hat", "p_min", "p_max", "Gamma")
"""Arrays with an element for each of the arm's parameters."""
LEGEND = (
    "The parameters of the arm stand in tables, a body or a joint in each row, under the numbers of their elements."
    " m is the mass of a body, mc1 to mc3 mass times centre of mass, I11 to I33 the moments of inertia about the origin"
    " of the frame: the frame of the joint that moves the body, and for the payload the frame of the tip. With a centre"
    " of mass c and moments J about it, mc = m c and I = J + m (c'c 1 - c c')."
)
PRESS = 20.0
"""Force with which the tip of an example presses on the wall, N."""
BANDWIDTH = 20.0
"""Angular frequency at which the controller of an example returns to rest, rad/s."""


@dataclass(frozen=True)
class Rest:
    """An arm at rest at its start.

    Attributes
    ----------
    joints
        What the joints are, n in number. Units below are those of joints that turn.
    holding
        Torques that carry the weight of arm and payload, N.m, shape (n,).
    pressing
        Torques with which the tip presses on the wall with `PRESS`, N.m, shape (n,).
    inertias
        Diagonal of the inertia matrix, kg m2, shape (n,).
    touching
        The wall_offset at which the surface of the wall is at the tip, m.
    """

    joints: Joints
    holding: np.ndarray
    pressing: np.ndarray
    inertias: np.ndarray
    touching: float


def parameter_grid(parameters: Sequence[ArmParameter], origin: str) -> Grid:
    """Tables of the arrays that have an element for each parameter; `origin` says where the numbers come from."""
    places = [parameter.place for parameter in parameters]
    return Grid(ARRAYS, places, "parameters of the arm", f"{LEGEND} {origin}".strip())


def frames(chain: Chain) -> Numbers:
    """Where the joints and the tip of an arm are, which is fixed in its equations."""
    placements = [(f"{joint.label}, {joint.kind}", joint.placement, joint.axis) for joint in chain.joints]
    rows = [
        (name, [_number(value) for value in (*placement.p, *placement.rpy, *axis)])
        for name, placement, axis in (*placements, ("tip", chain.tip, ()))
    ]
    heads = [
        *((f"p{i}", "m") for i in (1, 2, 3)),
        *((turn, "rad") for turn in TURNS),
        *((f"a{i}", "") for i in (1, 2, 3)),
    ]
    text = (
        "At q = 0 the frame of a joint stands at p in the frame of the joint before, that of the first joint in the"
        " base and the tip in that of the last joint, and is turned there by R = R3(yaw) R2(pitch) R1(roll). From there"
        " q turns the frame about its axis a, or shifts it along a if the joint slides. These numbers are fixed in the"
        " FMU."
    )
    return Numbers(
        "Frames of the joints", text, heads, [(name, [*texts, *[""] * (9 - len(texts))]) for name, texts in rows]
    )


def first_runs(name: str, rest: Rest) -> list[Example]:
    """Programs that drive the plant of a name: without torque, held, and by a controller that presses on the wall."""
    suffix = name.removeprefix("Plant")
    return [_held(name, rest), _own_controller(name, rest), *([_whole_loop(suffix)] if name != suffix else [])]


def _held(name: str, rest: Rest) -> Example:
    """Hold the arm, and let it go."""
    torque = _unit(rest.joints, "N.m", "N")
    code = f"""\
from fmpy import simulate_fmu

hold = {_list(rest.holding)}  # {torque}
at_rest = {{f"dq_start[{{i}}]": 0.0 for i in range(1, {len(rest.holding) + 1})}}
held = at_rest | {{f"tau[{{i}}]": torque for i, torque in enumerate(hold, 1)}}
position = ["x[1]", "x[2]", "x[3]"]  # m, in the axes of the base

for what, values in (("held", held), ("let go", at_rest)):
    result = simulate_fmu(
        "{name}.fmu", stop_time=0.2, output_interval=1e-3, start_values=values, output=position
    )
    moved = [1e3 * float(result[name][-1] - result[name][0]) for name in position]
    print(f"{{what:8}}", *(f"{{distance:8.2f}}" for distance in moved), "mm")
"""
    text = (
        "The arm has no brakes: without torque it falls. At the start the joints move, since the tip is on its ellipse;"
        " dq_start = 0 lets the arm begin at rest. The torques hold carry the weight of the arm and its payload there,"
        " so that the tip stays where it is; without them it falls by some centimetres in 0.2 s. FMPy is all that the"
        " program needs: pip install fmpy. State output_interval: without it FMPy takes a longer step than this FMU"
        " proposes where a run would have more than 1000 rows."
    )
    return Example("A first run: hold the arm, and let it go", text, code)


def _own_controller(name: str, rest: Rest) -> Example:
    """A joint controller that presses on the wall."""
    stiffness, damping = BANDWIDTH**2 * rest.inertias, 2 * BANDWIDTH * rest.inertias
    torque = _unit(rest.joints, "N.m", "N")
    code = f"""\
import shutil

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP = 1e-3  # s
HOLD = {_list(rest.holding)}  # {torque}
PRESS = {_list(rest.pressing)}  # {torque}: J' f for a force of {PRESS:g} N along the normal
STIFFNESS = {_list(stiffness)}  # {_unit(rest.joints, "N.m/rad", "N/m")}
DAMPING = {_list(damping)}  # {_unit(rest.joints, "N.m.s/rad", "N.s/m")}

description = read_model_description("{name}.fmu")
reference = {{variable.name: variable.valueReference for variable in description.modelVariables}}


def elements(name, size={len(rest.holding)}):
    return [reference[f"{{name}}[{{i}}]"] for i in range(1, size + 1)]


folder = extract("{name}.fmu")
plant = FMU2Slave(
    guid=description.guid,
    modelIdentifier=description.coSimulation.modelIdentifier,
    unzipDirectory=folder,
    instanceName="plant",
)
plant.instantiate()
plant.setupExperiment(startTime=0.0)
plant.setReal(elements("dq_start"), [0.0] * {len(rest.holding)})
plant.setReal([reference["wall_offset"]], [{_number(rest.touching)}])  # the wall touches the tip
plant.enterInitializationMode()
plant.exitInitializationMode()
q_rest = plant.getReal(elements("q"))
for step in range(500):
    q, dq = plant.getReal(elements("q")), plant.getReal(elements("dq"))
    tau = [
        hold + press + k * (rest - angle) - d * rate
        for hold, press, k, rest, angle, d, rate in zip(HOLD, PRESS, STIFFNESS, q_rest, q, DAMPING, dq)
    ]
    plant.setReal(elements("tau"), tau)
    plant.doStep(currentCommunicationPoint=step * STEP, communicationStepSize=STEP)
force = plant.getReal(elements("F_ext", 3))
depth = plant.getReal([reference["penetration"]])[0]
print("force on the wall:", *(f"{{component:.1f}}" for component in force), "N; depth:", f"{{1e3 * depth:.3f}} mm")
plant.terminate()
plant.freeInstance()
shutil.rmtree(folder)
"""
    text = (
        "Read q and dq, compute torques, set tau, make a step: so any controller drives the plant. This one holds the"
        " joints by springs and dampers, and presses with the tip. The wall is moved to the tip, so that contact begins"
        f" at once. In the end the wall takes nearly all of {PRESS:g} N: F_ext points along wall_normal, into the wall,"
        " and its size is the depth times the stiffness K_f; the springs of the joints take the rest."
    )
    return Example("A controller of your own: press on the wall", text, code)


def _whole_loop(suffix: str) -> Example:
    """The loop of the five FMUs."""
    code = f"""\
import shutil

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP, STOP = 1e-3, 2.0  # s
NAMES = ["VirtualTrajectory", "ForceSensor", "HoganImpedance", "Actuator", "Plant"]  # the order of a step


class Unit:
    def __init__(self, name):
        path = f"{{name}}{suffix}.fmu"
        description = read_model_description(path)
        self.folder = extract(path)
        self.fmu = FMU2Slave(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=self.folder,
            instanceName=name,
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        named = {{variable.name: variable for variable in description.modelVariables}}
        self.reference = {{name: variable.valueReference for name, variable in named.items()}}
        reals = {{name: variable for name, variable in named.items() if variable.type == "Real"}}
        self.inputs = {{name for name, variable in reals.items() if variable.causality == "input"}}
        self.outputs = {{name for name, variable in reals.items() if variable.causality == "output"}}
        if "sample_time" in named:
            self.fmu.setReal([self.reference["sample_time"]], [STEP])

    def get(self, names):
        return self.fmu.getReal([self.reference[name] for name in names])

    def set(self, names, values):
        self.fmu.setReal([self.reference[name] for name in names], values)


units = [Unit(name) for name in NAMES]
# Signals of one name belong together.
pairs = [(a, b, sorted(a.outputs & b.inputs)) for a in units for b in units if a is not b]
links = [pair for pair in pairs if pair[2]]
for unit in units:
    unit.fmu.enterInitializationMode()
for source, target, names in links * len(units):  # as often as values may pass on
    target.set(names, source.get(names))
for unit in units:
    unit.fmu.exitInitializationMode()
controller, plant = units[2], units[4]
error = force = 0.0
for step in range(round(STOP / STEP)):
    for unit in units:
        for source, target, names in links:
            if target is unit:
                target.set(names, source.get(names))
        unit.fmu.doStep(currentCommunicationPoint=step * STEP, communicationStepSize=STEP)
    error = max(error, *map(abs, controller.get(["e[1]", "e[2]", "e[3]"])))
    force = max(force, sum(f * f for f in plant.get(["F_ext[1]", "F_ext[2]", "F_ext[3]"])) ** 0.5)
print(f"largest error of the position: {{1e3 * error:.1f}} mm; largest force: {{force:.0f}} N")
for unit in units:
    unit.fmu.terminate()
    unit.fmu.freeInstance()
    shutil.rmtree(unit.folder)
"""
    text = (
        "All five FMUs of the loop beside each other in one folder, coupled by the names of their signals. Outputs of a"
        " unit pass to the units that run after it in the same step, so the order matters. The controller does not know"
        " the payload of the plant, if there is one; put an adaptive controller in its place, which finds the payload."
    )
    return Example("The whole loop", text, code)


def _list(values: np.ndarray) -> str:
    """Numbers as a list in Python, to four digits."""
    return f"[{', '.join(f'{float(value) + 0.0:.4g}' if abs(value) > 1e-9 else '0' for value in values)}]"


def _unit(joints: Joints, turning: str, sliding: str) -> str:
    """The unit of a list with a number for each joint, as a comment in a program."""
    units = joints.each(turning, sliding)
    return units[0] if len(set(units)) == 1 else ", ".join(units)


def _number(value: float) -> str:
    """A number with all digits that count."""
    return f"{round(value, 10) + 0.0:.10g}"
