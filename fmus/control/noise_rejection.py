"""The control force F_c that suppresses the sensor's noise, eqs. (17) to (26).

    V_c = X' P X + phi' Gamma^-1 phi,   X = (e, de) per axis,   e* = de + Psi e
    F_c = -(gamma/2) H_hat_x e*                                                        (22)
    gamma = gamma_margin max(0, (2 mu delta - alpha) / (beta^2 + gamma_eps^2))         (25)
    alpha = X' Q X,  beta = |e*|,  mu = |H_hat_x^-1 e*|

with Q = diag(2 psi k, 2 (b - psi)) per axis, k = K/M, b = B/M (A2). As printed, (25) is a sliding
term that stays as large as delta cond(H_hat_x) while beta goes to zero and chatters at the sampling
rate; gamma_eps gives it a boundary layer. delta = noise_bound acts while the measured force exceeds
contact_threshold.

Where coordinates are angles, these equations hold in coordinates that are all in metres: S e with S = diag(1, ..., L),
forces S^-1 F and the mobility S H_hat_x^-1 S. Then V_c adds up squares of one unit,

    alpha = sum of s_i^2 Q_i (e_i^2, de_i^2),  beta = |S e*|,  mu = |S H_hat_x^-1 S^2 e*|

(19) has S^2 e* in the place of e*, and F_c is as above.

For full matrices k = M^-1 K and b = M^-1 B are no longer symmetric, and P b = c' of (A2) leaves open the first
block of P alone. With its symmetric part as that block,

    P = [ sym(Psi b + k'), Psi ; Psi, I ],   Q = [ Psi k + k' Psi, S ; S', b + b' - 2 Psi ],   S = skew(Psi b + k')

where sym and skew are the symmetric and the skew part. alpha = X' Q X is then exactly -d(X' P X)/dt along
e'' + b e' + k e = 0, and eqs. (17) to (26) hold as printed. P and Q must be positive definite, which is sufficient
for strict positive realness and not necessary; gains for which they are not are refused. If M, B, K and Psi have common
axes, S = 0 and the condition is the paper's, 0 < psi < b along each axis.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Formula, Formulas, Limits
from fmus.control.adaptation import Adaptation
from fmus.control.controller import Controller
from fmus.control.full_tirt import FullImpedance
from fmus.control.gains import require_definite
from fmus.elements import of_task
from fmus.mechanics.algebra import spectral_norm

FORMULAS = Formulas(
    "Rejection of the sensor's noise",
    [
        Formula(r"e^{*} = \dot{e} + \Psi e", "The augmented error.", "14"),
        Formula(r"F_c = -\frac{\gamma}{2} \hat{H}_x e^{*}", "A force against the noise.", "22"),
        Formula(
            r"\gamma = \gamma_m \max\left( 0, \; \frac{2\mu\delta - \alpha}{\beta^2 + \varepsilon^2} \right)",
            "Its gain, with the factor gamma_margin; gamma_eps, written as epsilon, keeps the gain finite.",
            "25",
        ),
        Formula(
            r"\alpha = X^{T} Q X, \quad \beta = \|e^{*}\|, \quad \mu = \|\hat{H}_x^{-1} e^{*}\|, \quad"
            r" X = (e, \dot{e})",
            "The numbers in the gain.",
            "23",
        ),
    ],
)


@dataclass(frozen=True)
class NoiseRejection:
    """Values of eqs. (23) to (26) at a tick.

    Attributes
    ----------
    e_star
        Augmented error, m/s or rad/s, shape (m,).
    weighted
        S^2 e*, which (19) multiplies; e* itself where there are no angles.
    alpha, beta, mu, gamma, gamma_bound
        As in the paper; m2/s3, m/s, m/(kg s), 1/s, 1/s.
    """

    e_star: ca.SX
    weighted: ca.SX
    alpha: ca.SX
    beta: ca.SX
    mu: ca.SX
    gamma: ca.SX
    gamma_bound: ca.SX

    def acceleration(self) -> ca.SX:
        """Tip acceleration -(gamma/2) e* that F_c = H_hat_x times it gives, m/s2, shape (m,)."""
        return -0.5 * self.gamma * self.e_star


def declare_noise_rejection(adaptation: Adaptation, mobility: ca.SX) -> NoiseRejection:
    """Declare the parameters of F_c and evaluate the gain gamma.

    Parameters
    ----------
    mobility
        H_hat_x^-1 = J H_hat^-1 J', of positions 1/kg, shape (m, m).
    """
    controller, metric = adaptation.controller, adaptation.metric
    model = controller.model
    noise_bound = model.parameter(
        "noise_bound",
        0.0,
        unit="N",
        limits=NOT_NEGATIVE,
        tunable=True,
        description="Bound delta of the force sensor's error that F_c rejects, eq. (21)",
    )
    threshold = model.parameter(
        "contact_threshold",
        0.0,
        unit="N",
        limits=NOT_NEGATIVE,
        description="Measured force above which noise_bound acts",
    )
    margin = model.parameter(
        "gamma_margin",
        1.5,
        limits=Limits(1.0),
        tunable=True,
        description="Factor on the right side of eq. (25)",
    )
    eps = model.parameter(
        "gamma_eps",
        1e-4,
        unit="m/s",
        limits=POSITIVE,
        tunable=True,
        description="Width of the boundary layer of eq. (25); enters as its square",
    )
    e, de = controller.e, controller.dx - controller.dx_t
    e_star = adaptation.filtered_error()
    in_contact = ca.norm_2(metric.force(controller.measured.F_hat)) > threshold
    # The sensor's error is one of a wrench; the force of the coordinates may have a larger one.
    delta = ca.if_else(in_contact, controller.arm.wrench_gain(controller.measured.q) * noise_bound, 0)
    alpha = _alpha(adaptation, e, de)
    scaled, mobility = metric.motion(e_star), metric.mobility(mobility)
    beta, mu = ca.norm_2(scaled), ca.norm_2(ca.mtimes(mobility, scaled))
    excess = 2 * mu * delta - alpha
    gamma = margin * ca.fmax(0, excess / (beta**2 + eps**2))
    gamma_bound = _gamma_bound(alpha, beta, excess, delta, spectral_norm(mobility))
    return NoiseRejection(e_star, metric.motion(scaled), alpha, beta, mu, gamma, gamma_bound)


def declare_outputs(rejection: NoiseRejection, adaptation: Adaptation, F_c: ca.SX) -> None:
    """Declare the outputs that the theory of algorithm 1 speaks about."""
    controller = adaptation.controller
    model, task = controller.model, controller.arm.task
    text = "Augmented error de + Psi e, eq. (14),"
    e_star = controller.in_base(rejection.e_star)
    model.output("e_star", e_star, unit=task.each("m/s", "rad/s"), description=of_task(text, task))
    for name, unit, text in (
        ("alpha", "m2/s3", "X' Q X, eq. (23)"),
        ("beta", "m/s", "Norm of e_star, eq. (23)"),
        ("mu", "m/kg.s", "Norm of the inverse inertia times e_star, eq. (23)"),
        ("gamma", "1/s", "Gain of F_c, eq. (25)"),
        ("gamma_bound", "1/s", "gamma* of eq. (26) where it bounds the right side of (25), else 0"),
    ):
        model.output(name, getattr(rejection, name), unit=unit, description=text, scalar=True)
    text = "Control {} against the sensor's noise, eq. (22),"
    texts = of_task(text.format("force"), task, text.format("moment"))
    model.output("F_c", controller.in_base(F_c), unit=task.each("N", "N.m"), description=texts)


def _alpha(adaptation: Adaptation, e: ca.SX, de: ca.SX) -> ca.SX:
    """X' Q X of eq. (23), m2/s3, and the demands on the gains that make P and Q positive definite."""
    controller, psi = adaptation.controller, adaptation.Psi
    impedance = controller.impedance
    if isinstance(impedance, FullImpedance):
        return _full_alpha(controller, impedance, psi, ca.vertcat(e, de))
    k, b = impedance.K / impedance.M, impedance.B / impedance.M
    for i in range(e.numel()):
        controller.model.require(
            b[i] - psi[i],
            f"Psi[{i + 1}] must be below B[{i + 1}]/M[{i + 1}] (strict positive realness, eq. (14))",
        )
    e, de = adaptation.metric.motion(e), adaptation.metric.motion(de)
    return ca.sum1(2 * psi * k * e**2 + 2 * (b - psi) * de**2)


def _full_alpha(controller: Controller, impedance: FullImpedance, psi: ca.SX, X: ca.SX) -> ca.SX:
    """X' Q X for full matrices; see the module's docstring."""
    b, k = impedance.b, impedance.k
    product = ca.mtimes(psi, b) + k.T
    skew = 0.5 * (product - product.T)
    P = ca.blockcat([[0.5 * (product + product.T), psi], [psi, ca.SX.eye(psi.shape[0])]])
    stiffness = ca.mtimes(psi, k)
    Q = ca.blockcat([[stiffness + stiffness.T, skew], [skew.T, b + b.T - 2 * psi]])
    advice = "strict positive realness, eq. (14), is not certain; reduce Psi, or give M, B, K and Psi common axes"
    require_definite(controller.model, Q, f"Q of eq. (A2) must be positive definite: {advice}")
    require_definite(controller.model, P, f"P of eq. (A2) must be positive definite: {advice}")
    return ca.bilin(Q, X, X)


def _gamma_bound(alpha: ca.SX, beta: ca.SX, excess: ca.SX, delta: ca.SX, norm: ca.SX) -> ca.SX:
    """gamma* of eq. (26) in case (c), delta > 0 and 0 < alpha <= 2 mu delta; else 0."""
    bound = 4 * delta**2 * norm**2 * (2 * beta * delta * norm - alpha) / alpha**2
    case_c = ca.logic_and(delta > 0, ca.logic_and(alpha > 0, excess >= 0))
    return ca.if_else(case_c, ca.fmax(0, bound), 0)
