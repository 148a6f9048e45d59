"""Random reductions of a run."""

from hypothesis import strategies as st

from orchestration.results.measures.expression import (
    ARITHMETIC,
    COMPARISONS,
    CONDITION_KINDS,
    LOGIC,
    NUMBER_KINDS,
    Before,
    Binary,
    Column,
    Expression,
    Norm,
    Number,
    Reduction,
    Since,
    Time,
    Unary,
)


def reductions(columns: tuple[str, ...]) -> st.SearchStrategy[Reduction]:
    """Reductions of all kinds, of numbers and conditions about some columns."""
    numbers = _numbers(columns)
    conditions = _conditions(numbers)
    where = st.none() | conditions
    return st.builds(Reduction, st.sampled_from(NUMBER_KINDS), numbers, where) | st.builds(
        Reduction, st.sampled_from(CONDITION_KINDS), conditions, where
    )


def _numbers(columns: tuple[str, ...]) -> st.SearchStrategy[Expression]:
    leaves = (
        st.builds(Number, st.sampled_from([0.0, 1.0, 0.5, 3.0, 1e-3, 1e200]))
        | st.builds(Column, st.sampled_from(columns))
        | st.builds(Time)
    )
    return st.recursive(
        leaves,
        lambda inner: (
            st.builds(Unary, st.sampled_from(["-", "abs", "sqrt"]), inner)
            | st.builds(Binary, st.sampled_from(ARITHMETIC), inner, inner)
            | st.builds(Norm, st.lists(inner, min_size=1, max_size=3).map(tuple))
        ),
        max_leaves=5,
    )


def _conditions(numbers: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    return st.recursive(
        st.builds(Binary, st.sampled_from(COMPARISONS), numbers, numbers),
        lambda inner: (
            st.builds(Unary, st.just("not"), inner)
            | st.builds(Binary, st.sampled_from(LOGIC), inner, inner)
            | st.builds(Before, inner)
            | st.builds(Since, inner)
        ),
        max_leaves=3,
    )
