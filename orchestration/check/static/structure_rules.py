"""Checks rule 4: ModelStructure lists every output and initial unknown, and the variables that they depend on."""

from collections.abc import Iterator

from orchestration.check.findings import Finding, error, listed, shown, warning
from orchestration.check.static.archive_rules import Package
from orchestration.fmi.document import APPROX, CALCULATED, DERIVATIVES, INITIAL_UNKNOWNS, OUTPUTS, Document

_COMPUTED = (APPROX, CALCULATED)


def indices_exist(package: Package) -> Iterator[Finding]:
    """Check rule 4: every index of an unknown, a dependency or a state belongs to a variable."""
    document = package.document
    n = len(document.variables)
    for listing in (OUTPUTS, DERIVATIVES, INITIAL_UNKNOWNS):
        for row in document.unknowns(listing):
            wrong = [i for i in (row.index, *(row.dependencies or ())) if not 1 <= i <= n]
            if wrong:
                yield error("4", f"{listing}: the index {wrong[0]} is not that of a variable; there are {n}.")
    for variable in document.variables:
        if variable.derivative is not None and not 1 <= variable.derivative <= n:
            name = shown(variable.name)
            yield error("4", f"{name}: derivative {variable.derivative} is not the index of a variable.")


def outputs_are_complete(package: Package) -> Iterator[Finding]:
    """Check rule 4: the element Outputs lists every output, and nothing else."""
    yield from _compare(package.document, OUTPUTS, {v.index for v in package.document.of_causality("output")})


def initial_unknowns_are_complete(package: Package) -> Iterator[Finding]:
    """Check rule 4: InitialUnknowns lists the variables that initialization computes, in ascending order."""
    document = package.document
    expected = {v.index for v in document.of_causality("output") if v.initial in _COMPUTED}
    expected |= {v.index for v in document.of_causality("calculatedParameter")}
    for row in document.unknowns(DERIVATIVES):
        places = [i for i in (row.index, _state(document, row.index)) if 1 <= i <= len(document.variables)]
        expected |= {i for i in places if document.variables[i - 1].initial in _COMPUTED}
    yield from _compare(document, INITIAL_UNKNOWNS, expected)
    indices = [row.index for row in document.unknowns(INITIAL_UNKNOWNS)]
    if indices != sorted(indices):
        yield warning("4", f"{INITIAL_UNKNOWNS} is not in ascending order.")


def derivatives_name_their_states(package: Package) -> Iterator[Finding]:
    """Check rule 4: the element Derivatives lists only variables that have the attribute derivative."""
    document = package.document
    rows = [row.index for row in document.unknowns(DERIVATIVES) if 1 <= row.index <= len(document.variables)]
    stateless = [document.variables[i - 1].name for i in rows if document.variables[i - 1].derivative is None]
    if stateless:
        yield warning("4", f"{DERIVATIVES} lists {listed(stateless)}, which do not say whose derivative they are.")


def dependencies_are_declared(package: Package) -> Iterator[Finding]:
    """Check rule 4: each unknown has dependencies, in ascending order, with a kind for each or for none."""
    document = package.document
    silent = []
    for listing in (OUTPUTS, DERIVATIVES, INITIAL_UNKNOWNS):
        for row in document.unknowns(listing):
            name = _name(document, row.index)
            if row.kinds is not None and len(row.kinds) != len(row.dependencies or ()):
                counts = f"{len(row.kinds)} dependenciesKind for {len(row.dependencies or ())} dependencies"
                yield error("4", f"{listing}: {name} has {counts}.")
            if row.dependencies is not None and list(row.dependencies) != sorted(set(row.dependencies)):
                yield warning("4", f"{listing}: the dependencies of {name} are not in ascending order.")
            if row.dependencies is None and listing == OUTPUTS:
                silent.append(name)
    if silent and document.of_causality("input"):
        said = f"{OUTPUTS}: {listed(silent)} without dependencies"
        yield warning("4", f"{said}: importers assume that each depends on all inputs, and see algebraic loops.")


def _compare(document: Document, listing: str, expected: set[int]) -> Iterator[Finding]:
    """Compare the rows of a list with the variables that it should hold."""
    rows = [row.index for row in document.unknowns(listing)]
    missing, more = sorted(expected - set(rows)), sorted(set(rows) - expected)
    if missing:
        yield warning("4", f"{listing} lacks {listed([_name(document, i) for i in missing])}.")
    if more:
        yield warning("4", f"{listing} lists {listed([_name(document, i) for i in more])}, which do not belong there.")
    if len(set(rows)) != len(rows):
        yield warning("4", f"{listing} lists a variable more than once.")


def _state(document: Document, index: int) -> int:
    """Return the index of the state whose derivative a variable is; 0 if there is none."""
    if not 1 <= index <= len(document.variables):
        return 0
    return document.variables[index - 1].derivative or 0


def _name(document: Document, index: int) -> str:
    return shown(document.variables[index - 1].name) if 1 <= index <= len(document.variables) else f"variable {index}"
