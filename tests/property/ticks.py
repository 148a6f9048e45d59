"""Random ticks of the adaptive controllers' FMUs, and the results of the paper's formulas for them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.driver import Driver, Value
from tests.property.operational import Answer, Gains, Tick, craig, slotine_li
from tests.property.pose import Pose
from tests.property.samples import random_arms
from tests.reference.arm import Arm

CRAIG, SLOTINE_LI, SPONG_ORTEGA = (
    "CraigAdaptiveImpedance",
    "SlotineLiAdaptiveImpedance",
    "SpongOrtegaAdaptiveImpedance",
)
CONTROLLERS = (CRAIG, SLOTINE_LI, SPONG_ORTEGA)
FULL = "Full"  # ends the names of the variants with full matrices
INPUTS = ("q", "dq", "ddq", "F_hat", "x_v", "dx_v", "ddx_v")
SHOWN = {CRAIG: "e_star", SPONG_ORTEGA: "e_star", SLOTINE_LI: "s"}
_ONLY = {
    "K_d": {SLOTINE_LI},
    "acc_filter_time": {SPONG_ORTEGA},
    **{name: {CRAIG, SPONG_ORTEGA} for name in ("noise_bound", "contact_threshold", "gamma_margin", "gamma_eps")},
}


def answer(controller: str, tick: Tick, gains: Gains) -> Answer:
    """What the paper's formulas give for a controller, or for its variant with full matrices."""
    controller = controller.removesuffix(FULL)
    if controller == SLOTINE_LI:
        return slotine_li(tick, gains)
    return craig(tick, gains, fixed=controller == SPONG_ORTEGA)


@dataclass(frozen=True)
class Sample:
    """An arm, a controller's gains, and the inputs of some ticks: arrays by name, one dictionary each."""

    arm: Arm
    gains: Gains
    inputs: list[dict[str, np.ndarray]]

    def with_gains(self, **changes: Any) -> "Sample":
        """The same with other gains."""
        return replace(self, gains=replace(self.gains, **changes))

    def start(self, controller: str) -> dict[str, Value]:
        """Start values of a controller, or of its variant with full matrices."""
        controller = controller.removesuffix(FULL)
        values: dict[str, Value] = {
            "gravity": self.arm.gravity,
            "coulomb_velocity": self.arm.coulomb_velocity,
        }
        values |= elements("l", np.array([self.arm.l1, self.arm.l2]))
        for name, value in vars(self.gains).items():
            if controller in _ONLY.get(name, {controller}):
                values |= elements(name, value) if isinstance(value, np.ndarray) else {name: value}
        return values


def samples(size: int, ticks: int, *, seed: int) -> Iterator[Sample]:
    """Random arms, gains and inputs.

    From tick to tick the arm moves on as if in some 3 ms, and the virtual trajectory stays some millimetres
    and 0.1 m/s away: then 2 mu delta and alpha are of one size, and each of the two is the larger one in many
    ticks. At tick 0 TIRT and virtual trajectory coincide.
    """
    arms, rng = random_arms(2, size, seed=seed, regular=True), np.random.default_rng(seed)
    for i in range(size):
        l1, l2 = arms.l[:, i]
        arm = Arm(float(l1), float(l2), float(arms.gravity[0, i]), float(arms.coulomb_velocity[0, i]))
        inputs, q, dq = [], arms.q[:, i], arms.dq[:, i]
        for _ in range(ticks):
            pose = Pose(arm, q, dq)
            virtual = (
                rng.normal(0, 0.003, 2) + pose.x,
                rng.normal(0, 0.1, 2) + pose.dx,
                rng.normal(0, 20, 2),
            )
            values = (q, dq, rng.uniform(-30, 30, 2), rng.normal(0, 100, 2), *virtual)
            inputs.append(dict(zip(INPUTS, values, strict=True)))
            q, dq = q + rng.normal(0, 0.003, 2), dq + rng.normal(0, 0.1, 2)
        yield Sample(arm, _gains(rng, arms.p[:, i]), inputs)


def full_samples(size: int, ticks: int, *, seed: int) -> Iterator[Sample]:
    """Random samples as above, with full matrices that have different axes each; a row of Gamma stays zero."""
    rng = np.random.default_rng(seed)
    for sample in samples(size, ticks, seed=seed):
        gains = sample.gains
        M, B, K = (_turned(rng, getattr(gains, name)) for name in ("M", "B", "K"))
        Psi = _turned(rng, 0.3 * gains.Psi.mean() * np.ones(2) * rng.uniform(0.7, 1.3, 2))
        factor = np.diag(np.sqrt(gains.Gamma)) @ (np.eye(6) + rng.uniform(-0.3, 0.3, (6, 6)))
        yield sample.with_gains(
            M=M, B=B, K=K, Psi=Psi, K_d=_turned(rng, gains.K_d), Gamma=(factor @ factor.T + (factor @ factor.T).T) / 2
        )


def _turned(rng: np.random.Generator, diagonal: np.ndarray) -> np.ndarray:
    """A symmetric matrix with the eigenvalues `diagonal` and axes that are turned by up to 0.3 rad."""
    angle = rng.uniform(-0.3, 0.3)
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return R @ np.diag(diagonal) @ R.T


def _gains(rng: np.random.Generator, p: np.ndarray) -> Gains:
    """Random gains; p_hat starts at p and moves by some per cent in a tick. One gain is zero."""
    Gamma = rng.uniform(0.2, 2.0, 6)
    Gamma[rng.integers(6)] = 0.0
    M, B = rng.uniform(0.5, 5, 2), rng.uniform(300, 600, 2)
    return Gains(
        M=M,
        B=B,
        K=rng.uniform(500, 8000, 2),
        Psi=rng.uniform(0.2, 0.95, 2) * B / M,
        K_d=rng.uniform(10, 300, 2),
        Gamma=Gamma,
        p_start=p,
        noise_bound=float(rng.uniform(20, 200)),
        contact_threshold=100.0,  # about half of the forces exceed it
        gamma_margin=float(rng.uniform(1, 2)),
        gamma_eps=float(rng.choice([1e-4, 0.1])),
        acc_filter_time=float(rng.uniform(0, 3e-4)),
        sample_time=1e-4,
    )


def elements(name: str, values: np.ndarray) -> dict[str, float]:
    """``name[1]``, ``name[2]``, ... with their values; ``name[1,1]``, ``name[1,2]``, ... of a matrix."""
    if values.ndim == 2:
        return {f"{name}[{i + 1},{j + 1}]": float(value) for (i, j), value in np.ndenumerate(values)}
    return {f"{name}[{i + 1}]": float(value) for i, value in enumerate(values)}


def show(driver: Driver, name: str) -> np.ndarray:
    """A vector, or a scalar as shape (1,), as the FMU shows it."""
    names = [v for v in driver.variables if v == name or v.startswith(f"{name}[")]
    return driver.get(*names)


def feed(driver: Driver, inputs: dict[str, np.ndarray], k: int, h: float) -> None:
    """Set a tick's inputs and make it step k of size h."""
    for name, values in inputs.items():
        driver.set(elements(name, values))
    driver.step(k * h, h)


def seen(driver: Driver, sample: Sample, inputs: dict[str, np.ndarray], a_f: np.ndarray) -> Tick:
    """The tick that a controller has just shown; x_t, dx_t and p_hat as it shows them."""
    pose = Pose(sample.arm, inputs["q"], inputs["dq"])
    rest = {name: inputs[name] for name in INPUTS[2:]}
    return Tick(pose, **rest, **{name: show(driver, name) for name in ("x_t", "dx_t", "p_hat")}, a_f=a_f)


def run(driver: Driver, controller: str, sample: Sample, **more: Value) -> Iterator[Tick]:
    """Go through a sample's ticks, the driver showing each; then reset. `more` are further start values."""
    h = sample.gains.sample_time
    driver.initialize(sample.start(controller) | more)
    a_f, share = sample.inputs[0]["ddq"], h / (sample.gains.acc_filter_time + h)
    for k, inputs in enumerate(sample.inputs):
        a_f = a_f + share * (inputs["ddq"] - a_f)
        feed(driver, inputs, k, h)
        yield seen(driver, sample, inputs, a_f)
    driver.call("fmi2Reset")
