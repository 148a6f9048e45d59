"""Integration of an arm in space between two ticks: DOP853 steps per smooth segment, which no contact event crosses.

The rules are those of `tests.reference.segment`, which integrates the planar arm: the torque is held; a step is halved
if its error estimate is too large; where the tip meets or leaves the wall, or a damped wall would begin to pull, the
step ends, and the other law of force takes over. Coefficients: Hairer, Norsett, Wanner (1993), as published in SciPy.
"""

import numpy as np

from tests.reference.segment import E3, E5, GAP, MAX_EVENTS, MIN_FRACTION, PULL, A, B


class IntegrationError(RuntimeError):
    """Error for a plant that cannot be integrated to the required accuracy."""


class Segment:
    """Advances the state y = (q, dq), shape (2 n,), of a plant under held torques.

    Parameters
    ----------
    plant : Plant
        Gives `flow(y, tau, loaded)`, shape (2 n,), and `event(which, y, dy)`, the value of an event function and the
        rate of this value.
    solver : tests.reference.segment.Solver
        Accuracy of a step.
    """

    def __init__(self, plant, solver):
        self.plant, self.solver = plant, solver
        self.contact, self.pushing = False, True

    def begin(self, y):
        """Find out whether the tip is in contact at a state; a tip at gap = 0 that moves inward is."""
        gap, rate = self.plant.event(GAP, y, y)
        self.contact = gap > 0.0 or (gap == 0.0 and rate > 0.0)
        self.pushing = self.plant.event(PULL, y, y)[0] > 0.0

    def advance(self, y, tau, duration):
        """Return the state after `duration` (s).

        Raises
        ------
        IntegrationError
            If the error estimate stays too large, or if there are too many events.
        """
        done, events, limit = 0.0, 0, duration / self.solver.substeps
        h = limit
        while done < duration:
            # The last step ends on the tick exactly: a rest below 1e-12 of the segment is rounding of `done`.
            rest = duration - done
            h = rest if h > rest * (1.0 - 1e-12) else h
            start = self.plant.flow(y, tau, self.loaded)
            y_new, dy_new, error = self._step(y, start, h, tau)
            if not error <= 1.0:
                h *= 0.5
                if h < MIN_FRACTION * duration:
                    message = "The error estimate stays above its tolerance at 2**-40 of the sample time."
                    raise IntegrationError(message)
                continue
            which, length = self._first_event((y, start), (y_new, dy_new), h, tau)
            if which is None:
                y, done = y_new, duration if h == rest else done + h
            else:
                events += 1
                if events > MAX_EVENTS:
                    message = f"There are more than {MAX_EVENTS} contact events between two ticks."
                    raise IntegrationError(message)
                y = self._step(y, start, length, tau)[0]
                self._toggle(which, y)
                done += length
            h = limit
        return y

    @property
    def loaded(self):
        """Whether the wall exerts a force."""
        return self.contact and self.pushing

    def _toggle(self, which, y):
        """Change the mode at an event; the gap rate decides whether a wall that was just met pushes."""
        if which == GAP:
            self.contact = not self.contact
            self.pushing = self.plant.event(PULL, y, y)[0] > 0.0
        else:
            self.pushing = not self.pushing

    def _step(self, y, start, h, tau):
        """Make one step of length h; return the state at its end, its rate there, and the scaled error estimate."""
        k = np.empty((13, len(y)))
        k[0] = start
        for stage in range(1, 12):
            k[stage] = self.plant.flow(y + h * (A[stage, :stage] @ k[:stage]), tau, self.loaded)
        y_new = y + h * (B @ k[:12])
        k[12] = self.plant.flow(y_new, tau, self.loaded)
        scale = self.solver.atol + self.solver.rtol * np.maximum(np.abs(y), np.abs(y_new))
        five, three = (np.sum((E @ k / scale) ** 2) for E in (E5, E3))
        denominator = np.sqrt((five + 0.01 * three) * len(y))
        return y_new, k[12], h * five / denominator if denominator > 0.0 else 0.0

    def _first_event(self, begin, end, h, tau):
        """Return the first event within an accepted step, or None, and the step length up to this event (s)."""
        found, length = None, h
        for which in (GAP, PULL) if self.contact and self.plant.damped else (GAP,):
            sign = 1.0 if (self.contact if which == GAP else self.pushing) else -1.0
            _, s0 = (sign * part for part in self.plant.event(which, begin[0], begin[1]))
            v1, s1 = (sign * part for part in self.plant.event(which, end[0], end[1]))

            def probe(step, which=which, sign=sign):
                y, dy, _ = self._step(begin[0], begin[1], step, tau)
                return [sign * part for part in self.plant.event(which, y, dy)]

            low, high = 0.0, h
            if v1 < 0.0:
                if s0 > 0.0 and s1 > 0.0:  # just entered and still within rounding of the crossing
                    continue
                if s0 > 0.0:  # entered and left within the step: the crossing lies behind the extremum
                    low = _bisect(lambda step, probe=probe: probe(step)[1], 0.0, h)
            elif s0 < 0.0 and s1 > 0.0:
                high = _bisect(lambda step, probe=probe: -probe(step)[1], 0.0, h)
                if probe(high)[0] >= 0.0:
                    continue
            else:
                continue
            root = _bisect(lambda step, probe=probe: probe(step)[0], low, high)
            if found is None or root < length:
                found, length = which, root
        return found, length


def _bisect(value, low, high):
    """Return the step length at which `value` turns negative."""
    while True:
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            return high
        if value(middle) >= 0.0:
            low = middle
        else:
            high = middle
