"""Prints what is in an FMU, a system or a file of results: ``adaptimp info``."""

import json as formats
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from orchestration.cli.facts import fmu_facts, result_facts, system_facts
from orchestration.cli.output import output, watched, width
from orchestration.cli.signals import signal_table
from orchestration.cli.systems import FMU, is_package, named_fmu, named_system
from orchestration.cli.tables import definitions, table
from orchestration.errors import UnknownNameError, printable
from orchestration.fmi.codes import (
    DIFFERENTIATES,
    INTERPOLATES,
    NEEDS_TOOL,
    ONE_INSTANCE,
    SAVES_STATE,
    SERIALIZES_STATE,
    VARIES_STEP,
)
from orchestration.fmi.names import arrays, base_name, common_beginning, suggestion
from orchestration.results.formats import READERS

SHOWN = ("input", "output", "parameter", "calculatedParameter")
"""Causalities that are shown, in this order; JSON has all."""
ABILITIES = {
    SAVES_STATE: "save its state",
    SERIALIZES_STATE: "serialize its state",
    INTERPOLATES: "interpolate its inputs",
    DIFFERENTIATES: "give directional derivatives",
    VARIES_STEP: "take steps of different lengths",
}
MOST_VALUES = 12
"""Values of an array that are shown if they differ; JSON has all."""
LONGEST = 200
"""Characters of a text of metadata that is shown; JSON has all."""


def print_info(name: str, variant: str | None = None, *, json: bool) -> None:
    """Print what a file, a scenario or a shipped FMU holds, as text or as JSON."""
    with watched():
        facts = _facts(name, variant)
    if json:
        output.data(formats.dumps(facts, indent=2))
        return
    text = {"fmu": _fmu_text, "system": _system_text, "result": _result_text}[facts["kind"]]
    for part in text(facts, width()):
        output.data(part)


def _facts(name: str, variant: str | None) -> dict[str, Any]:
    from fmus.catalog import MODELS, VARIANTS
    from orchestration.paper.scenarios import ALL_SCENARIOS

    path, suffix = Path(name), Path(name).suffix.lower()
    if is_package(name):
        from orchestration.ssp.read import variants_of

        return system_facts(named_system(name, variant), variants_of(path))
    if suffix in READERS:
        return result_facts(path)
    if suffix == FMU or name in MODELS or name in VARIANTS:
        return fmu_facts(named_fmu(name))
    if name in ALL_SCENARIOS:
        return system_facts(named_system(name, variant))
    known = [*ALL_SCENARIOS, *MODELS, *VARIANTS]
    msg = f"{name} is neither an .fmu, .ssp, .ssd, .csv or .parquet file nor a scenario or a shipped FMU; "
    raise UnknownNameError(msg + suggestion(name, known))


def _fmu_text(facts: Mapping[str, Any], width: int) -> Iterator[str]:
    experiment = {key: value for key, value in facts["experiment"].items() if value is not None}
    here = "" if facts["runs_here"] or not facts["platforms"] else " (not this machine)"
    about = {
        "what": facts["description"],
        "file": facts["file"],
        "made by": facts["tool"],
        "runs on": (", ".join(facts["platforms"]) or "no machine: the archive has no binary") + here,
        "needs": "the tool that exported it" if NEEDS_TOOL in facts["capabilities"] else "",
        "can": ", ".join(text for name, text in ABILITIES.items() if name in facts["capabilities"]),
        "cannot": "be instantiated twice in a process" if ONE_INSTANCE in facts["capabilities"] else "",
        "default experiment": _times(experiment),
        "carries": ", ".join(map(_carried, facts["references"])),
        "notice": " ".join(facts["notices"]),
    }
    yield f"{printable(facts['name'])}: FMI 2.0 FMU for co-simulation"
    yield definitions([(key, value) for key, value in about.items() if value], width, "  ")
    for causality in SHOWN:
        rows = _variables([v for v in facts["variables"] if v["causality"] == causality])
        if rows:
            yield f"\n{_plural(causality)}"
            yield _without_empty(("name", "unit", "start", "description"), rows, width)


def _carried(reference: Mapping[str, Any]) -> str:
    """A file beside the definition, with its role, and with the cases that it is for."""
    variants = [label.removeprefix("variant:") for label in reference["labels"]]
    return f"{reference['file']} ({reference['role']}{' for ' if variants else ''}{', '.join(variants)})"


def _without_empty(head: Sequence[str], rows: Sequence[Sequence[str]], width: int, together: int = 2) -> str:
    """A table without the columns that have nothing in any row."""
    kept = [i for i, column in enumerate(zip(*rows, strict=True)) if any(column)]
    return table([head[i] for i in kept], [[row[i] for i in kept] for row in rows], width, together=together)


def _variables(variables: Sequence[Mapping[str, Any]]) -> list[tuple[str, str, str, str]]:
    """Name, unit, start values and description of variables; elements of an array that differ little are one row."""
    return [
        (
            name,
            of[0]["unit"],
            _values([_value(v) for v in of]),
            common_beginning([v["description"] for v in of]),
        )
        for name, of in _whole(variables, ("unit", "type"))
    ]


def _whole(
    variables: Sequence[Mapping[str, Any]], alike: Sequence[str]
) -> Iterator[tuple[str, list[Mapping[str, Any]]]]:
    """Variables by name; those of an array together, if all elements agree in what `alike` names."""
    names = tuple(v["name"] for v in variables)
    found, done = arrays(names), set()
    for variable in variables:
        base = base_name(variable["name"])
        elements = [variables[i] for i in found[base].ravel()] if base in found else []
        if len({tuple(v[key] for key in alike) for v in elements}) != 1:
            yield variable["name"], [variable]
        elif base not in done:
            done.add(base)
            yield f"{base}{list(found[base].shape)}", elements


def _values(texts: Sequence[str]) -> str:
    """The values of a variable or of an array: one if they agree, else each of them in the order of the elements."""
    if len(set(texts)) == 1:
        return texts[0]
    return ", ".join(texts[:MOST_VALUES]) + (", ..." if len(texts) > MOST_VALUES else "")


def _value(variable: Mapping[str, Any]) -> str:
    start = variable["start"]
    if start is None or isinstance(start, str):
        return start or ""
    return ("true" if start else "false") if variable["type"] == "Boolean" else f"{start:.6g}"


def _system_text(facts: Mapping[str, Any], width: int) -> Iterator[str]:
    counts = f"{len(facts['components'])} components, {len(facts['connections'])} connections"
    given = {key: value for key, value in facts["experiment"].items() if value is not None}
    times = _times({key: value for key, value in given.items() if key != "start" or value != 0})
    yield f"System {printable(facts['name'])}: {counts}" + (f"; {times}" if times else "")
    rows = [
        (c["name"], c["model"], _sampling(c), *(str(c[kind]) for kind in ("inputs", "outputs", "parameters")))
        for c in facts["components"]
    ]
    if len(facts["variants"]) > 1:
        yield f"  variants: {', '.join(facts['variants'])}"
    yield "\ncomponents, in the order of stepping"
    numbers = ("inputs", "outputs", "parameters")
    yield table(("name", "model", "sampling", *numbers), rows, width, numbers=numbers, together=2)
    yield "\nconnections"
    yield definitions(_signals(facts["connections"]), width, "  ")
    if facts["unconnected_inputs"]:
        yield "\ninputs without a connection, which keep their start values"
        yield definitions([("", ", ".join(facts["unconnected_inputs"]))], width)
    if facts["start_values"]:
        yield "\nstart values that the system sets"
        yield _without_empty(("name", "unit", "value", "remark"), _start_values(facts), width, 4)
    if facts["notices"]:
        yield "\nnotices"
        yield definitions([("", notice) for notice in facts["notices"]], width)


def _start_values(facts: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Name, unit, numbers and whether they are assumed; elements of an array that agree in this are one row."""
    values = [{**v, "remark": "assumed" if v["name"] in facts["assumptions"] else ""} for v in facts["start_values"]]
    return [
        (name, of[0]["unit"], _values([f"{v['value']:.6g}" for v in of]), of[0]["remark"])
        for name, of in _whole(values, ("unit", "remark"))
    ]


def _signals(connections: Sequence[str]) -> list[tuple[str, str]]:
    """Connections between the same components in one row, arrays once."""
    found: dict[str, dict[str, None]] = {}
    for connection in connections:
        ends, _, scale = connection.partition(" (")
        (source, output_), (target, input_) = (end.split(".", 1) for end in ends.split(" -> "))
        names = [base_name(output_), base_name(input_)]
        said = names[0] if names[0] == names[1] else " -> ".join(names)
        found.setdefault(f"{source} -> {target}", {})[f"{said} ({scale}" if scale else said] = None
    return [(ends, ", ".join(names)) for ends, names in found.items()]


def _sampling(component: Mapping[str, Any]) -> str:
    period = component["sample_time"]
    return "continuous" if period is None else f"every {period:g} s"


def _result_text(facts: Mapping[str, Any], width: int) -> Iterator[str]:
    span = "" if facts["rows"] == 0 else f", t = {facts['start_time']:g} to {facts['stop_time']:g} s"
    state = "" if facts["status"] == "complete" else f", {facts['status']}: {facts['message']}"
    yield f"{printable(facts['file'])}: {facts['rows']} rows{span}, {len(facts['signals'])} columns{state}"
    plain = [(key, value) for key, value in facts["metadata"].items() if len(value) <= LONGEST]
    if plain:
        yield definitions(plain, width, "  ")
    yield ""
    yield signal_table(facts["signals"], width)


def _times(experiment: Mapping[str, float]) -> str:
    return ", ".join(f"{key} {value:g}{'' if key == 'tolerance' else ' s'}" for key, value in experiment.items())


def _plural(causality: str) -> str:
    return {"calculatedParameter": "calculated parameters"}.get(causality, f"{causality}s")
