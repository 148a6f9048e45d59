"""Texts of formulas: what is read is written as it is read again, and what is no formula is refused with its place."""

import pickle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orchestration import FormulaError
from orchestration.results.measures.expression import (
    ARITHMETIC,
    COMPARISONS,
    CONDITION_KINDS,
    LOGIC,
    NUMBER_KINDS,
    Before,
    Binary,
    Column,
    Norm,
    Number,
    Reduction,
    Since,
    Time,
    Unary,
)
from orchestration.results.measures.formula import Formula
from orchestration.results.measures.parser import parse_formula

NAMES = st.one_of(
    st.sampled_from(["plant.F_ext", "a.b.c[1,2]", "x", "a.lambda", "a.x[01]", "max", "a[0].b", "Drive 1.w", "é.ü"]),
    st.text(min_size=1, max_size=8).filter(lambda name: name != "time"),
)
NUMBERS_OF_A_RUN = st.one_of(
    st.floats(0, allow_nan=False, allow_infinity=False).map(Number), NAMES.map(Column), st.just(Time())
)


def arithmetic(parts: st.SearchStrategy) -> st.SearchStrategy:
    return st.one_of(
        st.builds(Unary, st.sampled_from(["-", "abs", "sqrt"]), parts),
        st.builds(Binary, st.sampled_from(ARITHMETIC), parts, parts),
        st.builds(Norm, st.lists(parts, min_size=1, max_size=3).map(tuple)),
    )


def logic(parts: st.SearchStrategy) -> st.SearchStrategy:
    return st.one_of(
        st.builds(Unary, st.just("not"), parts),
        st.builds(Binary, st.sampled_from(LOGIC), parts, parts),
        st.builds(Before, parts),
        st.builds(Since, parts),
    )


NUMBERS = st.recursive(NUMBERS_OF_A_RUN, arithmetic, max_leaves=6)
CONDITIONS = st.recursive(st.builds(Binary, st.sampled_from(COMPARISONS), NUMBERS, NUMBERS), logic, max_leaves=4)
REDUCTIONS = st.one_of(
    st.builds(Reduction, st.sampled_from(NUMBER_KINDS), NUMBERS, st.none() | CONDITIONS),
    st.builds(Reduction, st.sampled_from(CONDITION_KINDS), CONDITIONS, st.none() | CONDITIONS),
)
FORMULAS = st.recursive(REDUCTIONS, arithmetic, max_leaves=4).map(Formula)


@settings(max_examples=300, deadline=None)
@given(FORMULAS)
def test_every_formula_is_read_as_it_was_written(formula: Formula) -> None:
    again = parse_formula(str(formula))
    assert again == formula
    assert str(again) == str(formula)
    assert pickle.loads(pickle.dumps(formula)) == formula  # noqa: S301 - its own bytes


TEXTS = {
    "max( plant.x[1] )": "max(plant.x[1])",
    "max((a.x*2)**2)": "max(a.x * 2 * (a.x * 2))",
    "max(+a.x - (a.y - a.z) - -1)": "max(a.x - (a.y - a.z) - -1)",
    "max(-(a.x + a.y) * 2)": "max(-(a.x + a.y) * 2)",
    "max(a.x / (a.y / a.z))": "max(a.x / (a.y / a.z))",
    "share(0 <= a.x < 2)": "share(0 <= a.x and a.x < 2)",
    "share(not (a.x > 1 or a.y > 1) and a.z > 1)": "share(not (a.x > 1 or a.y > 1) and a.z > 1)",
    "share(a.x > 1 or a.y > 1 and a.z > 1)": "share(a.x > 1 or a.y > 1 and a.z > 1)",
    'max("plant.x[1]")': "max(plant.x[1])",
    'max("time", where="Drive 1.w" > 1e3)': "max(time, where='Drive 1.w' > 1000)",
    "max(a.x,\n    where=a.y > 1e-05)": "max(a.x, where=a.y > 1e-05)",
}


@pytest.mark.parametrize("text", TEXTS)
def test_a_formula_has_one_way_of_writing(text: str) -> None:
    assert str(parse_formula(text)) == TEXTS[text]
    assert parse_formula(TEXTS[text]) == parse_formula(text)


WRONG = {
    "": "Measure '': invalid syntax; write a formula such as max(norm(plant.F_ext))",
    "max(": "Measure max(, character 4: '(' was never closed",
    "max(Drive 1.w)": 'in quotes, such as max("Drive 1.w").',
    "max(a.lambda)": "Measure max(a.lambda), character 7: invalid syntax;",
    "max(a.x\0)": "null bytes",
    "max(a.x ** 3)": "Measure max(a.x ** 3), character 5, a.x ** 3: the only power is 2; write products",
    "max(é.b + (ü.c**True))": "character 12, ü.c**True: the only power is 2",
    "plant.x": "Measure plant.x: a measure is one number of a run; reduce the values, such as max(...)",
    "max(a.x) + time": "character 12, time: a measure is one number of a run",
    "3 * 4": "Measure 3 * 4: nothing of a run is reduced; write a reduction",
    "max(a.x) > 2": "Measure max(a.x) > 2: a measure is a number, and this is a condition; write share(...)",
    "1 + (max(a.x) > 2)": "character 6, max(a.x) > 2: this is a condition, and a number is needed here.",
    "max(min(a.x))": "character 5, min(a.x): min stands within another reduction",
    "max(a.x, where=min(a.x) > 0)": "character 16, min(a.x): min stands within another reduction",
    "before(a.x > 1)": "Measure before(a.x > 1): before and since stand within a reduction",
    "share(a.x)": "character 7, a.x: this is a number, and a condition is needed here; compare it",
    "max(a.x, where=a.y)": "character 16, a.y: this is a number, and a condition is needed here",
    "max(a.x, where=before(a.y))": "character 23, a.y: this is a number, and a condition is needed here",
    "share(a.x and a.y > 1)": "character 7, a.x: this is a number, and a condition is needed here",
    "share(not a.x)": "character 11, a.x: this is a number, and a condition is needed here",
    "max(a.x > 0)": "character 5, a.x > 0: this is a condition, and a number is needed here.",
    "max(-(a.x > 0))": "character 7, a.x > 0: this is a condition, and a number is needed here.",
    "share((a.x > 0) > 0)": "character 8, a.x > 0: this is a condition, and a number is needed here.",
    "mx(a.x)": "Measure mx(a.x): there is no function mx; did you mean max?",
    "exp(max(a.x))": "there is no function exp; formulas have + - * / **2",
    "max(a.x, a.y)": "Measure max(a.x, a.y): max takes one number and, if wanted, where=condition; norm(a, b)",
    "share()": "Measure share(): share takes one condition and, if wanted, where=condition",
    "max(a.x, were=a.y > 0)": "max takes one number and, if wanted, where=condition",
    "max(a.x, **a.y)": "max takes one number and, if wanted, where=condition",
    "max(*a.x)": "character 5, *a.x: this is not part of a formula",
    "max(abs(a.x, a.y))": "character 5, abs(a.x, a.y): abs takes one argument and no keyword.",
    "max(norm())": "character 5, norm(): norm takes one number or more and no keyword.",
    "max([1])": "character 5, [1]: this is not part of a formula; formulas have + - * / **2",
    "max(a.x @ a.y)": "character 5, a.x @ a.y: this is not part of a formula",
    "max(a.x if a.y else a.z)": "this is not part of a formula",
    "max(True)": "character 5, True: this is not part of a formula",
    "max(1j)": "character 5, 1j: this is not part of a formula",
    "max(1e999)": "character 5, 1e999: this number is too large for a float64.",
    f"max({10**400})": "this number is too large for a float64.",
    "share(a.x in a.y)": "character 7, a.x in a.y: comparisons are < <= > >= == !=.",
    "max(a.x[b])": "character 9, b: this is not an index; an index is an integer",
    "max(a.x[-1])": "character 9, -1: this is not an index",
    "max(a.x[True])": "character 9, True: this is not an index",
    "max(a.x[1:2])": "character 9, 1:2: this is not an index",
    "max(f(a.x).y)": "character 5, f(a.x): this is not a name of a column; such a name is plant.x[1].",
    "a.max(a.x)": "Measure a.max(a.x): this is not part of a formula",
    "max(__import__('os').system('ls'))": "__import__('os').system('ls'): this is not part of a formula",
    "(" * 300 + "max(a.x)" + ")" * 300: "too many nested parentheses",
    "max(" + "-" * 3000 + "a.x)": "its parentheses or operators lie too deep",
    "max(" + "a.x + " * 1000 + "a.x)": "A measure has 6008 characters; 4000 are the most.",
}


@pytest.mark.parametrize("text", WRONG, ids=lambda text: text[:40])
def test_what_is_no_formula_is_refused_with_its_place(text: str) -> None:
    with pytest.raises(FormulaError) as caught:
        parse_formula(text)
    assert WRONG[text] in str(caught.value)


def test_another_thing_than_a_text_is_refused() -> None:
    with pytest.raises(FormulaError, match="A measure is 3, of type int; give a text"):
        parse_formula(3)  # type: ignore[arg-type]
