"""Recursive Newton-Euler equations of a planar arm with point masses at the ends of its links.

The recursion gives H(q) a + C(q, dq) v + g(q) + f(dq) with a number of operations that grows with the number of
joints n, while that of the Lagrangian equations grows with n^3 or faster (Luh, Walker and Paul, "On-line computational
scheme for mechanical manipulators", 1980). Links are described by absolute angles: link i has the direction u_i,
the normal n_i, and ends at r_i = r_(i-1) + l_i u_i.

    ddr_i = ddr_(i-1) + l_i (a_i n_i - w_i v_i u_i)          outwards; the base rises with the gravity
    F_i   = F_(i+1) + m_i ddr_i                              inwards: the force on link i
    tau_i = tau_(i+1) + l_i n_i' F_i + f_i

Here w_i, v_i and a_i are sums of dq, v and a from joint 1 to joint i. For v = dq this is the recursion of the paper's
reference [14]. For two velocities the product w_i v_i gives C(q, dq) of Christoffel symbols, since the masses are
points (Niemeyer and Slotine, "Performance in adaptive manipulator control", 1991).
"""

from collections.abc import Sequence

import casadi as ca


def inverse_dynamics(n: int) -> ca.Function:
    """The torque H a + C(q, dq) v + g + f, N.m, shape (n,), by recursion.

    Parameters
    ----------
    n
        Number of joints.

    Returns
    -------
    casadi.Function
        A function with the arguments of `fmus.mechanics.planar_arm.PlanarArm.inverse_dynamics`.
    """
    (q, dq, v, a, p, l, gravity, coulomb_velocity), names = _arguments(n)
    m, viscous, coulomb = p[:n], p[n : 2 * n], p[2 * n :]
    normals, accelerations = _accelerations(q, (dq, v, a), l, gravity)
    force, torques = ca.SX.zeros(2, 1), [ca.SX(0)] * (n + 1)
    for i in reversed(range(n)):
        force = force + m[i] * accelerations[i]
        torques[i] = torques[i + 1] + l[i] * ca.dot(normals[i], force)
    friction = viscous * dq + coulomb * ca.tanh(dq / coulomb_velocity)
    arguments = [q, dq, v, a, p, l, gravity, coulomb_velocity]
    return ca.Function("tau", arguments, [ca.vertcat(*torques[:n]) + friction], names, ["tau"])


def regressor(n: int) -> ca.Function:
    """The joint regressor Y, shape (n, 3 n), by recursion: `inverse_dynamics` is Y p.

    Parameters
    ----------
    n
        Number of joints.

    Returns
    -------
    casadi.Function
        A function with the arguments of `fmus.mechanics.planar_arm.PlanarArm.regressor`.
    """
    (q, dq, v, a, _, l, gravity, coulomb_velocity), names = _arguments(n)
    normals, accelerations = _accelerations(q, (dq, v, a), l, gravity)
    masses = ca.SX.zeros(n, n)
    for j in range(n):
        torque = ca.SX(0)
        for i in reversed(range(j + 1)):
            torque = torque + l[i] * ca.dot(normals[i], accelerations[j])
            masses[i, j] = torque
    Y = ca.horzcat(masses, ca.diag(dq), ca.diag(ca.tanh(dq / coulomb_velocity)))
    names = [name for name in names if name != "p"]
    return ca.Function("Y", [q, dq, v, a, l, gravity, coulomb_velocity], [Y], names, ["Y"])


def inertia(n: int) -> ca.Function:
    """The inertia matrix ``H(q, m, l)``, kg m2, shape (n, n), from the masses that each link carries.

    In absolute angles the matrix is l_i l_j u_i'u_j times the sum of the masses from link max(i, j) on.
    """
    q, m, l = (ca.SX.sym(name, n) for name in ("q", "m", "l"))
    directions, angle = [], ca.SX(0)
    for i in range(n):
        angle = angle + q[i]
        directions.append(l[i] * ca.vertcat(ca.cos(angle), ca.sin(angle)))
    carried = _sums_from(m)
    H = ca.SX.zeros(n, n)
    for i in range(n):
        for j in range(i + 1):
            H[i, j] = carried[i] * ca.dot(directions[i], directions[j])
            H[j, i] = H[i, j]
    for _ in range(2):
        H = ca.horzcat(*(_sums_from(H[i, :].T) for i in range(n)))
    return ca.Function("H", [q, m, l], [H], ["q", "m", "l"], ["H"])


def _sums_from(vector: ca.SX) -> ca.SX:
    """Sums of a vector's elements from each one to the last."""
    sums, total = [], ca.SX(0)
    for i in reversed(range(vector.numel())):
        total = total + vector[i]
        sums.append(total)
    return ca.vertcat(*reversed(sums))


def _accelerations(q: ca.SX, rates: Sequence[ca.SX], l: ca.SX, gravity: ca.SX) -> tuple[list[ca.SX], list[ca.SX]]:
    """Normals of the links and accelerations of their ends, from the rates dq, v and a."""
    normals, accelerations = [], []
    end = ca.vertcat(0, gravity)
    angle, w, v, a = ca.SX(0), ca.SX(0), ca.SX(0), ca.SX(0)
    dq, second, acceleration = rates
    for i in range(q.numel()):
        angle, w, v, a = angle + q[i], w + dq[i], v + second[i], a + acceleration[i]
        c, s = ca.cos(angle), ca.sin(angle)
        along, across = ca.vertcat(c, s), ca.vertcat(-s, c)
        end = end + l[i] * (a * across - w * v * along)
        normals.append(across)
        accelerations.append(end)
    return normals, accelerations


def _arguments(n: int) -> tuple[list[ca.SX], list[str]]:
    names = ["q", "dq", "v", "a", "p", "l", "gravity", "coulomb_velocity"]
    sizes = [n, n, n, n, 3 * n, n, 1, 1]
    return [ca.SX.sym(name, size) for name, size in zip(names, sizes, strict=True)], names
