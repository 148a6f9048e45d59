"""A linear step map from its pulse responses: the eigensystem realization algorithm.

A unit with inputs u over a step, x the deviation of its state and y what it shows at the end:

    x+ = A x + B u          y+ = C x + D u          H_0 = D,   H_j = C A^(j-1) B,  j = 1, 2, ...

The Markov parameters H_j are the responses to a pulse of one step. With the Hankel matrices of s x s
blocks G = [H_(i+j+1)] and G' = [H_(i+j+2)], i, j = 0, ..., s - 1, and G = U S V^T,

    A = S^-1/2 U^T G' V S^-1/2      B = first columns of S^1/2 V^T      C = first rows of U S^1/2

(J.-N. Juang, R. S. Pappa, "An eigensystem realization algorithm for modal parameter identification
and model reduction", J. Guidance 8(5), 1985). Outputs and inputs are scaled first, so that metres
and newtons compare. A singular value counts if it exceeds the largest that errors can have: the
Frobenius norm of a Hankel matrix whose every entry is as wrong as noise or drift allow.
"""

from dataclasses import dataclass, replace

import numpy as np

ROUNDING = 16 * np.finfo(float).eps  # of the singular value decomposition, relative to the largest


@dataclass(frozen=True)
class Pulses:
    """Responses of a unit to pulses.

    Attributes
    ----------
    H
        Markov parameters, output unit per input unit, shape (2 s + 1, n_outputs, n_inputs); exactly zero
        where nothing but noise was seen.
    noise
        How wrong those that are not zero may be: H_0, and all others, shape (2, n_outputs, n_inputs).
    later
        The same parameters by pulses s steps later, shape of `H`: a unit that moves has changed.
    """

    H: np.ndarray
    noise: np.ndarray
    later: np.ndarray

    def shaken(self, random: np.random.Generator) -> "Pulses":
        """The same, every number changed by as much as its noise."""
        noise = random.standard_normal(self.H.shape)
        noise[0] *= self.noise[0]
        noise[1:] *= self.noise[1]
        return replace(self, H=np.where(self.H == 0, 0, self.H + noise))


@dataclass(frozen=True)
class Realization:
    """A, B, C, D of the module's equations.

    Attributes
    ----------
    A, B, C, D
        Shapes (n, n), (n, n_inputs), (n_outputs, n), (n_outputs, n_inputs).
    full
        Whether n reaches half of what the Hankel matrix can show: more steps may show more states.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    full: bool = False

    def pulses(self, n: int) -> np.ndarray:
        """Markov parameters H_0 to H_(n-1), shape (n, n_outputs, n_inputs)."""
        H, state = [self.D], self.B
        for _ in range(n - 1):
            H.append(self.C @ state)
            state = self.A @ state
        return np.array(H)


def realize(pulses: Pulses, order: int | None = None) -> Realization:
    """The smallest step map with these responses.

    Parameters
    ----------
    order
        Number of states; what the noise lets be seen if None.
    """
    H = pulses.H
    s = (H.shape[0] - 1) // 2
    n_outputs, n_inputs = H.shape[1:]
    if H[1:].size == 0:
        return Realization(np.zeros((0, 0)), np.zeros((0, n_inputs)), np.zeros((n_outputs, 0)), H[0])
    drift = np.abs(pulses.later[1:] - H[1:]).max(axis=0)
    noise = np.where(H[1:].any(axis=0), np.maximum(pulses.noise[1], drift), 0)
    rows, columns = _scales(H[1:])
    scaled = H[1:] / (rows[:, None] * columns)
    G, shifted = _hankel(scaled[:-1], s), _hankel(scaled[1:], s)
    U, S, V = np.linalg.svd(G)
    if order is None:
        floor = np.linalg.norm(noise / (rows[:, None] * columns)) * s
        order = int((S > max(floor, ROUNDING * S[0] * max(G.shape))).sum())
    root = np.sqrt(S[:order])
    U, V = U[:, :order], V[:order]
    return Realization(
        A=(U / root).T @ shifted @ (V.T / root),
        B=(root[:, None] * V)[:, :n_inputs] * columns,
        C=rows[:, None] * (U * root)[:n_outputs],
        D=H[0],
        full=order > min(G.shape) // 2,
    )


def _scales(H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest magnitude of each output, then of each input so scaled; 1 for those that are all zero."""
    peak = np.abs(H).max(axis=0)
    rows = peak.max(axis=1)
    rows[rows == 0] = 1
    columns = (peak / rows[:, None]).max(axis=0)
    columns[columns == 0] = 1
    return rows, columns


def _hankel(H: np.ndarray, s: int) -> np.ndarray:
    """Blocks H_(i+j), shape (s n_outputs, s n_inputs)."""
    return np.block([[H[i + j] for j in range(s)] for i in range(s)])
