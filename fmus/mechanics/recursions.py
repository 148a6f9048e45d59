"""The recursions of serial chains: Newton-Euler for torques, composite rigid bodies for the inertia matrix.

Vectors are in the axes of each body's own frame, whose origin lies on the joint's axis. A frame turns at the rate w,
and its origin has the acceleration a. With the matrix K = [dw/dt]x + W, where W r = w x (w x r), a point r of the body
has the acceleration a + K r. Newton's and Euler's laws for a body of mass m, first moment mc and inertia I about the
origin are

    f = m a + K mc,   n = I dw/dt + w x I w + mc x a

(J. Luh, M. Walker, R. Paul, "On-line computational scheme for mechanical manipulators", J. Dyn. Sys. 102, 1980;
R. Featherstone, "Rigid Body Dynamics Algorithms", 2008, chapters 5 and 6).

Two velocities. Control laws need C(q, dq) v with v different from dq, and with that C for which dH/dt - 2 C is
skew-symmetric: the one of Christoffel's symbols. These are symmetric in the two velocities they multiply, so
C(q, dq) v is the symmetric bilinear form that belongs to the quadratic form C(q, dq) dq. Each product of two rates
above is replaced by its symmetric counterpart, w x (w x r) by (w x (u x r) + u x (w x r)) / 2, with u the rate of the
frame at the joint velocities v.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from fmus.mechanics.chain import Chain, Joint
from fmus.mechanics.rigid_body import LOWER

TEN = 10
"""Parameters of a body."""


@dataclass(frozen=True)
class Inertia:
    """Parameters of a body as expressions: m, kg; mc, kg m, (3,); I about the origin, kg m2, (3, 3)."""

    m: ca.SX
    mc: ca.SX
    I: ca.SX

    @classmethod
    def of(cls, ten: ca.SX) -> "Inertia":
        """The inertia of the ten parameters in the order of `rigid_body.SYMBOLS`."""
        I = ca.vertcat(
            ca.horzcat(ten[4], ten[5], ten[7]), ca.horzcat(ten[5], ten[6], ten[8]), ca.horzcat(ten[7], ten[8], ten[9])
        )
        return cls(ten[0], ten[1:4], I)

    @property
    def ten(self) -> ca.SX:
        """The ten parameters in the order of `rigid_body.SYMBOLS`, shape (10,)."""
        return ca.vertcat(self.m, self.mc, *(self.I[place] for place in LOWER))

    def placed(self, R: ca.SX, p: ca.SX) -> "Inertia":
        """The same body in the parent of its frame, which stands there at R, p."""
        mc = R @ self.mc
        moved = mc + self.m * p
        I = R @ self.I @ R.T + _parallel(p, mc) + _parallel(moved, p)
        return Inertia(self.m, moved, I)

    def __add__(self, other: "Inertia") -> "Inertia":
        """One body of two in the same frame."""
        return Inertia(self.m + other.m, self.mc + other.mc, self.I + other.I)


def joint_frame(joint: Joint, q: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Where the frame of a joint stands in that of the joint before: R, shape (3, 3), and p, m, shape (3,)."""
    R, p = ca.SX(ca.DM(joint.placement.R)), ca.SX(ca.DM(joint.placement.p))
    R, p = ca.sparsify(R), ca.sparsify(p)
    if joint.turns:
        return R @ _turn(joint.axis, q), p
    return R, p + R @ ca.DM(joint.axis) * q


def newton_euler(chain: Chain, rates: Sequence[ca.SX], a: ca.SX, p: ca.SX, gravity: ca.SX) -> ca.SX:
    """Torque H a + C(q, dq) v + g without friction and rotors, N.m, shape (n,).

    Parameters
    ----------
    chain
        Joints and frames.
    rates
        q, dq and v; the last one may be left out where it is dq, which then costs less.
    a
        Accelerations of the joints, shape (n,).
    p
        Parameters as in `Chain.p`; only the bodies' are used.
    gravity
        Acceleration of a falling body in the axes of the base, m/s2, shape (3,).
    """
    q, dq, *rest = rates
    v = rest[0] if rest else None
    frames = [joint_frame(joint, q[i]) for i, joint in enumerate(chain.joints)]
    zero = ca.SX(3, 1)
    state = _Motion(zero, zero, ca.SX(3, 3), zero, -gravity)
    forces: list[tuple[ca.SX, ca.SX]] = []
    for i, (joint, frame) in enumerate(zip(chain.joints, frames, strict=True)):
        state = state.beyond(joint, frame, dq[i], None if v is None else v[i], a[i])
        forces.append(state.wrench(Inertia.of(p[TEN * i : TEN * (i + 1)]), two=v is not None))
    tau: list[ca.SX] = [ca.SX(0)] * chain.n
    f, n = forces[-1]
    for i in reversed(range(chain.n)):
        joint = chain.joints[i]
        tau[i] = ca.dot(ca.DM(joint.axis), n if joint.turns else f)
        if i:
            R, r = frames[i]
            f = R @ f
            n = R @ n + ca.cross(r, f) + forces[i - 1][1]
            f = f + forces[i - 1][0]
    return ca.vertcat(*tau)


def composite_inertia(chain: Chain, q: ca.SX, p: ca.SX) -> ca.SX:
    """Inertia matrix H without rotors, kg m2, shape (n, n).

    Column i has what the joints up to i carry while joint i alone accelerates all bodies beyond it, as one rigid body.
    """
    frames = [joint_frame(joint, q[i]) for i, joint in enumerate(chain.joints)]
    H = ca.SX(chain.n, chain.n)
    total: Inertia | None = None
    for i in reversed(range(chain.n)):
        own = Inertia.of(p[TEN * i : TEN * (i + 1)])
        total = own if total is None else own + total.placed(*frames[i + 1])
        z = ca.DM(chain.joints[i].axis)
        if chain.joints[i].turns:
            f, n = ca.cross(z, total.mc), total.I @ z
        else:
            f, n = total.m * z, ca.cross(total.mc, z)
        for j in reversed(range(i + 1)):
            joint = chain.joints[j]
            H[i, j] = H[j, i] = ca.dot(ca.DM(joint.axis), n if joint.turns else f)
            R, r = frames[j]
            f = R @ f
            n = R @ n + ca.cross(r, f)
    return H


@dataclass(frozen=True)
class _Motion:
    """Motion of a frame in its own axes: rates w and u (of v), dw/dt, K, and the acceleration of the origin."""

    w: ca.SX
    u: ca.SX
    K: ca.SX
    dw: ca.SX
    a: ca.SX

    def beyond(self, joint: Joint, frame: tuple[ca.SX, ca.SX], dq: ca.SX, v: ca.SX | None, ddq: ca.SX) -> "_Motion":
        """Motion of the frame beyond a joint; without v, u is w and is not computed."""
        R, p = frame
        z = ca.DM(joint.axis)
        w, dw, a = R.T @ self.w, R.T @ self.dw, R.T @ (self.a + self.K @ p)
        u = w if v is None else R.T @ self.u
        if joint.turns:
            swing = ca.cross(w, z * dq) if v is None else 0.5 * (ca.cross(w, z * v) + ca.cross(u, z * dq))
            dw = dw + z * ddq + swing
            w = w + z * dq
            u = w if v is None else u + z * v
        else:
            swing = 2 * ca.cross(w, z * dq) if v is None else ca.cross(w, z * v) + ca.cross(u, z * dq)
            a = a + z * ddq + swing
        return _Motion(w, u, _skew(dw) + _centripetal(w, u, two=v is not None), dw, a)

    def wrench(self, body: Inertia, *, two: bool) -> tuple[ca.SX, ca.SX]:
        """Force and moment about the origin that move the body so."""
        f = body.m * self.a + self.K @ body.mc
        if two:
            spin = 0.5 * (ca.cross(self.w, body.I @ self.u) + ca.cross(self.u, body.I @ self.w))
        else:
            spin = ca.cross(self.w, body.I @ self.w)
        return f, body.I @ self.dw + spin + ca.cross(body.mc, self.a)


def _turn(axis: tuple[float, ...], q: ca.SX) -> ca.SX:
    """Rotation by q about a unit vector; about an axis of the frame, four elements depend on q."""
    z = ca.sparsify(ca.DM(axis))
    along = ca.sparsify(z @ z.T)
    return ca.SX(along) + ca.cos(q) * ca.sparsify(ca.DM.eye(3) - along) + ca.sin(q) * ca.sparsify(ca.skew(z))


def _skew(w: ca.SX) -> ca.SX:
    """The matrix [w]x, shape (3, 3): [w]x r = w x r."""
    return ca.vertcat(ca.horzcat(0, -w[2], w[1]), ca.horzcat(w[2], 0, -w[0]), ca.horzcat(-w[1], w[0], 0))


def _centripetal(w: ca.SX, u: ca.SX, *, two: bool) -> ca.SX:
    """The matrix W, shape (3, 3): W r = (w x (u x r) + u x (w x r)) / 2."""
    outer = 0.5 * (w @ u.T + u @ w.T) if two else w @ w.T
    squares = [outer[k, k] for k in range(3)]
    diagonal = ca.vertcat(-squares[1] - squares[2], -squares[0] - squares[2], -squares[0] - squares[1])
    return outer - ca.diag(ca.diag(outer)) + ca.diag(diagonal)


def _parallel(x: ca.SX, y: ca.SX) -> ca.SX:
    """What a moment of inertia gains by a shift: (x . y) E - (x y' + y x') / 2, shape (3, 3), for each of two terms."""
    return ca.dot(x, y) * ca.SX.eye(3) - 0.5 * (x @ y.T + y @ x.T)
