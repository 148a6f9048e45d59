"""Short runs of an FMU whose outputs the experiments of a check compare bit by bit."""

import math
import random
from collections.abc import Iterator, Sequence

from orchestration.check.dynamic.instance import Binary, Instance, RefusedError, bits, not_finite
from orchestration.check.findings import Finding, error, listed, shown

STEPS = 12  # of a comparison
Rows = list[tuple[float, ...]]
Yield = Iterator[Finding | str]  # what an experiment yields: findings, and sentences about what it measured


def moves(binary: Binary) -> bool:
    """Whether the FMU accepts inputs that differ a little from their start values; found out once."""
    if "moves" not in binary.plan:
        if binary.plan["once"]:  # there is no instance to find it out; the experiment that does so has failed
            return False
        find_out_whether_it_moves(binary)
    return binary.plan["moves"]


def find_out_whether_it_moves(binary: Binary) -> None:
    """Try inputs that differ a little from their start values in a fresh instance, and keep what came of it."""
    try:
        rows = trace(binary, moved=True)
    except RefusedError:
        binary.plan["moves"] = False
    else:
        binary.plan["moves"] = True
        keep(binary, rows)


def trace(binary: Binary, moved: bool, seed: int = 1) -> Rows:
    """Return the outputs of a fresh instance over some steps."""
    with Instance(binary) as instance:
        instance.initialize()
        return run(instance, moved, seed, first=True)


def fresh_rows(binary: Binary, moved: bool) -> Rows:
    """Return the outputs of a fresh instance: those that were kept, or else those of a new instance."""
    if "rows" in binary.plan:
        return [tuple(row) for row in binary.plan["rows"]]
    rows = trace(binary, moved)
    keep(binary, rows)
    return rows


def keep(binary: Binary, rows: Rows) -> None:
    """Keep the outputs of a fresh instance for later processes, where each of them can make one instance only."""
    if binary.plan["once"]:
        binary.plan["rows"] = rows


def run(instance: Instance, moved: bool, seed: int = 1, *, first: bool = False) -> Rows:
    """Return the outputs of an instance before the first step and after each step."""
    generator = random.Random(seed)
    rows = [instance.outputs()] if first else []
    for _ in range(STEPS):
        move(instance, generator, moved=moved)
        instance.step()
        rows.append(instance.outputs())
    return rows


def move(instance: Instance, generator: random.Random, *, moved: bool) -> None:
    """Set the inputs to values that differ by about 1 % and 0.01 from their start values, within their limits."""
    values = {}
    for name, start in instance.binary.starts().items():
        row = instance.binary.variables[name]
        if row["stands_for"] == "Boolean":
            values[name] = float(generator.random() < 0.5) if moved else start
        elif row["stands_for"] == "Real" and moved:
            value = start * (1 + 0.01 * generator.uniform(-1, 1)) + 0.01 * generator.uniform(-1, 1)
            low, high = row["limits"]
            values[name] = max(-math.inf if low is None else low, min(math.inf if high is None else high, value))
        else:
            values[name] = start
    instance.set(values)


def infinite(binary: Binary, values: Sequence[float], when: str) -> Iterator[Finding]:
    """Yield a finding that names the outputs that are NaN or infinite, if there are any."""
    wrong = not_finite(binary.names("output"), values)
    if wrong:
        yield error("11", f"Outputs are not finite {when}: {listed(wrong)}.")


def same(binary: Binary, expected: Rows, found: Rows, rule: str, when: str, otherwise: str) -> Iterator[Finding]:
    """Yield a finding that names the first output that differs in a bit, if there is one."""
    for k, (row, other) in enumerate(zip(expected, found, strict=True)):
        for name, a, b in zip(binary.names("output"), row, other, strict=True):
            if bits([a]) != bits([b]):
                yield error(rule, f"{when}, {shown(name)} is {b:.17g} in row {k}; {otherwise} it is {a:.17g}.")
                return
