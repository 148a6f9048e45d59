"""What was predicted of the stability of a run, beside the columns that the run recorded."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

from orchestration.results.columns import COMPLETE, Columns

VERDICT = "verdict"
"""Key of the metadata with a prediction that was made before the run, as JSON of an object."""


@dataclass(frozen=True)
class Prediction:
    """Whether a run was predicted to be stable, in words.

    Attributes
    ----------
    stable
        Whether no deviation visibly grows near the start of the run; None if that could not be predicted.
    text
        The words of ``adaptimp run``: for an unstable run the growth, the largest stable step and advice.

    Examples
    --------
    >>> from orchestration import scenario, simulate
    >>> late = simulate(scenario("fig2").with_sample_time(1.0))  # s; half of the run is one step
    >>> late.verdict.stable
    False
    >>> print(late.verdict)
    fig2: gauss-seidel with a step of 1 s is UNSTABLE at the start: ...
    >>> from orchestration import Prediction
    >>> late.verdict.word, Prediction.of_json(late.verdict.as_json()) == late.verdict
    ('unstable', True)
    """

    stable: bool | None
    text: str

    def __str__(self) -> str:
        """The words."""
        return self.text

    @property
    def word(self) -> str:
        """One word or a few: stable, unstable, or that there is no verdict."""
        return {True: "stable", False: "unstable", None: "no verdict on stability"}[self.stable]

    def as_json(self) -> str:
        """The prediction as a text for metadata."""
        return json.dumps({"stable": self.stable, "text": self.text})

    @classmethod
    def of_json(cls, text: str) -> "Prediction":
        """The prediction that `as_json` made a text of; of another text it is the text, without a verdict."""
        try:
            found = json.loads(text)
        except json.JSONDecodeError:
            return cls(None, text)
        if isinstance(found, dict) and found.keys() == {"stable", "text"}:
            return cls(found["stable"], str(found["text"]))
        return cls(None, text)


@dataclass(frozen=True, eq=False)
class PredictedColumns(Columns):
    """Columns of a run whose stability was predicted, or can be.

    Attributes
    ----------
    judge
        Predicts the stability of the run; None of numbers that come from elsewhere, such as a file.
    """

    judge: Callable[[], Prediction] | None = field(default=None, repr=False, kw_only=True)

    @cached_property
    def verdict(self) -> Prediction | None:
        """What is predicted of the stability of the run near its start.

        Without ``simulate(..., verdict=True)`` the prediction is made when it is asked for first, which takes some
        tenths of a second and needs the FMUs. A file has the prediction if it was made before the run, as
        ``adaptimp run`` does. None if there is none and it cannot be made: the numbers come from elsewhere.
        """
        if VERDICT in self.metadata:
            return Prediction.of_json(self.metadata[VERDICT])
        return None if self.judge is None else self.judge()

    @property
    def known_verdict(self) -> Prediction | None:
        """The prediction if it was made; None without making it."""
        return self.verdict if VERDICT in self.metadata else self.__dict__.get("verdict")

    @property
    def _state(self) -> str:
        """What became of the run, unless it is complete, and its prediction if it was made, each after a comma."""
        known = self.known_verdict
        words = [*([self.status] if self.status != COMPLETE else []), *([known.word] if known is not None else [])]
        return "".join(f", {word}" for word in words)
