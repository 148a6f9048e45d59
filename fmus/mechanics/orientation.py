"""Roll, pitch and yaw of a tip as task coordinates, with the Jacobian and the forces that belong to them.

The coordinates are x = (p, phi): the position p, m, and the angles phi = (roll, pitch, yaw), rad, which turn the tip
from its reference orientation R_0 to its orientation R, about the axes 1, 2, 3 of the base in this order:

    R = R3(yaw) R2(pitch) R1(roll) R_0

So phi = 0 is the reference orientation, and small angles are small rotations about the axes of the base. The angular
velocity in the axes of the base is w = E(phi) dphi. With the geometric Jacobian J_g and a wrench (f, m) of force and
moment in the axes of the base, at the tip,

    dx = J_a dq,   J_a = diag(I, E^-1) J_g,   F = (f, E' m),   dx' F = v' f + w' m

E is singular at pitch = +-90 deg, where roll and yaw turn about one axis: det E = cos(pitch). A reference orientation
near those that the task needs keeps it far away. Roll and yaw of a matrix jump by a full turn at +-180 deg. A law that
compares them with wanted angles takes the ones nearest to these (`nearest`).
"""

import math

import casadi as ca

from adaptimp_fmu import Formula, Formulas

FORMULAS = Formulas(
    "Position and orientation as coordinates",
    [
        Formula(
            r"x = (p, \varphi), \quad R = R_3(\varphi_3)\,R_2(\varphi_2)\,R_1(\varphi_1)\,R_0",
            "The coordinates are the position p of the tip and three angles: roll, pitch and yaw. These turn the tip"
            " about axes 1, 2 and 3 of the base, in this order, from its reference orientation R0 of reference_rpy.",
        ),
        Formula(
            r"\dot{x} = J_a\,\dot{q}, \quad J_a = \begin{pmatrix} I & 0 \\ 0 & E^{-1} \end{pmatrix} J,"
            r" \quad \omega = E(\varphi)\,\dot{\varphi}",
            "The analytic Jacobian gives the rates of the coordinates. J is the geometric Jacobian, and omega the"
            " angular velocity of the tip in the axes of the base.",
        ),
        Formula(
            r"F = (f, \; E^{T} m), \quad \dot{x}^{T} F = v^{T} f + \omega^{T} m",
            "A wrench of force f and moment m is the force F in these coordinates: both have the same power.",
        ),
        Formula(
            r"\det E = \cos\varphi_2",
            "At a pitch of 90 deg roll and yaw turn about one axis, and E has no inverse. Choose reference_rpy near the"
            " orientations of the task.",
        ),
    ],
)


def rotation(phi: ca.SX) -> ca.SX:
    """The matrix R3(yaw) R2(pitch) R1(roll), shape (3, 3), of angles phi rad, shape (3,)."""
    (cr, cp, cy), (sr, sp, sy) = ([f(phi[k]) for k in range(3)] for f in (ca.cos, ca.sin))
    return ca.vertcat(
        ca.horzcat(cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        ca.horzcat(sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        ca.horzcat(-sp, cp * sr, cp * cr),
    )


def angles(R: ca.SX) -> ca.SX:
    """Roll, pitch and yaw, rad, shape (3,), of a rotation matrix: roll and yaw within a half turn, pitch a quarter."""
    return ca.vertcat(ca.atan2(R[2, 1], R[2, 2]), ca.atan2(-R[2, 0], pitch_cosine(R)), ca.atan2(R[1, 0], R[0, 0]))


def nearest(phi: ca.SX, wanted: ca.SX) -> ca.SX:
    """Angles of the same orientation, rad, shape (3,), with roll and yaw at most a half turn from the wanted ones.

    Angles that are there already keep every bit.
    """
    turns = ca.floor((wanted - phi) / (2 * math.pi) + 0.5)
    return ca.vertcat(phi[0] + 2 * math.pi * turns[0], phi[1], phi[2] + 2 * math.pi * turns[2])


def pitch_cosine(R: ca.SX) -> ca.SX:
    """cos(pitch) of a rotation matrix, shape (1,): how far it is from the singularity of the angles, where it is 0."""
    return ca.sqrt(R[0, 0] ** 2 + R[1, 0] ** 2)


def rates_to_angular_velocity(phi: ca.SX) -> ca.SX:
    """The matrix E(phi), shape (3, 3): w = E dphi, in the axes of the base."""
    (cp, cy), (sp, sy) = ([f(phi[k]) for k in (1, 2)] for f in (ca.cos, ca.sin))
    return ca.vertcat(ca.horzcat(cy * cp, -sy, 0), ca.horzcat(sy * cp, cy, 0), ca.horzcat(-sp, 0, 1))


def angular_velocity_to_rates(R: ca.SX) -> ca.SX:
    """The inverse of E, shape (3, 3), from the rotation matrix itself: dphi = E^-1 w needs no angle."""
    cp, sp = pitch_cosine(R), -R[2, 0]
    cy, sy = R[0, 0] / cp, R[1, 0] / cp
    return ca.vertcat(
        ca.horzcat(cy / cp, sy / cp, 0), ca.horzcat(-sy, cy, 0), ca.horzcat(cy * sp / cp, sy * sp / cp, 1)
    )


def analytic_jacobian(J: ca.SX, R: ca.SX) -> ca.SX:
    """The Jacobian J_a of x = (p, phi), shape (6, n), of the geometric one, J; R turns from the reference, (3, 3)."""
    return ca.vertcat(J[:3, :], angular_velocity_to_rates(R) @ J[3:, :])


def generalized_force(wrench: ca.SX, phi: ca.SX) -> ca.SX:
    """F = (f, E' m), N and N.m, shape (6,): what dx = (dp, dphi) works against, for a wrench (f, m), shape (6,)."""
    return ca.vertcat(wrench[:3], rates_to_angular_velocity(phi).T @ wrench[3:])


def wrench(F: ca.SX, R: ca.SX) -> ca.SX:
    """The wrench (f, m), N and N.m, shape (6,), of F = (f, E' m): the inverse of `generalized_force`."""
    return ca.vertcat(F[:3], angular_velocity_to_rates(R).T @ F[3:])
