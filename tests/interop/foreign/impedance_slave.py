"""ImpedanceSlave: conventional impedance control as a class for PythonFMU, eq. (4) of Lu & Meng (1991).

    F = F_hat + C_x dx + g_x + H_x {ddx_v - M^-1 [B (dx - dx_v) + K (x - x_v) + F_hat]},  tau = J' F

with H_x = J^-T H J^-1, C_x dx = J^-T (C dq - H J^-1 dJ/dt dq), g_x = J^-T g. Friction is left out, and so
are the acceleration, which the law does not need, and the outputs that only figures read.

What PythonFMU 0.7 leaves out of a description is added in `to_xml`: units, dependencies, and a GUID that
is not drawn anew at each export. It runs in the interpreter of the host, or not at all.
"""

import ctypes
from collections.abc import Sequence
from math import cos, pi, sin
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability, Real

Pair = Sequence[float]
Matrix = tuple[Pair, Pair]
INPUTS = {
    "q": ("rad", [-0.7227342478, 1.4454684956]),
    "dq": ("rad/s", [2.0943951024, 0.0]),
    "F_hat": ("N", [0.0, 0.0]),
    "x_v": ("m", [1.5, 0.0]),
    "dx_v": ("m/s", [0.0, pi]),
    "ddx_v": ("m/s2", [-1.5 * pi**2, 0.0]),
}
PARAMETERS = {
    "M": ("kg", [2.0, 2.0]),
    "B": ("N.s/m", [340.0, 340.0]),
    "K": ("N/m", [4000.0, 4000.0]),
    "l": ("m", [1.0, 1.0]),
    "p_start": ("kg", [2.0, 1.0]),
}
BASE_UNITS = {
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "kg": {"kg": 1},
    "N.s/m": {"kg": 1, "s": -1},
    "N/m": {"kg": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
}


def solve(a: Matrix, y: Pair) -> Pair:
    """Solution of a x = y."""
    (p, q), (r, s) = a
    det = p * s - q * r
    return (s * y[0] - q * y[1]) / det, (p * y[1] - r * y[0]) / det


def times(a: Matrix, x: Pair) -> Pair:
    """The product a x."""
    return a[0][0] * x[0] + a[0][1] * x[1], a[1][0] * x[0] + a[1][1] * x[1]


def transposed(a: Matrix) -> Matrix:
    """The transpose."""
    return (a[0][0], a[1][0]), (a[0][1], a[1][1])


class ImpedanceSlave(Fmi2Slave):
    """The controller."""

    description = "Conventional impedance control, eq. (4)"

    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        # PythonFMU 0.7 releases these a second time after an exception: without a reference more, the next
        # call into the interpreter crashes.
        for mine in (type(self), self, self.log_queue):
            ctypes.pythonapi.Py_IncRef(ctypes.py_object(mine))
        self.guid = "{6a2d6c1e-impedance-slave-1}"
        self.default_experiment = DefaultExperiment(start_time=0.0, stop_time=2.0, step_size=1e-4)
        self.values = {name: list(start) for name, (_, start) in {**INPUTS, **PARAMETERS}.items()}
        self.values["tau_cmd"] = [0.0, 0.0]
        self.units = {name: unit for name, (unit, _) in {**INPUTS, **PARAMETERS}.items()} | {"tau_cmd": "N.m"}
        self.initialized = False
        for name in INPUTS:
            self._register(name, Fmi2Causality.input, Fmi2Variability.continuous)
        for name in PARAMETERS:
            self._register(name, Fmi2Causality.parameter, Fmi2Variability.fixed)
        self._register("tau_cmd", Fmi2Causality.output, Fmi2Variability.discrete, initial=Fmi2Initial.calculated)

    def exit_initialization_mode(self) -> None:
        """From now on the torque holds, and parameters are fixed."""
        self.values["tau_cmd"] = list(self.torque())
        self.initialized = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        """The torque of the inputs that were set before the step; steps of no length are not made."""
        if not (step_size > 0 and current_time < float("inf")):
            return False
        self.values["tau_cmd"] = list(self.torque())
        return True

    def torque(self) -> Pair:
        """Eq. (4), N.m, shape (2,)."""
        v = self.values
        (q1, q2), (w1, w2), (l1, l2), (m1, m2) = v["q"], v["dq"], v["l"], v["p_start"]
        w12 = w1 + w2
        c1, s1, c12, s12 = l1 * cos(q1), l1 * sin(q1), l2 * cos(q1 + q2), l2 * sin(q1 + q2)
        J = ((-s1 - s12, -s12), (c1 + c12, c12))
        couple, outer = m2 * l1 * l2 * cos(q2), m2 * l2**2
        H = (((m1 + m2) * l1**2 + outer + 2 * couple, outer + couple), (outer + couple, outer))
        h = m2 * l1 * l2 * sin(q2)
        coriolis = (-h * (w2 * w1 + w12 * w2), h * w1**2)
        drift = (-c1 * w1**2 - c12 * w12**2, -s1 * w1**2 - s12 * w12**2)
        x, dx = (c1 + c12, s1 + s12), times(J, (w1, w2))
        a = [
            v["ddx_v"][i]
            - (v["B"][i] * (dx[i] - v["dx_v"][i]) + v["K"][i] * (x[i] - v["x_v"][i]) + v["F_hat"][i]) / v["M"][i]
            for i in range(2)
        ]
        inertial, pulled = times(H, solve(J, a)), times(H, solve(J, drift))
        C_x = solve(transposed(J), [coriolis[i] - pulled[i] for i in range(2)])
        H_x = solve(transposed(J), inertial)
        return times(transposed(J), [v["F_hat"][i] + C_x[i] + H_x[i] for i in range(2)])

    def to_xml(self, model_options: dict[str, str] | None = None) -> Element:
        """The description of PythonFMU, with units and dependencies."""
        root = super().to_xml(model_options or {})
        units = Element("UnitDefinitions")
        for name, exponents in BASE_UNITS.items():
            powers = {base: str(power) for base, power in exponents.items()}
            SubElement(SubElement(units, "Unit", name=name), "BaseUnit", powers)
        root.insert(1, units)
        rows = root.findall("ModelVariables/ScalarVariable")
        for row in rows:
            row[0].set("unit", self.units[row.attrib["name"].partition("[")[0]])
        known = [str(i) for i, row in enumerate(rows, start=1) if row.attrib["causality"] != "output"]
        structure = root.find("ModelStructure")
        assert structure is not None
        initial = SubElement(structure, "InitialUnknowns")
        for unknown in structure.findall("Outputs/Unknown"):
            unknown.set("dependencies", "")
            SubElement(initial, "Unknown", index=unknown.attrib["index"], dependencies=" ".join(known))
        return root

    def _register(
        self, name: str, causality: Fmi2Causality, variability: Fmi2Variability, **options: Fmi2Initial
    ) -> None:
        """Both elements of a vector."""
        for i in range(2):
            self.register_variable(
                Real(
                    f"{name}[{i + 1}]",
                    causality=causality,
                    variability=variability,
                    getter=lambda i=i: self._shown(name, i),
                    setter=None if causality == Fmi2Causality.output else lambda value, i=i: self._set(name, i, value),
                    **options,
                )
            )

    def _shown(self, name: str, i: int) -> float:
        """A value; in initialization the torque follows the inputs."""
        if name == "tau_cmd" and not self.initialized:
            return self.torque()[i]
        return self.values[name][i]

    def _set(self, name: str, i: int, value: float) -> None:
        """Take a value.

        Raises
        ------
        ValueError
            If it is that of a parameter, and initialization has ended.
        """
        if self.initialized and name in PARAMETERS:
            msg = f"{name}[{i + 1}] is a fixed parameter; it cannot be set after initialization."
            raise ValueError(msg)
        self.values[name][i] = value
