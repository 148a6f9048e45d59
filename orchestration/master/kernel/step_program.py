"""Translates a step of a fixed-step algorithm into a flat list of operations, in their order.

    Gauss-Seidel: for each component: set its inputs, doStep, get its outputs
    Jacobi:       set all inputs; doStep all; get all outputs

With time series, the step begins with a call that looks like a doStep: it gives their inputs the values for the step.
An input is set directly from the place of its source, if that costs less than a copy to a place of its own.
So inputs whose sources are neighbours are set by one call, without a copy.
"""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from orchestration.master.kernel.codes import GROUP_SIZE, OPERATION, Column, Group, Kind
from orchestration.master.kernel.flat_system import Plan

# One more call costs as much as the copies of five numbers (tests.benchmarks.master, fig5: 3 ns
# against 0.5 ns, and a call for the rest is needed in any case).
COPIES_PER_CALL = 5

NOBODY = -1
"""The subject of an operation that calls no component."""

_SETS = (Column.SET_REAL, Column.SET_INTEGER, Column.SET_BOOLEAN)
_GETS = (Column.GET_REAL, Column.GET_INTEGER, Column.GET_BOOLEAN)
_SIZES = {Column.SET_REAL: 8, Column.SET_INTEGER: 4, Column.SET_BOOLEAN: 4}  # bytes of a value
_REFERENCE_SIZE = 4

Run = tuple[int, int, int]  # first source, first target, number
Operation = tuple[int, ...]  # the fields of OPERATION


def operations_of_step(plan: Plan, *, sequential: bool, series: tuple[int, int] | None = None) -> np.recarray:
    """Return the operations of a step of a fixed-step algorithm.

    Parameters
    ----------
    plan
        Flat form of the system. It must outlive the operations, which hold addresses of its buffers.
    sequential
        Gauss-Seidel if true, else Jacobi.
    series
        Addresses of `orchestration.master.kernel.series.give` and of the table of series; None without series.

    Returns
    -------
    recarray
        Records `orchestration.master.kernel.codes.OPERATION`, shape (n_operations,).
    """
    n = plan.table.shape[0]
    phases = [[_set(plan, i), _step(plan, i), _get(plan, i)] for i in range(n)]
    ordered = phases if sequential else [list(phase) for phase in zip(*phases, strict=True)]
    first = [] if series is None else [(Kind.STEP, *series, 0, 0, 0, NOBODY, Column.DO_STEP)]
    operations = first + [operation for phase in itertools.chain.from_iterable(ordered) for operation in phase]
    return np.array(operations, OPERATION).view(np.recarray)


def _set(plan: Plan, i: int) -> list[Operation]:
    """Return the copies and calls that set the inputs of component i."""
    operations = []
    for call in _SETS:
        kind, links, first, end = Kind.COPY_REALS, plan.real_links, Column.FIRST_REAL, Column.END_REAL
        if call != Column.SET_REAL:
            kind, links = Kind.COPY_DISCRETES, plan.discrete_links
            first, end = Column.FIRST_DISCRETE, Column.END_DISCRETE
        count = plan.table[i, call + Group.COUNT]
        if count == 0:
            continue
        buffer = plan.reals if kind == Kind.COPY_REALS else plan.discretes
        place = (plan.table[i, call + Group.VALUES] - buffer.ctypes.data) // _SIZES[call]
        own = links[plan.table[i, first] : plan.table[i, end]].tolist()
        linked = [pair for pair in own if place <= pair[1] < place + count]
        alone = set(range(place, place + count)) - {target for _, target in linked}
        runs = list(_runs([*linked, *((target, target) for target in alone)]))  # a series writes to the place itself
        if (len(runs) - 1) * COPIES_PER_CALL <= count:
            operations += [_transfer(plan, i, call, (target - place, source - place, n)) for source, target, n in runs]
        else:
            moved = [run for run in runs if run[0] != run[1]]
            operations += [(kind, 0, 0, source, n, target, i, call) for source, target, n in moved]
            operations.append(_transfer(plan, i, call, (0, 0, count)))
    return operations


def _runs(links: Sequence[Sequence[int]]) -> Iterator[Run]:
    """Split links, ordered by target, into runs whose sources and targets both count up."""
    ordered = sorted(links, key=lambda link: link[1])
    for _, run in itertools.groupby(enumerate(ordered), lambda item: (item[1][0] - item[0], item[1][1] - item[0])):
        pairs = [pair for _, pair in run]
        yield pairs[0][0], pairs[0][1], len(pairs)


def _transfer(plan: Plan, i: int, call: Column, part: tuple[int, int, int]) -> Operation:
    """Return the set call for a part of component i's inputs.

    The part is given by the number of inputs before it, the offset of its values in the buffer, and its size.
    """
    skipped, offset, count = part
    group = plan.table[i, call : call + GROUP_SIZE]
    references = group[Group.REFERENCES] + _REFERENCE_SIZE * skipped
    values = group[Group.VALUES] + _SIZES[call] * offset
    instance = plan.table[i, Column.INSTANCE]
    return (Kind.TRANSFER, group[Group.FUNCTION], instance, references, count, values, i, call)


def _step(plan: Plan, i: int) -> list[Operation]:
    """Return the operation that makes the step of component i."""
    row = plan.table[i]
    return [(Kind.STEP, row[Column.DO_STEP], row[Column.INSTANCE], 0, 0, 0, i, Column.DO_STEP)]


def _get(plan: Plan, i: int) -> list[Operation]:
    """Return the calls that fetch the outputs of component i."""
    operations = []
    for call in _GETS:
        function, references, count, values = plan.table[i, call : call + GROUP_SIZE]
        if count:
            instance = plan.table[i, Column.INSTANCE]
            operations.append((Kind.TRANSFER, function, instance, references, count, values, i, call))
    return operations
