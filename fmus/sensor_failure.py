"""Failures of a sensor: for some time the reading drops out, sticks, or has a spike.

A failure lasts from `failure_start` for `failure_duration`, and `failure` says of which kind it is:

    0  none
    1  dropout: the reading is 0
    2  stuck: the reading of the last tick before is held
    3  spike: `failure_force` is added to the force before range and resolution

A sensor that sticks from its first tick on holds the force of that tick. After the failure it measures as before.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, Limits, SampledModel, Type
from fmus.elements import of_task
from fmus.mechanics.task import Task

NONE, DROPOUT, STUCK, SPIKE = range(4)
ROUNDING = 1e-9  # of the sampling period, by which a tick may come before the time that it stands for


@dataclass(frozen=True)
class Failure:
    """The failure of a sensor's reading.

    Attributes
    ----------
    kind
        Symbol of the kind, shape (1,).
    active
        Whether the sensor fails at this tick, shape (1,).
    force
        Force that a spike adds, N, shape (m,).
    """

    kind: ca.SX
    active: ca.SX
    force: ca.SX

    def disturbed(self, force: ca.SX) -> ca.SX:
        """Return the force that the sensor feels, N, shape (m,)."""
        return ca.if_else(ca.logic_and(self.active, self.kind == SPIKE), force + self.force, force)

    def reading(self, model: SampledModel, healthy: ca.SX, force: ca.SX) -> ca.SX:
        """Declare the state that keeps the last reading, and return the reading at this tick, N, shape (m,).

        Parameters
        ----------
        healthy
            What a sensor without a failure reads, N, shape (m,).
        force
            Force at the tip, N, shape (m,), which stands for the reading before the first tick.
        """
        last = model.state("reading", force)
        held = ca.if_else(self.kind == STUCK, last, ca.if_else(self.kind == DROPOUT, 0, healthy))
        reading = ca.if_else(self.active, held, healthy)
        model.update(last, reading)
        return reading


def declare_failure(model: SampledModel, task: Task) -> Failure:
    """Declare when and how a sensor fails; by default it never does."""
    kind = model.parameter(
        "failure",
        NONE,
        type=Type.INTEGER,
        limits=Limits(NONE, SPIKE),
        description="Kind of failure: 0 none, 1 dropout (reads 0), 2 stuck (holds its reading), 3 spike",
    )
    begin = model.parameter(
        "failure_start", 0.0, unit="s", limits=NOT_NEGATIVE, description="Time from which the sensor fails"
    )
    duration = model.parameter(
        "failure_duration", 0.0, unit="s", limits=NOT_NEGATIVE, description="Time for which the sensor fails"
    )
    texts = of_task("Force that a spike adds", task, "Moment that a spike adds")
    force = model.parameter("failure_force", [0.0] * task.size, unit=task.each("N", "N.m"), description=texts)
    since = model.time - begin + ROUNDING * model.period
    active = ca.logic_and(kind != NONE, ca.logic_and(since >= 0, since < duration))
    return Failure(kind, active, force)
