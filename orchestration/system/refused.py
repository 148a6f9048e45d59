"""Errors of requests to a system, with what to do instead."""

from collections import Counter
from collections.abc import Sequence

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.given import require_type
from orchestration.fmi.names import base_name, suggestion
from orchestration.system.component import Component, Connection


def require_names(system: str, names: Sequence[str]) -> None:
    """Refuse names of components that are empty, have a dot, or are used twice, and a system without components.

    Raises
    ------
    SystemDescriptionError
    """
    if not names:
        msg = f'System {system} has no components; give some, as System.of({{"plant": "Plant.fmu"}}).'
        raise SystemDescriptionError(msg)
    counts = Counter(names)
    for name in names:
        if counts[name] > 1 or not name or "." in name:
            meant = name.replace(".", "_") or "plant"
            msg = (
                f"System {system}: the component name {name!r} is empty, has a dot, or is used twice;"
                f" use another one, such as {meant}."
            )
            raise SystemDescriptionError(msg)


def no_component(system: str, name: object, known: Sequence[str]) -> SystemDescriptionError:
    """The error for a name that no component has; it gives near names."""
    return SystemDescriptionError(f"System {system} has no component {name}; {suggestion(str(name), known)}")


def require_order(names: Sequence[str], present: Sequence[str]) -> None:
    """Refuse an order that does not name each of the present components once.

    Raises
    ------
    SystemDescriptionError
    """
    require_type("The order", names, (list, tuple), f"give a list of names, as [{present[0]!r}, ...]")
    said = ", ".join(map(str, names))
    known = set(present)
    for name in names:
        if not isinstance(name, str) or name not in known:
            msg = f"The order {said}: there is no component {name}; {suggestion(str(name), present)}"
            raise SystemDescriptionError(msg)
    if sorted(names) != sorted(present):
        msg = f"The order {said} must name each of {', '.join(present)} once."
        raise SystemDescriptionError(msg)


def driven_twice(connection: Connection, other: Connection) -> SystemDescriptionError:
    """The error of a connection to an input that another connection drives."""
    same = (other.source, other.output) == (connection.source, connection.output)
    advice = "leave it out" if same else "an input takes one source"
    where = f"{connection.target}.{connection.input}"
    return SystemDescriptionError(
        f"Connection {connection}: {where} already has a source, {other.source}.{other.output}; {advice}."
    )


def not_a_path(text: str, components: Sequence[Component]) -> SystemDescriptionError:
    """The error of a text that is not ``component.variable``, with those that it may have meant."""
    bearers = [
        f"{component.name}.{text}"
        for component in components
        if any(text in (variable, base_name(variable)) for variable in component.description.variables)
    ]
    first = components[0]
    example = bearers or [f"{first.name}.{next(iter(first.description.variables), 'x')}"]
    return SystemDescriptionError(
        f"{text!r} is not of the form component.variable, such as {' or '.join(example[:2])}."
    )


def required_time(system: str, value: float | None, name: str, what: str) -> float:
    """Return a time of a run, s, that the run or the system must give.

    Parameters
    ----------
    name
        Name of the argument; the option of the command line is the same, without ``_time``.
    what
        The time in words.
    """
    if value is None:
        msg = f"System {system} has no {what}; give one, in s, as `{name}` or --{name.removesuffix('_time')}."
        raise SystemDescriptionError(msg)
    return value
