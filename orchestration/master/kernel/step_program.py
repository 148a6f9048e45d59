"""What a step of a fixed-step algorithm does: a flat list of operations, in their order.

    Gauss-Seidel: for each component: set its inputs, doStep, get its outputs
    Jacobi:       set all inputs; doStep all; get all outputs

An input is set from where its source was fetched to, if that costs less than copying it to a place
of its own first: inputs whose sources are neighbours are one call, without a copy.
"""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from orchestration.master.kernel import flat_system
from orchestration.master.kernel.flat_system import Plan

# A row of the list. What FIRST, COUNT and VALUES are depends on the kind: value references, their
# number and the address of the first value (TRANSFER), or the places of a run in a buffer (COPY_*).
KIND, FUNCTION, COMPONENT, FIRST, COUNT, VALUES, SUBJECT, CALL = range(8)
N_COLUMNS = 8
TRANSFER, STEP, COPY_REALS, COPY_DISCRETES = range(4)

# One more call costs as much as the copies of five numbers (tests.benchmarks.master, fig5: 3 ns
# against 0.5 ns, and a call for the rest is needed in any case).
COPIES_PER_CALL = 5

_SETS = (flat_system.SET_REAL, flat_system.SET_INTEGER, flat_system.SET_BOOLEAN)
_GETS = (flat_system.GET_REAL, flat_system.GET_INTEGER, flat_system.GET_BOOLEAN)
_SIZES = {flat_system.SET_REAL: 8, flat_system.SET_INTEGER: 4, flat_system.SET_BOOLEAN: 4}  # bytes of a value
_REFERENCE_SIZE = 4

Run = tuple[int, int, int]  # first source, first target, number


def operations_of_step(plan: Plan, *, sequential: bool) -> np.ndarray:
    """The operations of a step.

    Parameters
    ----------
    plan
        Must outlive what is returned, which holds addresses of its buffers.
    sequential
        Gauss-Seidel if true, else Jacobi.

    Returns
    -------
    ndarray
        int64, shape (n_operations, `N_COLUMNS`); SUBJECT is the component's position and CALL one of
        `orchestration.master.kernel.flat_system.CALL_NAMES`.
    """
    n = plan.table.shape[0]
    phases = [[_set(plan, i), _step(plan, i), _get(plan, i)] for i in range(n)]
    ordered = phases if sequential else [list(phase) for phase in zip(*phases, strict=True)]
    rows = [row for phase in itertools.chain.from_iterable(ordered) for row in phase]
    return np.array(rows, np.int64).reshape(-1, N_COLUMNS)


def _set(plan: Plan, i: int) -> list[list[int]]:
    """The copies and calls that hand component i its inputs."""
    rows = []
    for call in _SETS:
        kind, links, first, end = COPY_REALS, plan.real_links, flat_system.FIRST_REAL, flat_system.END_REAL
        if call != flat_system.SET_REAL:
            kind, links, first, end = (
                COPY_DISCRETES,
                plan.discrete_links,
                flat_system.FIRST_DISCRETE,
                flat_system.END_DISCRETE,
            )
        count = plan.table[i, call + flat_system.COUNT]
        if count == 0:
            continue
        buffer = plan.reals if kind == COPY_REALS else plan.discretes
        place = (plan.table[i, call + flat_system.VALUES] - buffer.ctypes.data) // _SIZES[call]
        own = links[plan.table[i, first] : plan.table[i, end]].tolist()
        runs = list(_runs([pair for pair in own if place <= pair[1] < place + count]))
        if (len(runs) - 1) * COPIES_PER_CALL <= count:
            rows += [_transfer(plan, i, call, target - place, source - place, n) for source, target, n in runs]
        else:
            rows += [[kind, 0, 0, source, n, target, i, call] for source, target, n in runs]
            rows.append(_transfer(plan, i, call, 0, 0, count))
    return rows


def _runs(links: Sequence[Sequence[int]]) -> Iterator[Run]:
    """Links, ordered by target, whose sources and targets both count up."""
    ordered = sorted(links, key=lambda link: link[1])
    for _, run in itertools.groupby(enumerate(ordered), lambda item: (item[1][0] - item[0], item[1][1] - item[0])):
        pairs = [pair for _, pair in run]
        yield pairs[0][0], pairs[0][1], len(pairs)


def _transfer(plan: Plan, i: int, call: int, skipped: int, offset: int, count: int) -> list[int]:
    """A set call for `count` of a component's inputs after the `skipped` first, with values at an offset."""
    group = plan.table[i, call : call + 4]
    references = group[flat_system.REFERENCES] + _REFERENCE_SIZE * skipped
    values = group[flat_system.VALUES] + _SIZES[call] * offset
    return [
        TRANSFER,
        group[flat_system.FUNCTION],
        plan.table[i, flat_system.COMPONENT],
        references,
        count,
        values,
        i,
        call,
    ]


def _step(plan: Plan, i: int) -> list[list[int]]:
    return [
        [
            STEP,
            plan.table[i, flat_system.DO_STEP],
            plan.table[i, flat_system.COMPONENT],
            0,
            0,
            0,
            i,
            flat_system.DO_STEP,
        ]
    ]


def _get(plan: Plan, i: int) -> list[list[int]]:
    """The calls that fetch what component i shows."""
    rows = []
    for call in _GETS:
        function, references, count, values = plan.table[i, call : call + 4]
        if count:
            rows.append([TRANSFER, function, plan.table[i, flat_system.COMPONENT], references, count, values, i, call])
    return rows
