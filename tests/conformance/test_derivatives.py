"""Tests of rule 16: input derivatives, output derivatives and directional derivatives against differences."""

import ctypes as ct
from collections.abc import Callable

import numpy as np
import pytest

from fmus.catalog import MODELS
from tests.conformance.binary import ERROR, OK, Binary, Instance, array

Load = Callable[[str], Binary]
Create = Callable[..., Instance]
EPS = np.finfo(float).eps

# Central differences with steps of d times the size of the variable: truncation d^2 times third
# derivatives, rounding EPS / d, both about 1e-9 at d = 1e-5, times what the laws amplify (1 / link
# length, 1 / mass, gains): measured at most 1e-7 of the largest derivative of an output.
STEP = 1e-5
TOLERANCE = 2e-6

# A state in which nothing is at a kink: the tip in the wall and sliding, noise, saturation of one joint.
MOVED = {
    "F_ext[1]": -40.0,
    "F_ext[2]": 3.0,
    "F_hat[1]": -40.0,
    "F_hat[2]": 3.0,
    "q[1]": -0.7,
    "dq[2]": 0.2,
    "x_v[2]": 0.01,
    "tau[1]": 5.0,
    "tau_cmd[1]": 150.0,
    "tau_cmd[2]": 5.0,
    "tau_max[1]": 100.0,
    "noise_std": 3.0,
    "noise_bound": 9.0,
    "wall_offset": -1.6,
    "gravity": 9.81,
    "coulomb[1]": 0.3,
    "mu": 0.2,
    "D_f": 0.1,
}


@pytest.fixture(params=list(MODELS))
def identifier(request: pytest.FixtureRequest) -> str:
    """Name of each FMU in turn; the container provides no derivatives."""
    return request.param


def moved(binary: Binary) -> dict[str, float]:
    """Those of `MOVED` that the FMU has, and parameters that start at their bound moved off it."""
    starts = binary.starts("input", "parameter")
    bounded = {
        name: starts[name] + 0.1
        for name in binary.names("parameter", type="Real")
        if (least := binary.variables[name].min) is not None and starts[name] == float(least)
    }
    return bounded | {name: value for name, value in MOVED.items() if name in binary.names("input", "parameter")}


def directional(instance: Instance, unknowns: list[str], known: str) -> np.ndarray:
    """Derivatives of the unknowns along one known variable."""
    result = array(ct.c_double, [0.0] * len(unknowns))
    status = instance.call(
        "fmi2GetDirectionalDerivative",
        instance.references(*unknowns),
        len(unknowns),
        instance.references(known),
        1,
        array(ct.c_double, [1.0]),
        result,
    )
    assert status == OK, instance.last
    return np.array(result)


def start_of(binary: Binary, name: str) -> float:
    """The value that `moved` or the description gives a variable."""
    return moved(binary).get(name, binary.starts("input", "parameter")[name])


def differences(create: Create, binary: Binary, unknowns: list[str], known: str) -> np.ndarray:
    """Central differences of the outputs in initialization mode."""
    value = start_of(binary, known)
    step = STEP * max(1e-3, abs(value))
    shown = []
    for sign in (-1, 1):
        instance = create(binary, start={**moved(binary), known: value + sign * step}).enter()
        shown.append(instance.get(*unknowns))
    return (shown[1] - shown[0]) / (2 * step)


def differentiable(binary: Binary) -> list[str]:
    """Known variables at which the outputs are smooth, and which leave the wall's normal a unit vector."""
    fixed = ("wall_normal[1]", "wall_normal[2]", "dt_max")
    names = binary.names("input", type="Real") + binary.names("parameter", type="Real")
    return [name for name in names if name not in fixed]


def test_16_directional_derivatives_during_initialization(binary: Binary, create: Create) -> None:
    unknowns = binary.names("output", type="Real")
    instance = create(binary, start=moved(binary)).enter()
    scale = np.zeros(len(unknowns))
    found = {}
    for known in differentiable(binary):
        found[known] = directional(instance, unknowns, known), differences(create, binary, unknowns, known)
        scale = np.maximum(scale, np.abs(found[known][1]) * max(1e-3, abs(start_of(binary, known))))
    assert any(np.any(exact) for exact, _ in found.values())
    for known, (exact, approximate) in found.items():
        size = max(1e-3, abs(start_of(binary, known)))
        miss = np.abs(exact - approximate) * size
        assert (miss <= TOLERANCE * (scale + 1e-3)).all(), (known, unknowns[int(miss.argmax())], miss.max())


def test_16_directional_derivatives_between_steps(binary: Binary, create: Create) -> None:
    """Of a continuous FMU the direct feedthrough; of a sampled one zero, since its outputs belong to the tick."""
    unknowns, knowns = binary.names("output", type="Real"), binary.names("input", type="Real")
    instance = create(binary, start=moved(binary)).initialize()
    assert instance.step(1e-4) == OK
    continuous = binary.interpolates
    for known in knowns:
        exact = directional(instance, unknowns, known)
        if not continuous:
            assert not exact.any()
            continue
        # Only ddq feels tau at once, linearly: two short steps with other torques differ by that.
        blob, shown, step = instance.blob(), [], 1.0
        for sign in (-1, 1):
            assert instance.restore(blob) == OK
            instance.set({known: start_of(binary, known) + sign * step})
            assert instance.step(1e-9) == OK
            shown.append(instance.get(*unknowns))
        assert instance.restore(blob) == OK
        approximate = (shown[1] - shown[0]) / (2 * step)
        # In 1e-9 s the torque moves dx by 2.5e-10 m/s, and friction over 1e-2 m/s by up to 1e4 times that.
        np.testing.assert_allclose(exact, approximate, rtol=1e-6, atol=1e-5)
        assert exact.any()


def test_16_unknown_and_known_variables_are_checked(binary: Binary, create: Create) -> None:
    instance = create(binary).initialize()
    output, parameter = binary.names("output", type="Real")[0], binary.names("parameter", type="Real")[0]
    one, place = array(ct.c_double, [1.0]), array(ct.c_double, [7.0])
    for unknown, known in ((parameter, output), (output, output), (output, parameter)):
        status = instance.call(
            "fmi2GetDirectionalDerivative",
            instance.references(unknown),
            1,
            instance.references(known),
            1,
            one,
            place,
        )
        assert status == ERROR
        assert "fmi2GetDirectionalDerivative" in instance.last
    assert place[0] == 7.0


def rates(instance: Instance, names: list[str]) -> np.ndarray:
    """First derivatives of outputs in time."""
    values = array(ct.c_double, [0.0] * len(names))
    orders = array(ct.c_int, [1] * len(names))
    status = instance.call("fmi2GetRealOutputDerivatives", instance.references(*names), len(names), orders, values)
    assert status == OK, instance.last
    return np.array(values)


def give_rates(instance: Instance, names: list[str], order: int, values: list[float]) -> int:
    """fmi2SetRealInputDerivatives of one order."""
    orders = array(ct.c_int, [order] * len(names))
    numbers = array(ct.c_double, values)
    return instance.call("fmi2SetRealInputDerivatives", instance.references(*names), len(names), orders, numbers)


def test_16_output_derivatives(binary: Binary, create: Create) -> None:
    names = binary.names("output", type="Real")
    instance = create(binary, start=moved(binary)).initialize()
    assert instance.step(1e-4) == OK
    found = rates(instance, names)
    if not binary.interpolates:
        assert not found.any()
        return
    before = instance.get(*names)
    h = 1e-7  # s
    assert instance.step(h) == OK
    # One-sided: h/2 times second derivatives, at most (320/s)^2 of what oscillates in the wall: 1 %.
    difference = (instance.get(*names) - before) / h
    np.testing.assert_allclose(found, difference, rtol=0.01, atol=1e-3 * np.abs(difference).max())
    assert found.any()


def plants(binary: Binary) -> bool:
    """Whether the FMU integrates its inputs."""
    return binary.interpolates


def test_16_input_derivatives_continue_the_inputs(load: Load, create: Create) -> None:
    """A torque that is a parabola in time: given by two derivatives it is exact, held it is of order 1."""
    binary = load("Plant")
    torque, rate, curvature = np.array([3.0, -2.0]), np.array([400.0, 300.0]), np.array([-5e3, 8e3])
    names, outputs = ["tau[1]", "tau[2]"], binary.names("output", type="Real")
    total = 0.01  # s

    def run(n: int, order: int) -> np.ndarray:
        instance, h = create(binary, start={"dt_max": 1e-5}).initialize(), total / n
        for k in range(n):
            t = k * h
            value, slope = torque + rate * t + curvature * t**2 / 2, rate + curvature * t
            instance.set(dict(zip(names, value, strict=True)))
            if order >= 1:
                assert give_rates(instance, names, 1, list(slope)) == OK
            if order >= 2:
                assert give_rates(instance, names, 2, list(curvature)) == OK
            assert instance.step(h) == OK
        return instance.get(*outputs)

    exact = run(1, 2)
    # Runge-Kutta is exact to (w dt)^4; rounding of 1000 sub-steps remains.
    np.testing.assert_allclose(run(100, 2), exact, rtol=1e-12, atol=1e-12)
    errors = {order: [np.abs(run(n, order) - exact).max() for n in (10, 20, 40)] for order in (0, 1)}
    slopes = {order: -np.polyfit(np.log([10, 20, 40]), np.log(e), 1)[0] for order, e in errors.items()}
    # ddq at the end feels the torque there: held, h times its rate; continued linearly, h^2 times its curvature.
    assert slopes[0] == pytest.approx(1, abs=0.1)
    assert slopes[1] == pytest.approx(2, abs=0.1)


def test_16_input_derivatives_serve_one_step(load: Load, create: Create) -> None:
    binary = load("Plant")
    given, plain = create(binary).initialize(), create(binary).initialize()
    assert give_rates(given, ["tau[1]"], 1, [0.0]) == OK
    assert give_rates(given, ["tau[2]"], 1, [1e3]) == OK
    assert give_rates(given, ["tau[2]"], 2, [1e6]) == OK
    assert given.step(1e-3) == OK
    assert plain.step(1e-3) == OK
    assert (given.outputs() != plain.outputs()).any()
    # The next step starts from the same state with held inputs, or it does not.
    blob = given.blob()
    assert given.step(1e-3) == OK
    held = given.outputs()
    assert given.restore(blob) == OK
    assert give_rates(given, ["tau[1]"], 1, [0.0]) == OK, "tau[2] has none any more, of either order"
    assert given.step(1e-3) == OK
    np.testing.assert_array_equal(given.outputs(), held)


def test_16_input_derivatives_are_part_of_the_state(load: Load, create: Create) -> None:
    binary = load("Plant")
    names = binary.names("output", type="Real")
    instance, other = create(binary).initialize(), create(binary).initialize()
    assert give_rates(instance, ["tau[1]"], 1, [1e3]) == OK
    assert other.restore(instance.blob()) == OK
    for one in (instance, other):
        assert one.step(1e-3) == OK
    np.testing.assert_array_equal(other.outputs(), instance.outputs())
    found = rates(instance, names)
    assert other.restore(instance.blob()) == OK
    np.testing.assert_array_equal(rates(other, names), found)


def test_16_output_derivatives_feel_how_inputs_move(load: Load, create: Create) -> None:
    """At the end of a step: by their rates there, times the direct feedthrough, more than with held inputs."""
    binary = load("Plant")
    names, h = binary.names("output", type="Real"), 1e-2
    instance = create(binary).initialize()
    assert give_rates(instance, ["tau[1]"], 1, [400.0]) == OK
    assert give_rates(instance, ["tau[1]"], 2, [-5e3]) == OK
    assert instance.step(h) == OK
    moving, through = rates(instance, names), directional(instance, names, "tau[1]")
    assert instance.set({"tau[1]": 400 * h - 5e3 * h**2 / 2}) == OK
    assert instance.step(1e-12) == OK
    held = rates(instance, names)
    # In 1e-12 s the held rates change by less than 1e-6 of a rate of ddq of 1e3 rad/s3.
    np.testing.assert_allclose(moving - held, through * (400 - 5e3 * h), rtol=1e-6, atol=1e-6)
    assert through.any()


def test_16_output_derivatives_are_checked(binary: Binary, create: Create) -> None:
    instance = create(binary).initialize()
    output = binary.names("output", type="Real")[0]
    place = array(ct.c_double, [7.0])
    for order in (0, 2):
        orders = array(ct.c_int, [order])
        status = instance.call("fmi2GetRealOutputDerivatives", instance.references(output), 1, orders, place)
        assert status == ERROR
        assert f"order {order} of {output}" in instance.last
    assert instance.call("fmi2GetRealOutputDerivatives", instance.references(output), 1, None, place) == ERROR
    assert "missing" in instance.last
    assert place[0] == 7.0


def test_16_directional_derivatives_are_linear(binary: Binary, create: Create) -> None:
    """Along 2 a - 3 b: twice that along a, less three times that along b."""
    unknowns, knowns = binary.names("output", type="Real"), differentiable(binary)
    instance = create(binary, start=moved(binary)).enter()
    single = {known: directional(instance, unknowns, known) for known in knowns}
    a, b = sorted(knowns, key=lambda known: -np.count_nonzero(single[known]))[:2]
    result, pair = array(ct.c_double, [0.0] * len(unknowns)), (instance.references(a, b), 2)
    seeds = array(ct.c_double, [2.0, -3.0])
    function, rows = "fmi2GetDirectionalDerivative", (instance.references(*unknowns), len(unknowns))
    assert instance.call(function, *rows, *pair, seeds, result) == OK
    expected = 2 * single[a] - 3 * single[b]
    assert expected.any()
    # Rounding of sums that cancel: some EPS of the larger term.
    scale = 1e3 * EPS * max(np.abs(single[a]).max(), np.abs(single[b]).max())
    np.testing.assert_allclose(np.array(result), expected, rtol=1e-12, atol=scale)


def test_16_input_derivatives_are_checked(load: Load, create: Create) -> None:
    instance = create(load("Plant")).initialize()
    before = instance.blob()
    for names, order, value, text in (
        (["tau[1]"], 0, 1.0, "order 0 of tau[1]"),
        (["tau[1]"], 3, 1.0, "order 3 of tau[1]"),
        (["q[1]"], 1, 1.0, "q[1] is not an input"),
        (["tau[1]"], 1, float("nan"), "must be finite"),
    ):
        assert give_rates(instance, names, order, [value]) == ERROR
        assert text in instance.last
        assert instance.blob() == before
    torque, one = instance.references("tau[1]"), array(ct.c_double, [1.0])
    assert instance.call("fmi2SetRealInputDerivatives", torque, 1, None, one) == ERROR
    assert "missing" in instance.last
    assert instance.blob() == before
