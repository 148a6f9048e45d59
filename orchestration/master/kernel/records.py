"""What a type checker knows of the records in `orchestration.master.kernel.codes`: the types of their fields.

The classes stand in annotations only. A record that runs through the loops is one of NumPy's, which compiled
code reads and writes in place; its fields and their meaning are in `orchestration.master.kernel.codes`.
"""

from typing import Any, Protocol, TypeVar, overload

import numpy as np

Record = TypeVar("Record", covariant=True)


class Records(Protocol[Record]):
    """A record array of shape (n,)."""

    @property
    def shape(self) -> tuple[Any, ...]:
        """The number of records, alone in a tuple."""
        ...

    def __len__(self) -> int:
        """The number of records."""
        ...

    @overload
    def __getitem__(self, which: int, /) -> Record: ...

    @overload
    def __getitem__(self, which: str, /) -> np.ndarray: ...


class Operation(Protocol):
    """A record `orchestration.master.kernel.codes.OPERATION`."""

    kind: int
    function: int
    instance: int
    first: int
    count: int
    place: int
    subject: int
    call: int


class Link(Protocol):
    """A record `orchestration.master.kernel.codes.LINK`."""

    source: int
    target: int
    rate: int
    curvature: int
    fresh: int
    assumed: int
    component: int
    reference: int
    absolute: float
    relative: float
    end: float
    residual: float
    last_residual: float
    pair_start: float
    pair_residual: float


class Watched(Protocol):
    """A record `orchestration.master.kernel.codes.WATCHED`."""

    index: int
    accumulates: int
    absolute: float
    relative: float


class Method(Protocol):
    """A record `orchestration.master.kernel.codes.METHOD`."""

    sequential: int
    order: int
    newton: int
    directional: int
    sweeps: int
    max_iterations: int
    restarts: int
    controlled: int
    error_order: int
    first_step: float
    smallest_step: float
    largest_step: float
    duration: float
    crossing_tolerance: float
    one: int
    saved_states: int
    history: int
    reals: int
    discretes: int
    kept_discretes: int
    give: int
    series: int


class State(Protocol):
    """A record `orchestration.master.kernel.codes.STATE`."""

    interval: int
    steps_made: int
    n_past: int
    kept_n_past: int
    has_jacobian: int
    iterations: int
    rejected: int
    starting: int
    moved: int
    time: float
    next_step: float
    last_error: float
    jacobian_step: float
