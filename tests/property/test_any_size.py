"""The laws for six joints and six task coordinates: a pair of arms gives what each arm alone gives.

All matrices of the pair are solved with six rows, by the generic methods of `fmus.mechanics.algebra`.
"""

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import SampledModel
from fmus.control.gain_units import gain_units, product_unit
from fmus.craig_adaptive_impedance import craig_adaptive_impedance
from fmus.force_sensor import force_sensor
from fmus.hogan_impedance import MOBILITY, hogan_impedance
from fmus.mechanics.task import Task
from fmus.plant import plant
from fmus.slotine_li_adaptive_impedance import slotine_li_adaptive_impedance
from fmus.spong_ortega_adaptive_impedance import spong_ortega_adaptive_impedance
from tests.property.definitions import outputs_of
from tests.property.twins import FIRST, ONE, SECOND, TwinRobot

SIZE = 200
AGREEMENT = 1e-10  # of the largest element; cond(J)^2 cond(H) of these samples is below 1e4
Columns = dict[str, np.ndarray]
LAWS: dict[str, Callable[..., SampledModel]] = {
    "form (6)": lambda robot: hogan_impedance(robot, "Law"),
    "form (5)": lambda robot: hogan_impedance(robot, "Law", form=MOBILITY),
    "algorithm 1": lambda robot: craig_adaptive_impedance("Law", robot),
    "algorithm 1, one inverse": lambda robot: spong_ortega_adaptive_impedance("Law", robot),
    "algorithm 2": lambda robot: slotine_li_adaptive_impedance("Law", robot),
}
JOINTS, TASK, PARAMETERS = (
    ("q", "dq", "ddq", "l", "a_f"),
    ("F_hat", "x_v", "dx_v", "ddx_v", "x_t", "dx_t"),
    ("p_hat", "phi_hat"),
)


def drawn() -> Columns:
    """States and inputs of the pair near the start values, by name, shape (k, SIZE)."""
    rng, begin = np.random.default_rng(66), TwinRobot().start
    scale = np.array([1, 1, 1, 1, 7, 7])[:, None]
    given = {"q": np.array(begin.q)[:, None] + rng.uniform(-0.4, 0.4, (6, SIZE)), "dq": rng.uniform(-3, 3, (6, SIZE))}
    given |= {"ddq": rng.uniform(-20, 20, (6, SIZE)), "a_f": rng.uniform(-20, 20, (6, SIZE))}
    given |= {"F_hat": rng.normal(0, 100, (6, SIZE)) / scale, "l": rng.uniform(0.8, 1.2, (6, SIZE))}
    arm = outputs_of(lambda: plant(TwinRobot(), "Pair"), **{name: given[name] for name in ("q", "dq", "l")}, **_modes())
    for name, at, width in (("x", arm["x"].T, 0.003), ("dx", arm["dx"].T, 0.1)):
        for end in ("v", "t"):
            given[f"{name}_{end}"] = at + width / 7 * scale * rng.normal(size=(6, SIZE))
    given["ddx_v"] = 20 * rng.normal(size=(6, SIZE))
    given["p_hat"] = rng.uniform(0.5, 2, (18, SIZE))
    given["phi_hat"] = rng.uniform(-0.2, 0.2, (18, SIZE))
    return given


def _modes() -> Columns:
    return {"mode_contact": np.zeros((1, SIZE)), "mode_pushing": np.zeros((1, SIZE))}


def halves(given: Columns) -> list[Columns]:
    """What each arm alone is given."""
    parts: list[Columns] = []
    for i, task in enumerate((FIRST, SECOND)):
        rows = {3: list(range(3 * i, 3 * i + 3)), 9: list(range(9 * i, 9 * i + 9))}
        parts.append(
            {name: values[list(task) if name in TASK else rows[values.shape[0] // 2]] for name, values in given.items()}
        )
    return parts


def law_of(robot, law: str, given: Columns) -> Columns:
    """Outputs of a law, with those states alone that it has."""
    states = {"p_hat": ("algorithm 1", "algorithm 2"), "phi_hat": ("algorithm 1, one inverse",)}
    states |= {"a_f": ("algorithm 1, one inverse",), "ddq": tuple(LAWS), "noise_bound": ()}
    kept = {name: values for name, values in given.items() if law in states.get(name, (law,))}
    return outputs_of(
        lambda: LAWS[law](robot), gravity=np.full((1, SIZE), 9.81), coulomb_velocity=np.full((1, SIZE), 0.1), **kept
    )


@pytest.mark.parametrize("law", LAWS)
def test_a_pair_of_arms_is_controlled_as_each_arm_alone(law: str) -> None:
    given = drawn()
    pair, alone = law_of(TwinRobot(), law, given), [law_of(ONE, law, half) for half in halves(given)]
    for name in ("tau_cmd", *(["p_hat_next"] if law in ("algorithm 1", "algorithm 2") else [])):
        expected = np.hstack([shown[name] for shown in alone])
        miss = np.abs(pair[name] - expected).max(axis=1)
        assert (miss <= AGREEMENT * np.abs(expected).max(axis=1)).all(), name
    if "algorithm 1" in law:
        # Norms of both arms together, (23): squares add up.
        for name, power in (("alpha", 1), ("beta", 2), ("mu", 2)):
            both = sum(shown[name] ** power for shown in alone)
            np.testing.assert_allclose(pair[name] ** power, both, rtol=1e-9)


def test_a_pair_of_plants_moves_as_each_alone() -> None:
    given = {name: values for name, values in drawn().items() if name in ("q", "dq", "l")}
    tau = np.random.default_rng(1).normal(0, 50, (6, SIZE))
    pair = outputs_of(lambda: plant(TwinRobot(), "Pair"), tau=tau, **given, **_modes())["ddq"]
    alone = [
        outputs_of(lambda: plant(ONE, "One"), tau=half.pop("ddq"), **half, **_modes())["ddq"]
        for half in halves({**given, "ddq": tau})
    ]
    np.testing.assert_allclose(pair, np.hstack(alone), rtol=0, atol=AGREEMENT * np.abs(pair).max())


def test_parameters_that_may_be_negative_start_and_are_bounded_below_zero() -> None:
    """As products of mass and place of a link are in space."""
    signed = tuple(replace(p, unit="kg.m", signed=True) if p.unit == "kg" else p for p in TwinRobot.parameters)
    model = craig_adaptive_impedance("Law", replace(TwinRobot(), parameters=signed))
    variables = {variable.name: variable for variable in model.variables}
    assert variables["p_start[1]"].minimum == -np.inf
    assert [variables[f"p_min[{i}]"].start for i in (1, 18)] == [-1e9, 0.0]
    assert variables["Gamma[1]"].unit == "kg2.s2"
    texts = [check.sentence for check in model.checks]
    assert any("inertial parameters p_hat[1] to p_hat[6]" in text for text in texts)


def test_a_sensor_of_forces_and_moments_in_space_draws_three_pairs_within_its_bound() -> None:
    sensor = force_sensor("Sensor", Task(positions=3, angles=3))
    assert sensor.noise is not None
    names = [variable.name for variable in sensor.variables if variable.role.is_parameter]
    given = {"noise_std": 8.0, "noise_bound": 15.0, "L": 0.2}
    values = [given.get(name, 0.0) for name in names]
    noise = ca.Function("noise", [sensor.noise.uniforms, ca.vertcat(*sensor.parameter_symbols)], [sensor.noise.value])
    uniforms = np.random.default_rng(4).random((4, 20_000))
    drawn = np.array(noise.map(20_000)(uniforms, np.tile(np.array(values)[:, None], 20_000)))
    newtons = drawn / np.array([1, 1, 1, 0.2, 0.2, 0.2])[:, None]
    lengths = np.linalg.norm(newtons, axis=0)
    assert 0.8 * 15 < lengths.max() <= 15 * (1 + 1e-14)
    spread = newtons.std(axis=1)
    # Five standard errors of a standard deviation of 20000 values, and of a correlation.
    assert np.abs(spread / spread.mean() - 1).max() < 5 / np.sqrt(2 * 20_000)
    correlation = np.corrcoef(newtons) - np.eye(6)
    assert np.abs(correlation).max() < 5 / np.sqrt(20_000)


@pytest.mark.parametrize(
    ("units", "product"),
    [
        (("kg", "kg", "s2/m2"), "kg2.s2/m2"),
        (("kg", "N.m.s/rad", "s2/m2"), "kg.N.s3/m.rad"),
        (("kg", "N.m.s/rad", "1/N.m"), "kg.s/rad"),
        (("kg", "kg", "1/N.m"), "kg.s2/m2"),
        (("kg.m2", "kg.m", "1/N.m"), "kg.m.s2"),
        (("kg.m2", "kg", "s2/m2"), "kg2.s2"),
        (("N.m", "1/N.m"), ""),
        (("m", "1/m.s"), "1/s"),
    ],
)
def test_units_of_products(units: tuple[str, ...], product: str) -> None:
    assert product_unit(*units) == product


def test_a_gain_has_the_unit_of_its_two_parameters() -> None:
    units = gain_units(["kg", "N.m"], "1/N.m")
    assert units == [["kg.s2/m2", "kg"], ["kg", "N.m"]]
