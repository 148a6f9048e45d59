"""Reads quantities off a run that figures and claims show: contact, errors, estimates."""

from dataclasses import dataclass

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.paper.numbers import TIP_START, TRUE_M2
from orchestration.paper.spatial_numbers import POSITIONS
from orchestration.paper.task_shape import PLANAR_SHAPE, TaskShape, count, forces, lengths, norms, scales, shape_of
from orchestration.results.result import Result

SETTLED, RECOVERED = 0.1, 0.05  # errors of m2_hat, kg, below which it counts as adapted, and as recovered


class NoContactError(OrchestrationError):
    """The tip never touched the wall in a run."""


@dataclass(frozen=True)
class Contact:
    """The time in which the tip touched the wall.

    Attributes
    ----------
    first, last
        First and last communication point with a force, s.
    enter, leave
        Tip position there, m, shape (2,) or (3,).
    share
        Part of the communication points from first to last at which the force is not zero.
    phases
        Number of separate contacts; more than one means that the tip bounced.
    peak
        Largest norm of the force, N.
    """

    first: float
    last: float
    enter: np.ndarray
    leave: np.ndarray
    share: float
    phases: int
    peak: float


def contact(result: Result) -> Contact:
    """When and where the tip touched the wall in a run.

    Raises
    ------
    NoContactError
        If the tip never touched the wall.
    """
    force = forces(result["plant.F_ext"])
    touching = force > 0
    if not touching.any():
        msg = (
            f"The tip never touched the wall from {result.time[0]:g} s to {result.time[-1]:g} s:"
            " plant.F_ext is zero in every row; move the wall or let the run last longer."
        )
        raise NoContactError(msg)
    first, last = np.flatnonzero(touching)[[0, -1]]
    x = result["plant.x"][:, :POSITIONS]
    return Contact(
        first=float(result.time[first]),
        last=float(result.time[last]),
        enter=x[first],
        leave=x[last],
        share=float(touching[first : last + 1].mean()),
        phases=int((np.diff(touching.astype(int)) > 0).sum() + touching[0]),
        peak=float(force.max()),
    )


def at_ticks(result: Result, name: str, size: int | None = None) -> np.ndarray:
    """The columns ``name[1]``, ``name[2]``, ... at the controller's ticks, shape (n_ticks, size).

    Parameters
    ----------
    size
        Number of columns; all that the run has if None.
    """
    return np.column_stack([result.at_ticks(f"{name}[{i}]") for i in range(1, (size or count(result, name)) + 1)])


def distance_from_start(result: Result) -> float:
    """Distance of the tip from where it began, at the end of a run, m; in space the orientation counts, too."""
    x = result["plant.x"]
    begin = np.array(TIP_START) if x.shape[1] == len(TIP_START) else x[0]
    return float(np.linalg.norm((x[-1] - begin) * scales(x.shape[1])))


def largest_norm(vectors: np.ndarray) -> float:
    """Largest Euclidean norm among vectors of shape (n, m)."""
    return float(norms(vectors).max())


def largest_length(vectors: np.ndarray) -> float:
    """Largest size |S e| among errors of the task coordinates, m, shape (n, m)."""
    return float(lengths(vectors).max())


def steady_force(result: Result) -> float:
    """Mean norm of the force while the tip touches the wall, N, from its second touch on (or its only one).

    The first touch is the impact.

    Raises
    ------
    NoContactError
        If the tip never touched the wall.
    """
    contact(result)
    force = forces(result["plant.F_ext"])
    begins = np.flatnonzero(np.diff((force > 0).astype(int), prepend=0) > 0)
    steady = force[begins[min(1, len(begins) - 1)] :]
    return float(steady[steady > 0].mean())


def free_error(result: Result) -> float:
    """Largest |e| before the first contact, m, or of the whole run if the tip never touches the wall."""
    touching = np.flatnonzero(forces(result["plant.F_ext"]) > 0)
    first = result.time[touching[0]] if len(touching) else np.inf
    e = lengths(at_ticks(result, "controller.e"))
    return float(e[result.tick_times("controller.e[1]") < first].max())


RECORDED = tuple(
    f"{name}[{i}]" for name in ("controller.e", "controller.tau_cmd", "plant.F_ext", "plant.x") for i in (1, 2)
)
"""Columns that `summarize` needs, besides the estimate."""

ESTIMATE = PLANAR_SHAPE.estimate


def recorded(shape: TaskShape) -> tuple[str, ...]:
    """Columns that `summarize` needs of a run of a task, with the estimate."""
    sizes = {"controller.e": shape.size, "controller.tau_cmd": shape.joints}
    names = (*sizes, "plant.F_ext", "plant.x")
    return (*(f"{n}[{i}]" for n in names for i in range(1, sizes.get(n, shape.size) + 1)), shape.estimate)


@dataclass(frozen=True)
class Summary:
    """A run with adaptation in numbers; errors of m2_hat in kg, times in s, lengths in m.

    In space m2 is the payload's mass, and the size of an error is |S e|.

    Attributes
    ----------
    m2_settled
        Time from which the error of m2_hat stays within `SETTLED` until the first contact.
    m2_at_contact
        Absolute error of m2_hat at the first contact.
    m2_in_contact
        Largest absolute error of m2_hat during contact.
    m2_fluctuation
        Range of m2_hat during contact, from its smallest to its largest value.
    m2_recovery
        Time after the last contact from which the error of m2_hat stays within `RECOVERED`.
    torque
        Largest absolute command of each joint, N.m, shape (n,).
    e_start, e_free
        Largest |e| before the first contact: of all, and from half of that time on.
    e_contact, e_contact_rms, e_max
        Largest and rms |e| during contact; largest of the run.
    force_error
        Rms difference of the force from that of the ideal run while either touches, N.
    end
        Distance of the tip from its start at the end.
    """

    m2_settled: float
    m2_at_contact: float
    m2_in_contact: float
    m2_fluctuation: float
    m2_recovery: float
    torque: np.ndarray
    e_start: float
    e_free: float
    e_contact: float
    e_contact_rms: float
    e_max: float
    force_error: float
    end: float


def summarize(result: Result, ideal_force: np.ndarray | None = None) -> Summary:
    """Measure a run with adaptation.

    Parameters
    ----------
    ideal_force
        F_ext of the ideal run at the same communication points, N, shape (n_rows, m).
    """
    touch = contact(result)
    ticks = result.tick_times("controller.e[1]")
    during = (ticks >= touch.first) & (ticks <= touch.last)
    before, after = ticks < touch.first, ticks > touch.last
    e = lengths(at_ticks(result, "controller.e"))
    shape = shape_of(result)
    estimate = result.at_ticks(shape.estimate)
    error = np.abs(estimate - TRUE_M2)
    settled = np.flatnonzero(before & (error > SETTLED))
    recovered = np.flatnonzero(after & (error > RECOVERED))
    force = result["plant.F_ext"]
    return Summary(
        m2_settled=float(ticks[settled[-1]]) if settled.size else 0.0,
        m2_at_contact=float(error[before][-1]),
        m2_in_contact=float(error[during].max()),
        m2_fluctuation=float(np.ptp(estimate[during])),
        m2_recovery=float(ticks[recovered[-1]] - touch.last) if recovered.size else 0.0,
        torque=np.array([np.abs(command).max() for command in at_ticks(result, "controller.tau_cmd").T]),
        e_start=float(e[before].max()),
        e_free=float(e[before & (ticks > touch.first / 2)].max()),
        e_contact=float(e[during].max()),
        e_contact_rms=float(np.sqrt((e[during] ** 2).mean())),
        e_max=float(e.max()),
        force_error=_force_error(force, ideal_force),
        end=distance_from_start(result),
    )


def _force_error(force: np.ndarray, ideal: np.ndarray | None) -> float:
    if ideal is None:
        return float("nan")
    touching = (forces(force) > 0) | (forces(ideal) > 0)
    return float(np.sqrt((forces(force - ideal)[touching] ** 2).mean()))
