"""Sections of any run in words and tables: its state, verdict, energy and ranges; its system; where it comes from."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from orchestration.analysis.doctor.bonds import power_bonds
from orchestration.analysis.energy import ledger
from orchestration.errors import OrchestrationError, printable
from orchestration.master.algorithm import find_algorithm
from orchestration.report.diagram import diagram
from orchestration.report.markup import for_run, table
from orchestration.report.origin import Origin, origin_of
from orchestration.report.page import Section
from orchestration.results.columns import COMPLETE
from orchestration.results.result import Result
from orchestration.results.row_hash import row_hash
from orchestration.system.system import System

NO_BONDS = (
    "No pair of opposite connections carries power, such as a force and a speed, so there is no ledger of energy."
)
UNKNOWN = "The file does not tell its origin; a Parquet file that adaptimp run has written does."


def paragraph(text: str) -> Markup:
    """A text of anybody as a paragraph."""
    return Markup("<p>{}</p>").format(printable(text))


@dataclass(frozen=True)
class Told:
    """What is said of a run beyond what its rows say.

    Attributes
    ----------
    system
        The system that was run, where it is at hand.
    numbers
        Name, value and unit of the measures of the run; None instead of a value that there is not.
    again
        The command that makes the run again, or a sentence why there is none.
    hash
        SHA-256 of all rows, where the page has some of the columns only.
    """

    system: System | None = None
    numbers: Sequence[tuple[str, float | None, str]] = ()
    again: str = ""
    hash: str = ""


def numbers_section(results: Mapping[str, Result], told: Mapping[str, Told]) -> Section:
    """State, measures, verdict on stability, energy of the coupling, and the range of each column."""
    parts = [
        for_run(label, Markup().join(_of_run(result, told[label])), len(results)) for label, result in results.items()
    ]
    return Section("numbers", "Numbers", Markup().join(parts))


def _of_run(result: Result, told: Told) -> Iterator[Markup]:
    if result.status != COMPLETE:
        yield paragraph(f"The run is {result.status}: {result.message}")
    if told.numbers:
        rows = [(name, "none" if value is None else value, unit) for name, value, unit in told.numbers]
        yield table(("measure", "value", "unit"), rows)
    yield _verdict(result)
    yield from _energies(result, told.system)
    rows = [(name, unit, *values) for name, unit, values in _ranges(result)]
    found = table(("column", "unit", "least", "largest", "at the end"), rows)
    yield Markup("<details><summary>Ranges of {} columns</summary>{}</details>").format(len(rows), found)


def _verdict(result: Result) -> Markup:
    try:
        verdict = result.verdict
    except (OrchestrationError, OSError) as error:
        return paragraph(f"Stability of the coupling: it could not be judged: {error}")
    if verdict is None:
        return paragraph("Stability of the coupling: the file has no verdict; adaptimp run makes one before a run.")
    kind = {True: "good", False: "bad", None: ""}[verdict.stable]
    words = Markup('<p>Stability of the coupling: <span class="{}">{}</span>. {}</p>')
    return words.format(kind, verdict.word, printable(verdict.text))


def _energies(result: Result, system: System | None) -> Iterator[Markup]:
    """The energy that the coupling has added at each power bond, or why this is not known."""
    if system is None:
        yield paragraph(
            "Energy of the coupling: it needs the FMUs, which a file of rows does not have; adaptimp report SYSTEM"
            " makes a run with them."
        )
        return
    bonds = power_bonds(system)
    if not bonds:
        yield paragraph(f"Energy of the coupling: {NO_BONDS}")
        return
    origin = origin_of(result)
    rows = []
    for bond in bonds:
        try:
            found = ledger(result, bond, system, find_algorithm(origin.algorithm if origin else "gauss-seidel"))
        except OrchestrationError as error:
            yield paragraph(f"Energy of the coupling: {error}")
            return
        given, received = float(found.given[-1]), float(found.received[-1])
        rows.append((str(bond), given, received, float(found.residual[-1]), float(np.abs(found.residual).max())))
    head = ("power bond", "given (J)", "received (J)", "added by the coupling (J)", "at most (J)")
    yield table(head, rows, "Energy of the coupling until the end")


def _ranges(result: Result) -> Iterator[tuple[str, str, tuple[object, object, object]]]:
    """Least, largest and last value of each column of numbers."""
    for name in result.names:
        values = result[name]
        known = values[~np.isnan(values)]
        least, largest = (float(known.min()), float(known.max())) if len(known) else ("none", "none")
        yield name, result.unit(name), (least, largest, float(values[-1]) if len(values) else "none")


def system_section(results: Mapping[str, Result]) -> Section:
    """The components of each run in the order of stepping, with connections and delays; equal systems once."""
    origins = {label: origin_of(result) for label, result in results.items()}
    drawn: list[tuple[list[str], Markup]] = []
    for label, origin in origins.items():
        html = paragraph(UNKNOWN) if origin is None else _system(origin)
        same = next((labels for labels, other in drawn if other == html), None)
        if same is None:
            drawn.append(([label], html))
        else:
            same.append(label)
    parts = [for_run(", ".join(labels), html, len(drawn)) for labels, html in drawn]
    return Section("system", "The system", Markup().join(parts))


def _system(origin: Origin) -> Markup:
    said = (
        f"{origin.system}: {len(origin.components)} components, stepped from top to bottom by {origin.algorithm}"
        f"{'' if origin.step is None else f' with a step of {origin.step:g} s'}."
        " A dashed arrow carries the value of the step before."
    )
    return paragraph(said) + diagram(origin)


def origin_section(results: Mapping[str, Result], told: Mapping[str, Told]) -> Section:
    """The command that makes each run again, with hashes, seeds, start values and versions."""
    parts = [
        for_run(label, Markup().join(_origin_of_run(result, told[label])), len(results))
        for label, result in results.items()
    ]
    return Section("origin", "Where the numbers come from", Markup().join(parts))


def _origin_of_run(result: Result, told: Told) -> Iterator[Markup]:
    if told.again:
        yield Markup("<p>This command makes the run again, and says the hash:</p><pre>{}</pre>").format(told.again)
    yield Markup("<p>SHA-256 of the rows: <code>{}</code></p>").format(told.hash or row_hash(result))
    origin = origin_of(result)
    yield from [paragraph(UNKNOWN)] if origin is None else _origin(origin)


def _origin(origin: Origin) -> list[Markup]:
    fmus = [(c["name"], c["file"], Markup("<code>{}</code>").format(c["sha256"])) for c in origin.components]
    start = [
        (f"{component}.{name}", "unknown" if value is None else value)
        for component, values in origin.start.items()
        for name, value in values.items()
    ]
    seeds = ", ".join(f"{name} = {value}" for name, value in origin.seeds.items()) or "none"
    versions = ", ".join(f"{name} {version}" for name, version in origin.versions.items())
    return [
        table(("component", "FMU", "SHA-256"), fmus),
        paragraph(f"Seeds: {seeds}."),
        paragraph(f"Versions: {versions}."),
        Markup("<details><summary>{} start values</summary>{}</details>").format(
            len(start), table(("variable", "value"), start)
        ),
    ]
