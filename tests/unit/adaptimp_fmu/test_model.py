"""Tests of the declaration of a model: what it refuses, and what follows from it in the FMU."""

import math
from typing import Any

import casadi as ca
import pytest
from lxml import etree

from adaptimp_fmu import NOT_NEGATIVE, ContinuousModel, DefinitionError, Limits, Model, Role, SampledModel, Type
from adaptimp_fmu.lowering import lower
from adaptimp_fmu.package import definition
from adaptimp_fmu.structure import dependencies


def sampled(name: str = "Unit") -> SampledModel:
    """A sampled model without variables of its own."""
    return SampledModel(name, "A model for tests")


def continuous() -> ContinuousModel:
    """A continuous model without variables of its own."""
    return ContinuousModel("Unit", "A model for tests")


@pytest.mark.parametrize(
    ("first", "second"),
    [(0.0, 0.0), ([0.0, 0.0], [0.0, 0.0]), (0.0, [0.0, 0.0]), ([0.0, 0.0], 0.0)],
    ids=["scalars", "vectors", "scalar, vector", "vector, scalar"],
)
def test_names_are_taken_once(first, second) -> None:
    model = sampled()
    model.parameter("a", first, description="First")
    with pytest.raises(DefinitionError, match="Unit already has a variable a"):
        model.input("a", second, description="Second")


def test_names_of_outputs_are_taken_too() -> None:
    model = sampled()
    u = model.input("u", [0.0, 0.0], description="Input")
    with pytest.raises(DefinitionError, match="already has a variable u"):
        model.output("u", u, description="Output")
    with pytest.raises(DefinitionError, match="already has a variable sample_time"):
        model.input("sample_time", 0.0, description="Taken by the model itself")


def test_longer_names_are_other_names() -> None:
    model = sampled()
    model.input("x", [0.0, 0.0], description="Position")
    model.input("x_v", [0.0, 0.0], description="Virtual position")
    assert [v.name for v in model.with_role(Role.INPUT)] == ["x[1]", "x[2]", "x_v[1]", "x_v[2]"]


@pytest.mark.parametrize("name", ["", "My Model", "1st", "a/b", "../a", "a-b", "é"])
def test_model_identifier_is_a_c_identifier(name: str) -> None:
    """It names a file and, in static libraries, C functions (checklist 6)."""
    model = sampled(name)
    model.output("y", model.input("u", 0.0, description="Input"), description="Output")
    with pytest.raises(DefinitionError, match="not a C identifier"):
        definition(model)


def test_a_model_without_outputs_is_refused() -> None:
    model = sampled()
    model.input("u", 0.0, description="Input")
    with pytest.raises(DefinitionError, match="Unit has no outputs"):
        definition(model)


@pytest.mark.parametrize("what", ["units", "descriptions"])
def test_one_text_per_element(what: str) -> None:
    texts = {"units": {"unit": ["m"]}, "descriptions": {"description": ["Only one"]}}[what]
    declaration: dict[str, Any] = {"description": "Both"} | texts
    with pytest.raises(DefinitionError, match=rf"x\[1\]: 2 elements but 1 {what}"):
        sampled().input("x", [0.0, 0.0], **declaration)


def test_evolution_has_the_shape_of_its_state() -> None:
    model = continuous()
    x = model.state("x", ca.SX([0.0, 0.0]))
    with pytest.raises(DefinitionError, match=r"Unit\.x has 2 elements, its evolution 3"):
        model.derivative(x, ca.SX([1.0, 2.0, 3.0]))


def test_only_states_evolve() -> None:
    model = sampled()
    u = model.input("u", 0.0, description="Input")
    with pytest.raises(DefinitionError, match="u is not a state of this model"):
        model.update(u, u)


def test_missing_evolution_is_named() -> None:
    model = sampled()
    model.output("y", model.state("forgotten", ca.SX(0.0)), description="Output")
    with pytest.raises(DefinitionError, match="state forgotten has no derivative or update"):
        lower(model)


def test_events_do_not_depend_on_inputs() -> None:
    """The runtime locates them while inputs are held; only states move within a step."""
    model = continuous()
    u, x = model.input("u", 0.0, description="Input"), model.state("x", ca.SX(1.0))
    with pytest.raises(DefinitionError, match="event bounce depends on inputs"):
        model.event("bounce", x - u)
    assert model.event("ground", x).numel() == 1


def test_events_do_not_need_inputs() -> None:
    model = continuous()
    x = model.state("x", ca.SX(1.0))
    model.derivative(x, -model.event("ground", x))
    model.output("y", x, description="Output")
    assert "event_indicators" in [function.name() for function in lower(model).functions]


def test_events_do_not_depend_on_modes() -> None:
    model = continuous()
    x = model.state("x", ca.SX(1.0))
    mode = model.event("ground", x)
    model.event("second", x + mode)
    model.derivative(x, -x)
    model.output("y", x, description="Output")
    with pytest.raises(DefinitionError, match="event_indicators depends on a symbol that is not declared"):
        lower(model)


@pytest.mark.parametrize("where", ["output", "update", "initial", "require"])
def test_symbols_must_be_declared(where: str) -> None:
    model, stranger = sampled(), ca.SX.sym("stranger")
    x = model.state("x", stranger if where == "initial" else ca.SX(0.0))
    model.update(x, stranger if where == "update" else x)
    model.output("y", stranger if where == "output" else x, description="Output")
    if where == "require":
        model.require(stranger, "must be positive")
    with pytest.raises(DefinitionError, match=r"stranger, which the model does not declare"):
        lower(model)


def test_first_value_of_a_state_is_no_function_of_states() -> None:
    model = sampled()
    x = model.state("x", ca.SX(0.0))
    y = model.state("y", x + 1)
    model.update(x, x)
    model.update(y, y)
    model.output("z", y, description="Output")
    with pytest.raises(DefinitionError, match="Function initial depends on a symbol that is not declared"):
        lower(model)


def test_only_the_two_kinds_can_be_lowered() -> None:
    model = Model("Unit", "Neither kind")
    model.output("y", ca.SX(1.0), description="Output")
    with pytest.raises(DefinitionError, match="neither a ContinuousModel nor a SampledModel"):
        lower(model)


def test_noise_is_declared_once_with_a_seed_that_exists() -> None:
    model = sampled()
    w = model.random(lambda u: u[0] + u[3], active=ca.SX(1), seed="sed")
    model.output("y", w, description="Output")
    with pytest.raises(DefinitionError, match="already declares noise"):
        model.random(lambda u: u[0], active=ca.SX(1), seed="seed")
    with pytest.raises(DefinitionError, match="Unit has no variable sed; there are sample_time, y"):
        definition(model)


# Ranges


def test_elements_of_an_array_may_have_ranges_of_their_own() -> None:
    model = sampled()
    model.parameter("p", [1.0, -2.0], limits=[NOT_NEGATIVE, Limits(maximum=0.5)], description="Mass and moment")
    found = {variable.name: (variable.minimum, variable.maximum) for variable in model.variables}
    assert (found["p[1]"], found["p[2]"]) == ((0.0, math.inf), (-math.inf, 0.5))


@pytest.mark.parametrize(
    ("limits", "sentence"),
    [
        ([NOT_NEGATIVE], r"p\[1\]: 2 elements but 1 limits; give one for all, or one for each\."),
        ((0.0, 1.0), r"p: limits \(0\.0, 1\.0\) are not a range; give one, as Limits\(0\.0, 1\.0\), or one each\."),
    ],
)
def test_limits_that_are_not_those_of_the_elements_are_refused(limits: Any, sentence: str) -> None:
    with pytest.raises(DefinitionError, match=sentence):
        sampled().parameter("p", [1.0, 2.0], limits=limits, description="Mass")


# What the runtime divides by, and what keys its noise


def slow(*, late: bool, **declaration: Any) -> SampledModel:
    """A model with a slow state whose divisor is declared before or after the state's update."""
    model = sampled()
    x = model.state("x", ca.SX(0.0))
    model.output("y", x, description="Output")
    if not late:
        model.parameter("n", **declaration)
    model.update_slowly(x, x + 1, divisor="n")
    if late:
        model.parameter("n", **declaration)
    return model


DIVISORS = [
    ({"start": 1.0}, "n is a Real"),
    ({"start": True, "type": Type.BOOLEAN}, "n is a Boolean"),
    ({"start": 1, "type": Type.INTEGER}, "its minimum is -2147483647"),
    ({"start": 1, "type": Type.INTEGER, "limits": NOT_NEGATIVE}, "its minimum is 0"),
]


@pytest.mark.parametrize(("declaration", "reason"), DIVISORS)
def test_a_divisor_that_could_be_zero_is_refused(declaration: dict[str, Any], reason: str) -> None:
    """A divisor of zero would be a division by zero in C, which ends the host."""
    with pytest.raises(DefinitionError, match=f"divisor n .*Integer parameter .* at least 1; {reason}"):
        slow(late=False, description="Ticks", **declaration)
    model = slow(late=True, description="Ticks", **declaration)
    with pytest.raises(DefinitionError, match=f"divisor n .*Integer parameter .* at least 1; {reason}"):
        definition(model)


@pytest.mark.parametrize("late", [False, True])
def test_a_divisor_of_at_least_one_is_accepted(late: bool) -> None:
    model = slow(late=late, start=2, type=Type.INTEGER, limits=Limits(1), description="Ticks")
    assert "#define MODEL_DIVISOR 1 " in definition(model)[0]["sizes.h"]


@pytest.mark.parametrize("kind", ["input", "output"])
def test_divisor_and_seed_are_parameters(kind: str) -> None:
    def declare(model: SampledModel) -> None:
        if kind == "input":
            model.input("n", 1, type=Type.INTEGER, description="Not a parameter")
        else:
            model.output("n", ca.SX(1), type=Type.INTEGER, scalar=True, description="Not a parameter")

    model = sampled()
    x = model.state("x", ca.SX(0.0))
    declare(model)
    with pytest.raises(DefinitionError, match=f"n is an {kind}"):
        model.update_slowly(x, x + 1, divisor="n")
    with pytest.raises(DefinitionError, match=f"seed n .*Integer parameter; n is an {kind}"):
        model.random(lambda u: u[0], active=ca.SX(1), seed="n")


def test_an_undeclared_divisor_is_refused_when_the_model_is_built() -> None:
    model = sampled()
    x = model.state("x", ca.SX(0.0))
    model.output("y", x, description="Output")
    model.update_slowly(x, x + 1, divisor="m")
    with pytest.raises(DefinitionError, match="Unit has no variable m; there are sample_time"):
        definition(model)


@pytest.mark.parametrize(
    ("declaration", "reason"),
    [({"start": 0.5}, "key is a Real"), ({"start": True, "type": Type.BOOLEAN}, "key is a Boolean")],
)
@pytest.mark.parametrize("late", [False, True])
def test_a_seed_that_is_no_integer_is_refused(declaration: dict[str, Any], reason: str, late: bool) -> None:
    """C would cut it to an integer, and a Real beyond 2^63 has none."""

    def complete() -> None:
        model = sampled()
        if not late:
            model.parameter("key", description="Key", **declaration)
        model.output("y", model.random(lambda u: u[0], active=ca.SX(1), seed="key"), description="Output")
        if late:
            model.parameter("key", description="Key", **declaration)
        definition(model)

    with pytest.raises(DefinitionError, match=f"seed key .*Integer parameter; {reason}"):
        complete()


def test_references_are_parameters_then_inputs_then_outputs() -> None:
    model = sampled()
    u = model.input("u", [0.0, 0.0], description="Input")
    model.output("y", u, description="Output")
    model.parameter("late", 1, type=Type.INTEGER, description="Declared last, counted second")
    names = [variable.name for variable in model.ordered_variables()]
    assert names == ["sample_time", "late", "u[1]", "u[2]", "y[1]", "y[2]"]
    assert [model.reference(name) for name in names] == list(range(6))


def test_requirements_on_parameters_alone_are_checked_when_they_change() -> None:
    model = sampled()
    p, u = model.parameter("p", 1.0, description="Parameter"), model.input("u", 1.0, description="Input")
    model.require(p - 1, "static")
    model.require(p - u, "dynamic")
    model.require(2 - model.time, "also dynamic")
    assert [check.sentence for check in model.static_checks] == ["static"]
    assert [check.sentence for check in model.checks] == ["dynamic", "also dynamic"]


def test_integers_fit_into_32_bits() -> None:
    model = sampled()
    model.parameter("n", 0, type=Type.INTEGER, description="Number")
    assert (model.variables[-1].minimum, model.variables[-1].maximum) == (-(2**31) + 1, 2**31 - 1)


# What lowering moves, and what it keeps


def operations(function: ca.Function) -> set[int]:
    """Codes of the operations in a function."""
    return {function.instruction_id(i) for i in range(function.n_instructions())}


def lowered(model: Model) -> dict[str, ca.Function]:
    """The lowered functions by name."""
    return {function.name(): function for function in lower(model).functions}


def example() -> SampledModel:
    """A model with every kind of argument: y = sqrt(a^2 + b) x + exp(u), x becomes x + sin(t)."""
    model = sampled()
    a, b = model.parameter("a", 3.0, description="A"), model.parameter("b", 16.0, description="B")
    u, x = model.input("u", 0.0, description="Input"), model.state("x", ca.SX(2.0))
    model.update(x, x + ca.sin(model.time))
    model.output("y", ca.sqrt(a**2 + b) * x + ca.exp(u), description="Output")
    return model


def test_expressions_of_parameters_alone_are_derived_once() -> None:
    functions = lowered(example())
    assert lower(example()).n_constants == 1
    assert functions["calibrate"].name_in() == ["p"]
    assert ca.OP_SQRT in operations(functions["calibrate"])
    assert ca.OP_SQRT not in operations(functions["tick"])
    assert float(functions["calibrate"](ca.DM([1e-4, 3.0, 16.0]))[0]) == 5.0


def test_expressions_of_anything_else_stay() -> None:
    """A constant that depended on time, inputs, states or noise would go stale."""
    functions = lowered(example())
    assert operations(functions["tick"]) >= {ca.OP_SIN, ca.OP_EXP}
    assert not operations(functions["calibrate"]) & {ca.OP_SIN, ca.OP_EXP}


def test_lowering_keeps_the_values() -> None:
    functions = lowered(example())
    p = ca.DM([1e-4, 3.0, 16.0])
    c = functions["calibrate"](p)[0]
    names = functions["tick"].name_in()
    values = {"t": 0.5, "x": 2.0, "u": 1.0, "w": ca.DM(0, 1), "p": p, "c": c}
    y, following, checks = functions["tick"](*(values[name] for name in names))
    # one rounding per operation, of terms no larger than the sum: 4 ulp
    assert float(y) == pytest.approx(5 * 2 + math.e, rel=4 * 2.3e-16)
    assert float(following) == pytest.approx(2 + math.sin(0.5), rel=4 * 2.3e-16)
    assert checks.numel() == 0


def test_common_subexpressions_are_evaluated_once() -> None:
    model = sampled()
    u = model.input("u", 0.0, description="Input")
    model.output("y", ca.vertcat(ca.sin(u), 2 * ca.sin(u), ca.sin(u) ** 2), description="Output")
    tick = lowered(model)["tick"]
    sines = [i for i in range(tick.n_instructions()) if tick.instruction_id(i) == ca.OP_SIN]
    assert len(sines) == 1


def test_one_output_and_nothing_else_can_be_lowered() -> None:
    """A slice of no elements out of one is a row to CasADi."""
    model = sampled()
    model.output("y", model.input("u", 0.0, description="Input"), description="Output")
    assert lowered(model)["tick"].numel_out(0) == 1


def test_dependencies_follow_the_equations() -> None:
    model = continuous()
    a, u = model.parameter("a", 1.0, description="A"), model.input("u", [0.0, 0.0], description="Input")
    x = model.state("x", a)
    model.derivative(x, u[1])
    model.output("y", ca.vertcat(x, x + u[0], 0 * u[1]), description="Output")
    depends = dependencies(model)
    assert depends.in_step == ((), (2,), ())
    assert depends.initial == ((1,), (1, 2), ())


# What the XML says


def test_special_characters_survive() -> None:
    model = SampledModel("Unit", 'Angle < 90° & "more"')
    model.output("y", model.input("u", 0.0, description="a < b > c & 'd'"), description="Output")
    root = etree.fromstring(definition(model)[1])
    assert root.get("description") == 'Angle < 90° & "more"'
    assert [v.get("description") for v in root.iterfind("ModelVariables/*")][1] == "a < b > c & 'd'"


@pytest.mark.parametrize("value", [0.1, 1e-300, 1e300, -2.5e-8, 2.0943951024, math.pi, 1e22, 123456789012345680.0])
def test_starts_are_written_to_the_last_bit(value: float) -> None:
    model = sampled()
    model.output("y", model.input("u", value, description="Input"), description="Output")
    sources, xml = definition(model)
    typed = next(etree.fromstring(xml).iterfind(".//ScalarVariable[@name='u']/Real"))
    assert float(typed.attrib["start"]) == value
    assert f'{{"u", TYPE_REAL, ROLE_INPUT,\n     {value!r},' in sources["model.c"]


@pytest.mark.parametrize("place", ["output y", "the first value of state x", "the evolution of state x", "event hit"])
def test_functions_that_turn_symbols_into_nan_are_refused(place: str) -> None:
    """math.sin of a symbol is NaN without a word; a unit of it would build and compute nothing."""
    model = ContinuousModel("Wrong", "A sine of the wrong library")
    u = model.input("u", 0.0, description="Input")
    wrong = {place: ca.SX(math.sin(u))}
    x = model.state("x", wrong.get("the first value of state x", ca.SX(0)))
    model.event("hit", x + wrong.get("event hit", ca.SX(0)))
    model.derivative(x, u + wrong.get("the evolution of state x", ca.SX(0)))
    model.output("y", x + wrong.get("output y", ca.SX(0)), description="Output", scalar=True)
    with pytest.raises(DefinitionError, match=rf"^Wrong: {place} holds the constant NaN\. .* such as ca\.sin\.$"):
        lower(model)


@pytest.mark.parametrize(
    ("n", "scalar", "names"), [(1, None, ["F"]), (1, False, ["F[1]"]), (2, None, ["F[1]", "F[2]"])]
)
def test_an_output_of_one_element_is_called_as_an_input_is(n: int, scalar: bool | None, names: list[str]) -> None:
    model = sampled()
    model.output("F", ca.SX(n, 1), description="Force", scalar=scalar)
    assert [variable.name for variable in model.with_role(Role.OUTPUT)] == names
