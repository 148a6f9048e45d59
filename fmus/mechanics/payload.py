"""A payload beyond the wrist sensor: the sensor measures its weight and inertia force, too.

A part `payload` of the mass at the tip sits between the wrist sensor and the wall. The arm pushes it with the force
F_wrist, the wall pushes it back with F_ext, gravity pulls it along -x2, and Newton's law for the payload gives

    F_wrist = F_ext + payload (ddx + gravity (0, 1)),   ddx = J ddq + dJ dq

Without a payload this is F_ext, the force of the tip on the wall. The motion of the arm does not depend on where the
sensor sits.
"""

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, ContinuousModel, Formula, Formulas

FORMULAS = Formulas(
    "Force at the wrist",
    [
        Formula(
            r"F_{\text{wrist}} = F_{\text{ext}} + m_s\,(\ddot{x} + g\,e_2)",
            "The part beyond the sensor has the mass m_s, the payload; e_2 points up.",
        )
    ],
)


def declare_payload(model: ContinuousModel, mass: ca.SX) -> ca.SX:
    """Declare the parameter `payload`, kg, which is part of the mass at the tip, and 0 by default."""
    payload = model.parameter(
        "payload",
        0.0,
        unit="kg",
        limits=NOT_NEGATIVE,
        description="Part of the last mass that sits beyond the wrist sensor; 0 = off",
    )
    model.require(ca.if_else(payload > mass, -1, 1), "payload must be at most the last element of m")
    return payload


def force_on_payload(payload: ca.SX, F_ext: ca.SX, ddx: ca.SX, gravity: ca.SX) -> ca.SX:
    """Return the force of the arm on the payload, N, shape (2,).

    Parameters
    ----------
    payload
        Mass beyond the sensor, kg.
    F_ext
        Force of the tip on the wall, N, shape (2,).
    ddx
        Acceleration of the tip, m/s2, shape (2,).
    gravity
        Gravitational acceleration along -x2, m/s2.
    """
    return F_ext + ca.if_else(payload > 0, payload * (ddx + ca.vertcat(0, gravity)), 0)
