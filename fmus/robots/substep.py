"""The sub-step with which a plant's friction can be integrated.

Friction slows joint motion down at the rates that are the eigenvalues of H^-1 D, where D has the damping of each joint,
and its Coulomb friction over the velocity in which that changes sign. The plant's method, Runge-Kutta of order 4, is
stable while rate times sub-step stays below 2.78. A light link with the friction of a geared motor has a high rate if
its rotor is left out, as it is in a URDF file: the rotor seen through the gears is often the larger inertia.
"""

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from fmus import start
from fmus.mechanics.rigid_body import RobotError
from fmus.mechanics.spatial_arm import SpatialArm

LONGEST = 1e-4  # s, as for all plants
STEPS = (LONGEST, 5e-5, 2e-5, 1e-5, 5e-6)  # s
STABLE = 2.0  # rate times sub-step, below 2.78 with room for other postures


@dataclass(frozen=True)
class FrictionRate:
    """The fastest rate at which friction slows down motion, 1/s, and the joint that it is of most."""

    rate: float
    joint: int


def friction_rate(arm: SpatialArm, q: np.ndarray, p: np.ndarray) -> FrictionRate:
    """The fastest rate of friction in a posture.

    Parameters
    ----------
    q, p
        Joint coordinates, rad or m, shape (n,), and parameters of the dynamics, shape (13 n,).
    """
    chain = arm.chain
    H = np.array(ca.evalf(ca.SX(arm.inertia(q, p))))
    D = np.array([joint.damping + joint.friction / start.COULOMB_VELOCITY for joint in chain.joints])
    rates, vectors = np.linalg.eig(np.linalg.solve(H, np.diag(D)))
    fastest = int(np.argmax(np.real(rates)))
    return FrictionRate(float(np.real(rates[fastest])), int(np.argmax(np.abs(vectors[:, fastest]))))


def longest_substep(arm: SpatialArm, q: np.ndarray, p: np.ndarray) -> float:
    """The longest of `STEPS` at which friction can be integrated, s.

    Raises
    ------
    RobotError
        If the shortest is too long; the message names the joint and what helps.
    """
    fastest = friction_rate(arm, q, p)
    for step in STEPS:
        if fastest.rate * step <= STABLE:
            return step
    joint, body = arm.chain.joints[fastest.joint], arm.chain.joints[fastest.joint].body
    viscous, coulomb = ("N.m.s/rad", "N.m") if joint.turns else ("N.s/m", "N")
    msg = (
        f"Robot {arm.chain.name}: {joint.label} has damping {joint.damping:g} {viscous} and friction "
        f"{joint.friction:g} {coulomb} against the small inertia of {body.name}, which would stop it within "
        f"{1 / fastest.rate:.1g} s; an integrator would need steps of {_shown(STABLE / fastest.rate)} s, and the "
        f"shortest is {STEPS[-1]:g} s. A URDF has no rotor inertia, which is the larger part in a geared "
        f"joint; give it in kg m2 as seen at the joint, such as rotor={{'{joint.name}': 0.05}}, or correct <dynamics>."
    )
    raise RobotError(msg)


def _shown(value: float) -> str:
    """A number with one digit, rounded down."""
    power = 10.0 ** math.floor(math.log10(value))
    return f"{math.floor(value / power) * power:.0e}"
