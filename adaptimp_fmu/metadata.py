"""Metadata of a model besides its equations: its owner and license, and a default experiment.

The author of a model states them. An FMU does not claim anything that its author does not state.
"""

import math
from dataclasses import dataclass, fields

from adaptimp_fmu.errors import DefinitionError


@dataclass(frozen=True)
class Ownership:
    """Author, version, copyright and license of a model. An empty text claims nothing.

    Attributes
    ----------
    author
        Name and organization of the model's author.
    version
        Version of the model, for example ``"1.0"``.
    copyright
        Copyright notice, for example ``"(c) 2026 Ada Example"``.
    license
        The license in a few words, for example ``"BSD-3-Clause"`` or ``"Confidential"``.
    license_text
        The license's full text. The FMU keeps the text in its folder ``documentation/licenses``.

    Examples
    --------
    >>> from adaptimp_fmu import ContinuousModel, Ownership
    >>> model = ContinuousModel("Cart", "A cart")
    >>> model.ownership = Ownership(author="Ada Example", version="1.0", license="BSD-3-Clause")
    >>> model.ownership.attributes()
    {'author': 'Ada Example', 'version': '1.0', 'license': 'BSD-3-Clause'}
    """

    author: str = ""
    version: str = ""
    copyright: str = ""
    license: str = ""
    license_text: str = ""

    def attributes(self) -> dict[str, str]:
        """Attributes of ``fmiModelDescription`` that are stated, by name."""
        stated = {name: getattr(self, name) for name in ("author", "version", "copyright", "license")}
        return {name: text for name, text in stated.items() if text}


@dataclass(frozen=True)
class Experiment:
    """Times and tolerance that an importer may start from; None leaves the choice to the importer.

    Attributes
    ----------
    start_time, stop_time
        First and last time of the experiment, s.
    step_size
        Communication step, s.
    tolerance
        Relative tolerance of the importer's integrator.

    Raises
    ------
    DefinitionError
        If a number is not finite, a step or a tolerance is not positive, or the experiment ends before it starts.

    Examples
    --------
    >>> from adaptimp_fmu import ContinuousModel, Experiment
    >>> model = ContinuousModel("Cart", "A cart")
    >>> model.experiment = Experiment(stop_time=10.0, step_size=1e-3)
    >>> model.experiment.stated()
    {'stop_time': 10.0, 'step_size': 0.001}
    """

    start_time: float | None = None
    stop_time: float | None = None
    step_size: float | None = None
    tolerance: float | None = None

    def __post_init__(self) -> None:
        """Refuse an experiment that cannot be run."""
        for name, value in self.stated().items():
            if not math.isfinite(value):
                msg = f"Default experiment: {name} is {value!r}; it must be finite."
                raise DefinitionError(msg)
        for name in ("step_size", "tolerance"):
            value = getattr(self, name)
            if value is not None and value <= 0:
                msg = f"Default experiment: {name} is {value!r}; it must be positive."
                raise DefinitionError(msg)
        start = self.start_time or 0.0
        if self.stop_time is not None and self.stop_time <= start:
            msg = f"Default experiment: stop_time {self.stop_time!r} s must be later than start_time {start!r} s."
            raise DefinitionError(msg)

    def stated(self) -> dict[str, float]:
        """Numbers that are stated, by the name of their field."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: float(value) for name, value in values.items() if value is not None}
