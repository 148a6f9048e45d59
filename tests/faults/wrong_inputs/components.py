"""Wrong start values of components, and one FMU that is driven wrongly."""

import numpy as np

from orchestration import Fmu, InitializationError, SignalError, SimulationError, SystemDescriptionError, prepare
from tests.faults.wrong_inputs.case import Action, Bench, Wrong, untyped

E = SystemDescriptionError
K = "controller.K[1]"


def _set(name: str, value: object) -> Action:
    return lambda b: b.loop.set({name: value})


def _begin(name: str, value: float) -> Action:
    """Begin a run with a start value that its FMU refuses."""

    def begin(b: Bench) -> None:
        with prepare(b.loop.set({name: value}), 1e-3, 1e-4):
            pass

    return begin


def _plant(action: Action) -> Action:
    """Do something to an open plant, which stands in the place of the bench's folder."""

    def act(b: Bench) -> None:
        with Fmu(b.fmu("Plant")) as plant:
            action(plant)

    return act


def _nan(plant: Fmu) -> None:
    plant.set(tau=[np.nan, 0.0])
    plant.step(1e-3)


def _far(b: Bench) -> None:
    with Fmu(b.fmu("Plant"), start_time=1e12) as plant:
        plant.step(1e-5)


def _closed(b: Bench) -> None:
    plant = Fmu(b.fmu("Plant"))
    plant.close()
    plant.step(1e-3)


def _other_state(b: Bench) -> None:
    with Fmu(b.fmu("Actuator")) as other, Fmu(b.fmu("Plant")) as plant:
        plant.restore(other.save())


TABLE = (
    Wrong("a start value without a component", _set("K_f", 1.0), "'K_f'", "component.variable", "plant.K_f", E),
    Wrong("a start value of an unknown component", _set("plnt.K_f", 1.0), "plnt", "plant", "did you mean", E),
    Wrong("a start value of an unknown variable", _set("plant.Kf", 1.0), "plant|Kf", "K_f", "did you mean", E),
    Wrong(
        "a start value in another case",
        _set("controller.k", 1.0),
        "controller|variable k",
        "controller.K",
        "case-sensitive",
        E,
    ),
    Wrong(
        "a start value far from all names", _set("plant.stiffness", 1.0), "plant|stiffness", "variable", "there are", E
    ),
    Wrong(
        "an element that an array lacks",
        _set("controller.K[3]", 1.0),
        "controller|K[3]",
        "controller.K[1] to controller.K[2]",
        "elements",
        E,
    ),
    Wrong(
        "an element counted from zero",
        _set("controller.K[0]", 1.0),
        "controller|K[0]",
        "controller.K[1] to controller.K[2]",
        "elements",
        E,
    ),
    Wrong("an index of a scalar", _set("plant.K_f[1]", 1.0), "plant|K_f[1]", "K_f", "not an array", E),
    Wrong("three values of two", _set("controller.K", [1.0, 2.0, 3.0]), "controller.K", "3|2", "one for all", E),
    Wrong(
        "a value of an output",
        _set("plant.q", 0.0),
        "plant.q[1]",
        "output|inputs and initial states",
        "plant.q_start",
        E,
    ),
    Wrong("a value with its unit", _set(K, "4000 N/m"), f"{K} = '4000 N/m'", "N/m", "plain number", E),
    Wrong("a value with another unit", _set(K, "4 kN/m"), f"{K} = '4 kN/m'", "in N/m", "plain number", E),
    Wrong("a unit as value", _set(K, "N/m"), f"{K} = 'N/m'", "in N/m", "number", E),
    Wrong("a decimal comma", _set(K, "0,5"), f"{K} = '0,5'", "in N/m", "0.5", E),
    Wrong("a word as value", _set("plant.K_f", "hard"), "plant.K_f = 'hard'", "in N/m", "number", E),
    Wrong("an empty value", _set("plant.K_f", ""), "plant.K_f = ''", "in N/m", "number", E),
    Wrong("None as value", _set(K, None), f"{K} = None", "in N/m", "number", E),
    Wrong("NaN as value", _set(K, float("nan")), f"{K} = nan", "in N/m", "finite number", E),
    Wrong("infinity as value", _begin(K, float("inf")), "controller|K[1]", "inf", "not finite", InitializationError),
    Wrong("a complex value", _set(K, 1 + 2j), f"{K} = (1+2j)", "in N/m", "number", E),
    Wrong("a list for a scalar", _set("plant.K_f", [1.0, 2.0]), "plant.K_f", "2 values|scalar", "one number", E),
    Wrong(
        "a number for a Boolean",
        _set("sensor.contact_gated", 2),
        "sensor.contact_gated = 2",
        "Boolean",
        "true or false",
        E,
    ),
    Wrong(
        "a fraction for an Integer",
        _set("sensor.seed", 0.5),
        "sensor.seed = 0.5",
        "integer of 32 bits",
        "whole number",
        E,
    ),
    Wrong(
        "an Integer of 40 bits",
        _set("sensor.seed", 1e12),
        "sensor.seed",
        "1000000000000.0|2147483647",
        "whole number",
        E,
    ),
    Wrong("values that are no mapping", lambda b: b.loop.set(("controller.K", 5)), "set", "tuple", '{"', E),
    Wrong(
        "a stiffness that is negative",
        _begin("controller.K[1]", -5.0),
        "controller|K[1] = -5",
        "1e-12 N/m",
        "must be at least",
        InitializationError,
    ),
    Wrong(
        "a stiffness of the wall that is negative",
        _begin("plant.K_f", -1.0),
        "plant|K_f = -1",
        "0 N/m",
        "must be at least",
        InitializationError,
    ),
    Wrong(
        "a period of zero",
        _begin("trajectory.period", 0.0),
        "trajectory|period = 0",
        "1e-12 s",
        "must be at least",
        InitializationError,
    ),
    Wrong(
        "an arm that begins stretched",
        _begin("plant.q_start[2]", 0.0),
        "controller|The arm is singular",
        "1e-12|-9.99",
        "must exceed",
        InitializationError,
    ),
    Wrong(
        "an unknown name of an FMU",
        _plant(lambda p: p.set({"tua": [0, 0]})),
        "Plant|tua",
        "tau",
        "did you mean",
        SignalError,
    ),
    Wrong(
        "an array of another length",
        _plant(lambda p: p.set(tau=[1, 2, 3])),
        "Plant|tau",
        "(2,)|(3,)",
        "takes",
        SignalError,
    ),
    Wrong("a text for a torque", _plant(lambda p: p.set(tau="big")), "Plant|tau", "'big'", "numbers", SignalError),
    Wrong("NaN for a torque", _plant(_nan), "Plant|at t = 0 s", "tau[1]|nan", "finite", SimulationError),
    Wrong("None for a torque", _plant(lambda p: p.set(tau=None)), "Plant|tau", "None", "numbers", SignalError),
    Wrong(
        "a fixed parameter of an open FMU",
        _plant(lambda p: p.set(K_f=1.0)),
        "Plant|K_f",
        "fixed parameter",
        "can be set until initialization ends",
        SimulationError,
    ),
    Wrong(
        "a start value that an FMU lacks",
        lambda b: Fmu(b.fmu("Plant"), k_f=1.0),
        "Plant|k_f",
        "K_f",
        "case-sensitive",
        SignalError,
    ),
    Wrong(
        "a start value of an FMU out of range",
        lambda b: Fmu(b.fmu("Plant"), K_f=-1.0),
        "Plant|K_f = -1",
        "0 N/m",
        "must be at least",
        InitializationError,
    ),
    Wrong(
        "a start time of an FMU that is a text",
        lambda b: Fmu(b.fmu("Plant"), start_time=untyped("now")),
        "Plant|start time",
        "'now'",
        "number",
        SignalError,
    ),
    Wrong("a step of an FMU of zero", _plant(lambda p: p.step(0.0)), "Plant|step", "0 s", "positive", SignalError),
    Wrong(
        "a step of an FMU that is a text",
        _plant(lambda p: p.step("1 ms")),
        "Plant|step",
        "'1 ms'",
        "number",
        SignalError,
    ),
    Wrong("a step that does not advance", _far, "Plant|step", "1e-05 s|1e+12 s", "larger", SignalError),
    Wrong(
        "rows without a time",
        _plant(lambda p: p.drive(1e-3)),
        "Plant|drive",
        "inputs",
        "communication points",
        SignalError,
    ),
    Wrong(
        "fewer rows than steps",
        _plant(lambda p: p.drive([0, 1e-3, 2e-3], {"tau": np.zeros((5, 2))})),
        "Plant|tau",
        "2 steps|5",
        "one row",
        SignalError,
    ),
    Wrong(
        "times that go back",
        _plant(lambda p: p.drive([0, 2e-3, 1e-3], {"tau": np.zeros((2, 2))})),
        "Plant|times",
        "0.002|0.001",
        "increasing",
        SignalError,
    ),
    Wrong(
        "an output as input",
        _plant(lambda p: p.drive(1e-3, {"q": np.zeros((2, 2))})),
        "Plant|q",
        "output|tau",
        "inputs",
        SignalError,
    ),
    Wrong("a state of another FMU", _other_state, "Plant", "state|another FMU", "save()", SignalError),
    Wrong("a state that is a text", _plant(lambda p: p.restore("x")), "Plant|state", "'x'", "save()", SignalError),
    Wrong("an FMU that is closed", _closed, "Plant", "closed", "open it again", SimulationError),
)
