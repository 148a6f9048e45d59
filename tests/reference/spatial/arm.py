"""The PUMA 560 with a tool and a payload, as a model of Pinocchio that is built from tables of numbers.

Tables: Armstrong, Khatib and Burdick (1986) as Corke lists them for Craig's (modified) Denavit-Hartenberg frames. Row k
places joint k by Rot(x, alpha) Trans(x, a) in the frame of joint k - 1, turns it about z by q_k, and shifts it by d
along z. Moments of inertia are about the centres of mass; a motor's inertia counts with the square of its gears.

A body's ten parameters are Pinocchio's: m, m c, I11, I12, I22, I13, I23, I33 about the origin of a frame. They move to
another frame by the matrix of second moments (the pseudo-inertia): S = [Sigma, m c; m c', m] becomes T S T', where T is
the frame's placement and Sigma = (tr I / 2) - I.
"""

from typing import Any

import numpy as np
import pinocchio

pin: Any = pinocchio  # a compiled module, whose names a type checker does not see

JOINTS = 6
# a (m), alpha (quarter turns), d (m), mass (kg), centre of mass (m), moments (kg.m2), motor (kg.m2), gears
ROWS = (
    (0.0, 0, 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.35), 291e-6, -62.6111),
    (0.0, -1, 0.2435, 17.4, (0.068, 0.006, -0.016), (0.13, 0.524, 0.539), 409e-6, 107.815),
    (0.4318, 0, -0.0934, 4.8, (0.0, -0.070, 0.014), (0.066, 0.0125, 0.066), 299e-6, -53.7063),
    (-0.0203, 1, 0.4331, 0.82, (0.0, 0.0, -0.019), (1.8e-3, 1.8e-3, 1.3e-3), 35e-6, 76.0364),
    (0.0, -1, 0.0, 0.34, (0.0, 0.0, 0.0), (0.3e-3, 0.3e-3, 0.4e-3), 35e-6, 71.923),
    (0.0, 1, 0.0, 0.09, (0.0, 0.0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3), 35e-6, 76.686),
)
TOOL = (0.0, 0.0, 0.15)
"""Position of the tip in the frame of joint 6, m; the axes are the same."""
LOWER = ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))
"""Places in the inertia matrix of the last six of the ten parameters."""


def puma(gravity, touching=(0.0, 0.0, 0.0)):
    """Return the model of the arm without a payload; its frames "tip" and "touch" are the tip and the contact point.

    Parameters
    ----------
    gravity : sequence of 3 floats
        Acceleration of a falling body in the axes of the base, m/s2.
    touching : sequence of 3 floats
        The point that touches the wall, in the frame of the tip, m.
    """
    built, parent = pin.Model(), 0
    for k, (a, quarter_turns, d, mass, center, moments, motor, gears) in enumerate(ROWS):
        turned = pin.SE3(pin.utils.rotate("x", quarter_turns * np.pi / 2), np.array([a, 0.0, 0.0]))
        shifted = pin.SE3(np.eye(3), np.array([0.0, 0.0, d]))
        parent = built.addJoint(parent, pin.JointModelRZ(), turned * shifted, f"joint{k + 1}")
        built.appendBodyToJoint(parent, pin.Inertia(mass, np.array(center), np.diag(moments)), pin.SE3.Identity())
        built.armature[k] = motor * gears**2
    for name, place in (("tip", TOOL), ("touch", np.add(TOOL, touching))):
        placement = pin.SE3(np.eye(3), np.array(place, dtype=np.float64))
        built.addFrame(pin.Frame(name, parent, placement, pin.FrameType.OP_FRAME))
    built.gravity = pin.Motion(np.array(gravity, dtype=np.float64), np.zeros(3))
    return built


def ten_of_body(mass, center, moments):
    """Return the ten parameters of a body from mass kg, centre m and six moments about the centre, kg.m2."""
    c, inertia = np.array(center), symmetric(moments)
    about_origin = inertia + mass * (c @ c * np.eye(3) - np.outer(c, c))
    return np.array([mass, *(mass * c), *(about_origin[place] for place in LOWER)])


def moved(place=TOOL):
    """Return the matrix, shape (10, 10), that takes ten parameters to the frame that sees theirs at `place`, m."""
    transform = np.eye(4)
    transform[:3, 3] = place
    return np.stack([_ten(transform @ _second_moments(unit) @ transform.T) for unit in np.eye(10)], axis=1)


def hold(model, ten):
    """Return a copy of a model whose last body holds a body at the tip with these ten parameters."""
    holding = model.copy()
    with_body = holding.inertias[JOINTS].toDynamicParameters() + MOVED @ ten
    holding.inertias[JOINTS] = pin.Inertia.FromDynamicParameters(with_body)
    return holding


def symmetric(six):
    """Return the symmetric matrix of the elements 11, 12, 22, 13, 23, 33, shape (3, 3)."""
    matrix = np.zeros((3, 3))
    for value, (i, j) in zip(six, LOWER, strict=True):
        matrix[i, j] = matrix[j, i] = value
    return matrix


def _second_moments(ten):
    """Return the matrix of second moments of a body, shape (4, 4)."""
    inertia = symmetric(ten[4:])
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = np.trace(inertia) / 2 * np.eye(3) - inertia
    matrix[:3, 3] = matrix[3, :3] = ten[1:4]
    matrix[3, 3] = ten[0]
    return matrix


def _ten(matrix):
    """Return the ten parameters of a matrix of second moments."""
    sigma = matrix[:3, :3]
    inertia = np.trace(sigma) * np.eye(3) - sigma
    return np.array([matrix[3, 3], *matrix[:3, 3], *(inertia[place] for place in LOWER)])


MOVED = moved()
"""Takes the ten parameters of a body from the frame of the tip to that of joint 6."""
