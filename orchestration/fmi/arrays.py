"""Treats an FMU's variables as arrays: which variables form an array, and which values fit a type.

A name is that of a variable, ``tau[1]``, or of an array, ``tau``. An array consists of all variables ``tau[i]`` in
the order of i, which counts from 1, or from 0, without a hole.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from orchestration.errors import SignalError
from orchestration.fmi.codes import BOOLEAN, REAL, STRING
from orchestration.fmi.description import Variable
from orchestration.fmi.given import shown
from orchestration.fmi.names import arrays as positions_of_arrays
from orchestration.fmi.names import suggestion

Value = float | str | Sequence[float] | np.ndarray


def arrays(names: Iterable[str]) -> dict[str, list[str]]:
    """Return the names of the elements of each one-dimensional array, by its name, in the order of their index."""
    names = tuple(names)
    whole = positions_of_arrays(names)
    return {
        base: [names[i] for i in positions]
        for base, positions in whole.items()
        if positions.ndim == 1 and base not in names
    }


def listed(names: Iterable[str]) -> str:
    """Return names as a text that names each array once: ``dt_max, tau (2), q_start (2)``."""
    names = list(names)
    of_arrays = arrays(names)
    base_of = {element: base for base, elements in of_arrays.items() for element in elements}
    return ", ".join(
        dict.fromkeys(f"{base_of[n]} ({len(of_arrays[base_of[n]])})" if n in base_of else n for n in names)
    )


def typed(fmu: str, variable: Variable, value: float | str) -> Any:
    """Convert a value to the FMI type of its variable without rounding; texts become bytes.

    Raises
    ------
    SignalError
        If the value does not fit the type.
    """
    if isinstance(value, str) or variable.type == STRING:
        fits = isinstance(value, str) and variable.type == STRING
    else:
        fits = variable.type == REAL or (value in (0, 1) if variable.type == BOOLEAN else float(value).is_integer())
    if not fits:
        msg = f"{fmu}: {variable.name} is of type {variable.type}; {value!r} is not."
        raise SignalError(msg)
    if isinstance(value, str):
        return value.encode()
    return value if variable.type == REAL else int(value)


def _not_numbers(fmu: str, name: str, value: Any) -> SignalError:
    """The error of values that are not numbers."""
    only = value[0] if isinstance(value, list) and len(value) == 1 else value
    return SignalError(f"{fmu}: {name} takes numbers, not {shown(only)}.")


class Signals:
    """The variables of an FMU by the names of variables and of arrays.

    Parameters
    ----------
    fmu
        Name of the FMU, for messages.
    """

    def __init__(self, fmu: str, variables: Mapping[str, Variable]) -> None:
        self.fmu, self.variables = fmu, variables
        self._arrays = arrays(variables)
        self.outputs = [v for v in variables.values() if v.causality == "output" and v.type != STRING]
        self._driven = {
            name: None
            for name, v in variables.items()
            if v.causality == "input" or (v.causality == "parameter" and v.variability == "tunable")
        }

    def elements(self, name: str) -> list[Variable]:
        """Return the variables that a name of a variable or an array stands for.

        Raises
        ------
        SignalError
            If the FMU has neither a variable nor an array of that name.
        """
        if name in self.variables:
            return [self.variables[name]]
        if name in self._arrays:
            return [self.variables[element] for element in self._arrays[name]]
        msg = f"{self.fmu} has no variable {name}; {suggestion(name, self.variables)}"
        raise SignalError(msg)

    def rows(self, name: str, value: Any, *, driven: bool = False) -> np.ndarray:
        """Values by row, shape (n, k), for the k variables of a name; `driven` ones must be inputs or tunable.

        Raises
        ------
        SignalError
            If the name, a shape or a type is wrong.
        """
        elements = self.elements(name)
        if driven and any(variable.name not in self._driven for variable in elements):
            causality = elements[0].causality
            msg = (
                f"{self.fmu} has no input {name}, which is of causality {causality}; its inputs and tunable parameters"
                f" are {listed(self._driven)}."
            )
            raise SignalError(msg)
        try:
            array = np.asarray(value)
            texts = array.dtype.kind == "U" and elements[0].type != STRING
            if array.dtype.kind == "c" or texts or (array.dtype.kind == "O" and None in array.ravel().tolist()):
                raise _not_numbers(self.fmu, name, value)
            array = array if array.dtype.kind == "U" else array.astype(float)
        except (TypeError, ValueError) as error:
            raise _not_numbers(self.fmu, name, value) from error
        shape = () if name in self.variables else (len(elements),)
        if array.ndim != 1 + len(shape) or array.shape[1:] != shape:
            needed, given = (("n", *shape), array.shape) if driven else (shape, array.shape[1:])
            text = f"({', '.join(map(str, needed))}{',' * (len(needed) == 1)})"
            msg = f"{self.fmu}: {name} takes an array of shape {text}, not {given}."
            raise SignalError(msg)
        return array.reshape(len(array), -1)

    def calls(self, rows: Mapping[str, np.ndarray]) -> list[tuple[str, list[int], list[list[Any]]]]:
        """Prepare the set calls for arrays of shape (n, k) by name: type, value references and values by row.

        Raises
        ------
        SignalError
            If a variable is given twice, or a value does not fit its type.
        """
        by_type: defaultdict[str, tuple[list[int], list[list[Any]]]] = defaultdict(lambda: ([], []))
        given: dict[str, str] = {}
        for name, values in rows.items():
            for variable, column in zip(self.elements(name), values.T, strict=True):
                if given.setdefault(variable.name, name) != name:
                    msg = f"{self.fmu}: {variable.name} is given twice, also by {given[variable.name]}."
                    raise SignalError(msg)
                references, columns = by_type[variable.type]
                references.append(variable.reference)
                columns.append([typed(self.fmu, variable, value) for value in column.tolist()])
        return [
            (kind, references, [list(row) for row in zip(*columns, strict=True)])
            for kind, (references, columns) in by_type.items()
        ]

    def grouped(self, table: np.ndarray) -> dict[str, np.ndarray]:
        """Split a table of shape (n, number of outputs) into outputs by name, and arrays by their base name."""
        places = {variable.name: i for i, variable in enumerate(self.outputs)}
        found = {name: table[:, i].copy() for name, i in places.items()}
        for base, elements in self._arrays.items():
            if all(name in places for name in elements):
                found[base] = table[:, [places[name] for name in elements]]
        return found
