"""What the metadata of a result tell of its origin: components, connections, order, hashes, versions, seeds."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from orchestration.fmi.names import base_name
from orchestration.master.algorithm import ALGORITHMS, SEQUENTIAL
from orchestration.results.result import Result

_EXCHANGE = re.compile(r"exchange='(\w+)'")
_NAME = re.compile(r"name='([\w-]+)'")
_CONNECTION = re.compile(r"^([^.]+)\.(.+?) -> ([^.]+)\.(.+?)(?: \(.*\))?$")
"""A connection as its text: source, output, target, input, and in brackets a factor."""


@dataclass(frozen=True)
class Link:
    """All connections from one component to another.

    Attributes
    ----------
    signals
        Names of the outputs, arrays once.
    delayed
        Whether the target computes a step with what the source showed before this step; None if that is not known.
    """

    source: str
    target: str
    signals: Sequence[str]
    delayed: bool | None


@dataclass(frozen=True)
class Origin:
    """How a run was made, as far as its result says.

    Attributes
    ----------
    components
        Of each FMU: name, file, model, identifier, guid and sha256.
    order
        Names of the components in the order of stepping.
    algorithm, algorithm_text
        Name of the algorithm, and the algorithm with all of its settings.
    start
        Start values that the system sets, by component and variable.
    step, stop_time
        s.
    """

    system: str
    components: Sequence[Mapping[str, str]]
    order: Sequence[str]
    links: Sequence[Link]
    algorithm: str
    algorithm_text: str
    start: Mapping[str, Mapping[str, float | str | None]]
    seeds: Mapping[str, float | str | None]
    versions: Mapping[str, str]
    step: float | None
    stop_time: float | None


def origin_of(result: Result) -> Origin | None:
    """The origin of a result; None if its metadata does not tell it, as that of a CSV file."""
    told = result.metadata
    if not {"components", "connections", "order"} <= told.keys():
        return None
    order = _parsed(told["order"])
    algorithm = told.get("algorithm", "")
    if algorithm in ALGORITHMS:
        algorithm = repr(ALGORITHMS[algorithm])
    name = _NAME.search(algorithm)
    return Origin(
        system=told.get("system", ""),
        components=_parsed(told["components"]),
        order=order,
        links=_links(_parsed(told["connections"]), order, algorithm),
        algorithm=name[1] if name else algorithm,
        algorithm_text=algorithm,
        start=_parsed(told.get("start", "{}")),
        seeds=_parsed(told.get("seeds", "{}")),
        versions=_parsed(told.get("versions", "{}")),
        step=_number(told.get("step")),
        stop_time=_number(told.get("stop_time")),
    )


def _parsed(text: str) -> Any:
    return json.loads(text)


def _number(text: str | None) -> float | None:
    return None if text is None else float(text)


def _links(connections: Sequence[str], order: Sequence[str], algorithm: str) -> list[Link]:
    """Connections by pair of components, in the order in which they were made."""
    pairs: dict[tuple[str, str], dict[str, None]] = {}
    for text in connections:
        match = _CONNECTION.match(text)
        if match:
            pairs.setdefault((match[1], match[3]), {})[base_name(match[2])] = None
    exchange = _EXCHANGE.search(algorithm)
    iterated = "correction=None" not in algorithm
    places = {name: place for place, name in enumerate(order)}
    found = []
    for (source, target), signals in pairs.items():
        known = exchange is not None and not iterated and source in places and target in places
        forwards = known and exchange is not None and exchange[1] == SEQUENTIAL and places[source] < places[target]
        found.append(Link(source, target, list(signals), not forwards if known else None))
    return found
