"""Algebraic loops among connections, and connections whose value is old when it is used."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from orchestration.analysis.doctor.case import Case, Spelling
from orchestration.analysis.doctor.finding import Finding, Severity, counted, listed
from orchestration.fmi.codes import SAVES_STATE
from orchestration.fmi.document import OUTPUTS, Document, parsed, read_bytes
from orchestration.master.algorithm import ALGORITHMS, PARALLEL
from orchestration.system.system import Component, Connection, System

DELAYS = "delays"
"""The kind of the finding on connections whose values arrive late, or too early."""

MOST_ORDERED = 7  # most components for which all orders are tried


def loop_findings(case: Case, spell: Spelling) -> Iterator[Finding]:
    """Findings on algebraic loops: cycles of connections through outputs that follow inputs at once."""
    solved = case.algorithm.correction is not None
    for loop in algebraic_loops(case.system):
        through = [f"{c.source}.{c.output}" for c in loop]
        if solved:
            consequence = f"{case.algorithm.name} solves it in each step"
        else:
            consequence = f"{case.algorithm.name} does not solve it, so one of these signals is a step late"
        yield Finding(
            "algebraic-loop",
            Severity.NOTE if solved else Severity.WARNING,
            through[0],
            f"An algebraic loop goes through {listed(through, 6)}: each follows the one before at once, as far as the"
            f" FMUs declare; {consequence}.",
            {"signals": through},
            *(("", "") if solved else _solver(case, spell)),
        )


def _solver(case: Case, spell: Spelling) -> tuple[str, str]:
    """Advice on who solves a loop, with the command if all components can repeat a step."""
    unable = [c.name for c in case.system.components if c.continuous and not c.description.can(SAVES_STATE)]
    if unable:
        return f"newton and iterative would solve it, but {listed(unable)} cannot repeat a step ({SAVES_STATE}).", ""
    return "Let newton or iterative solve it.", spell(case.but(algorithm=ALGORITHMS["newton"]))


def algebraic_loops(system: System) -> list[list[Connection]]:
    """Groups of connections that depend on each other at the same instant, each in the order of the system.

    Only continuous components count: a sampled component holds its outputs from one tick to the next. Which inputs an
    output follows at once is what the FMU declares; an output that declares nothing follows all inputs.
    """
    feeding: dict[str, list[int]] = {}
    for i, c in enumerate(system.connections):
        feeding.setdefault(c.source, []).append(i)
    followers = [
        [j for j in feeding.get(c.target, ()) if _follows(system, c, system.connections[j])] for c in system.connections
    ]
    groups = [group for group in _strong_groups(followers) if len(group) > 1 or group[0] in followers[group[0]]]
    return [[system.connections[i] for i in sorted(group)] for group in groups]


def _follows(system: System, into: Connection, out: Connection) -> bool:
    """Whether the output of one connection follows the input of another at once."""
    component = system.component(into.target)
    if not component.continuous:
        return False
    output, input_ = component.variable(out.output), component.variable(into.input)
    known = dependencies(component.description.path).get(output.fmu_name)
    return output.direct if known is None else input_.fmu_name in known


@cache
def dependencies(path: Path) -> Mapping[str, frozenset[str] | None]:
    """Names of the variables that each output of an FMU declares to follow; None for one that declares nothing."""
    document = Document(parsed(read_bytes(path)))
    names = {variable.index: variable.name for variable in document.variables}
    return {
        names[row.index]: None if row.dependencies is None else frozenset(names[i] for i in row.dependencies)
        for row in document.unknowns(OUTPUTS)
    }


def _strong_groups(followers: Sequence[Sequence[int]]) -> list[list[int]]:
    """Strongly connected groups of a graph (R. Tarjan, 1972), without recursion."""
    number: dict[int, int] = {}
    low: dict[int, int] = {}
    kept: list[int] = []
    on_path: set[int] = set()
    groups: list[list[int]] = []
    for root in range(len(followers)):
        if root in number:
            continue
        work = [(root, iter(followers[root]))]
        _enter(root, number, low, kept, on_path)
        while work:
            node, rest = work[-1]
            step = next((j for j in rest if j not in number or j in on_path), None)
            if step is None:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == number[node]:
                    groups.append(_leave(node, kept, on_path))
            elif step in number:
                low[node] = min(low[node], number[step])
            else:
                _enter(step, number, low, kept, on_path)
                work.append((step, iter(followers[step])))
    return groups


def _enter(node: int, number: dict[int, int], low: dict[int, int], kept: list[int], on_path: set[int]) -> None:
    number[node] = low[node] = len(number)
    kept.append(node)
    on_path.add(node)


def _leave(node: int, kept: list[int], on_path: set[int]) -> list[int]:
    """Take the group of a node, which is complete, from the stack."""
    place = kept.index(node)
    group = kept[place:]
    del kept[place:]
    on_path.difference_update(group)
    return group


@dataclass(frozen=True)
class Delays:
    """Connections whose value is not that of the instant at which it is used.

    Attributes
    ----------
    late
        Connections from sampled components that are used a tick late.
    early
        Connections into sampled components that show the end of the step which begins with the tick.
    held
        Connections between continuous components that hold the value of the start of a step.
    """

    late: tuple[Connection, ...]
    early: tuple[Connection, ...]
    held: tuple[Connection, ...]

    @property
    def weight(self) -> tuple[int, int]:
        """Numbers by which orders are compared: wrong by a step, and held."""
        return len(self.late) + len(self.early), len(self.held)


def delays(case: Case, names: Sequence[str] | None = None) -> Delays:
    """Find the delays of an algorithm and an order of the components; by default that of the system."""
    place = {name: i for i, name in enumerate(case.system if names is None else names)}
    parallel = case.algorithm.exchange == PARALLEL
    late, early, held = [], [], []
    components = {component.name: component for component in case.system.components}
    for c in case.system.connections:
        source, target = components[c.source], components[c.target]
        newest = not parallel and place[c.source] < place[c.target]
        if _steady(source):
            if not newest:
                late.append(c)
        elif _steady(target):
            if newest:
                early.append(c)
        elif not newest and case.algorithm.correction is None and case.algorithm.order == 0:
            held.append(c)
    return Delays(tuple(late), tuple(early), tuple(held))


def _steady(component: Component) -> bool:
    """Whether a component holds its outputs from one tick to the next."""
    return not component.continuous


def delay_findings(case: Case, spell: Spelling) -> Iterator[Finding]:
    """Findings on delays, and on an order of the components that has fewer."""
    found = delays(case)
    better = None if case.algorithm.exchange == PARALLEL else _better_order(case, found)
    if not any(found.weight):
        return
    parts = [
        counted(len(connections), "signal", *words)
        for connections, words in (
            (found.late, _both("from sampled components", "arrives", "arrive", "a tick late")),
            (found.early, _both("", "reaches", "reach", "sampled components a step ahead of the tick")),
            (found.held, _both("between continuous components", "is", "are", "held from the start of each step")),
        )
        if connections
    ]
    first = (*found.late, *found.early, *found.held)
    figures = {
        "late": [str(c) for c in found.late],
        "early": [str(c) for c in found.early],
        "held": [str(c) for c in found.held],
    }
    advice, command = "", ""
    if better is not None:
        advice = f"Step the components in the order {', '.join(better)}."
        command = spell(case.but(order=tuple(better)))
    elif case.algorithm.exchange == PARALLEL and found.late:
        advice = "gauss-seidel hands new values on within a step."
        command = spell(case.but(algorithm=ALGORITHMS["gauss-seidel"]))
    yield Finding(
        DELAYS,
        Severity.WARNING if better is not None and found.weight[0] else Severity.NOTE,
        f"{first[0].source}.{first[0].output}",
        f"With {case.algorithm.name} in this order, {' and '.join(parts)}: {listed([str(c) for c in first])}.",
        figures,
        advice,
        command,
    )


def _both(between: str, verb: str, verbs: str, what: str) -> tuple[str, str]:
    """What one signal does, and what several signals do."""
    return " ".join(filter(None, (between, verb, what))), " ".join(filter(None, (between, verbs, what)))


def _better_order(case: Case, found: Delays) -> list[str] | None:
    """The order nearest to the given one with the fewest wrong values; None if the given order is as good."""
    names = list(case.system)
    if len(names) > MOST_ORDERED or not found.weight[0]:
        return None
    best = min(itertools.permutations(names), key=lambda order: delays(case, order).weight)
    return list(best) if delays(case, best).weight[0] < found.weight[0] else None
