"""The eigensystem realization algorithm: a linear state-space model from measured pulse responses.

The model describes one step of a component. Its state x and inputs u are deviations from the operating
point. Its outputs y are taken at the end of the step:

    x+ = A x + B u          y+ = C x + D u          H_0 = D,   H_j = C A^(j-1) B,  j = 1, 2, ...

The Markov parameters H_j are the responses to a pulse of one step. The Hankel matrices
G = [H_(i+j+1)] and G' = [H_(i+j+2)], i, j = 0, ..., s - 1, have s x s blocks. G has the singular value
decomposition G = U S V^T. The matrices of the model follow from the largest singular values:

    A = S^-1/2 U^T G' V S^-1/2      B = first columns of S^1/2 V^T      C = first rows of U S^1/2

(J.-N. Juang, R. S. Pappa, "An eigensystem realization algorithm for modal parameter identification
and model reduction", J. Guidance 8(5), 1985). Outputs and inputs are scaled first, so that metres
and newtons compare. A singular value counts as a state if it exceeds the largest singular value that
errors alone can have. The Frobenius norm of a Hankel matrix of the errors bounds that largest value.
"""

from dataclasses import dataclass, replace

import numpy as np

ROUNDING = 16 * np.finfo(float).eps  # of the singular value decomposition, relative to the largest singular value


@dataclass(frozen=True)
class Pulses:
    """Measured responses of one component to pulses at its inputs.

    Attributes
    ----------
    H
        Markov parameters, unit of the output per unit of the input, shape (2 s + 1, n_outputs, n_inputs).
        A response that is smaller than its noise is stored as exactly zero.
    noise
        Bounds on the errors of H_0 and of all later parameters, shape (2, n_outputs, n_inputs).
    later
        Markov parameters measured with the pulse s steps later, shape of `H`. They differ from `H` where
        the component moves during the experiment.
    """

    H: np.ndarray
    noise: np.ndarray
    later: np.ndarray

    def shaken(self, random: np.random.Generator) -> "Pulses":
        """Responses with random errors of the size of the noise added; exact zeros stay zero."""
        noise = random.standard_normal(self.H.shape)
        noise[0] *= self.noise[0]
        noise[1:] *= self.noise[1]
        return replace(self, H=np.where(self.H == 0, 0, self.H + noise))


@dataclass(frozen=True)
class Realization:
    """A linear state-space model of one step: x+ = A x + B u, y+ = C x + D u.

    Attributes
    ----------
    A, B, C, D
        Matrices of shapes (n, n), (n, n_inputs), (n_outputs, n), (n_outputs, n_inputs).
    full
        Whether n exceeds half of the number of states that the Hankel matrix can show. Longer responses
        may then show more states.
    hidden
        Number of states that the noise would let be seen, but not the drift: the component moves too much meanwhile.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    full: bool = False
    hidden: int = 0

    def pulses(self, n: int) -> np.ndarray:
        """Markov parameters H_0 to H_(n-1), shape (n, n_outputs, n_inputs)."""
        H, state = [self.D], self.B
        for _ in range(n - 1):
            H.append(self.C @ state)
            state = self.A @ state
        return np.array(H)


def realize(pulses: Pulses, order: int | None = None) -> Realization:
    """Find the smallest linear model that has the measured pulse responses.

    Parameters
    ----------
    pulses
        Measured responses.
    order
        Number of states. Default: the number of singular values that exceed the noise.

    Returns
    -------
    Realization
        Model in balanced coordinates, by the method of Juang and Pappa (1985).
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
    weights, rounding = s / (rows[:, None] * columns), ROUNDING * S[0] * max(G.shape)
    seen, still = (
        int((S > max(np.linalg.norm(errors * weights), rounding)).sum()) for errors in (noise, pulses.noise[1])
    )
    order = seen if order is None else order
    root = np.sqrt(S[:order])
    U, V = U[:, :order], V[:order]
    return Realization(
        A=(U / root).T @ shifted @ (V.T / root),
        B=(root[:, None] * V)[:, :n_inputs] * columns,
        C=rows[:, None] * (U * root)[:n_outputs],
        D=H[0],
        full=order > min(G.shape) // 2,
        hidden=max(0, still - seen),
    )


def _scales(H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Scales of outputs and inputs: the largest magnitudes of their responses, or 1 where all are zero."""
    peak = np.abs(H).max(axis=0)
    rows = peak.max(axis=1)
    rows[rows == 0] = 1
    columns = (peak / rows[:, None]).max(axis=0)
    columns[columns == 0] = 1
    return rows, columns


def _hankel(H: np.ndarray, s: int) -> np.ndarray:
    """Hankel matrix with the blocks H_(i+j), shape (s n_outputs, s n_inputs)."""
    return np.block([[H[i + j] for j in range(s)] for i in range(s)])
