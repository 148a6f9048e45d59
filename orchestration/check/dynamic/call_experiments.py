"""Experiments on rules 9 to 12: calls that an FMU must refuse, each made in an instance of its own."""

import ctypes as ct
import math
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from orchestration.check.dynamic.bitwise_runs import Yield
from orchestration.check.dynamic.instance import Binary, Instance
from orchestration.check.findings import Finding, shown, warning
from orchestration.errors import InitializationError
from orchestration.fmi.codes import accepted, status_name
from orchestration.fmi.instance import c_references
from orchestration.fmi.logging import Messages


def guid(binary: Binary) -> Yield:
    """Try rule 9: the FMU refuses a GUID that is not its own."""
    with suppress(InitializationError):
        binary.create(Messages(), guid="{00000000-0000-0000-0000-000000000000}").close()
        yield warning("9", "fmi2Instantiate accepts a wrong GUID: a binary of another version is not noticed.")


def unknown_reference(binary: Binary) -> Yield:
    """Try rule 10: fmi2GetReal refuses an unknown value reference."""
    taken = {row["reference"] for row in binary.plan["variables"]}
    reference = next(n for n in range(2**32 - 2, 0, -1) if n not in taken)
    with Instance(binary) as instance:
        instance.initialize()
        status = instance.status("fmi2GetReal", c_references([reference]), 1, ct.byref(ct.c_double()))
        yield from _accepted(status, "10", f"fmi2GetReal of the unknown value reference {reference}")


def backward_step(binary: Binary) -> Yield:
    """Try rule 11: a step of negative length is refused."""
    yield from _bad_step(binary, -binary.plan["step"])


def step_without_length(binary: Binary) -> Yield:
    """Try rule 11: a step whose length is NaN is refused."""
    yield from _bad_step(binary, math.nan)


def set_output(binary: Binary) -> Yield:
    """Try rule 12: an output cannot be set."""
    yield from _bad_set(binary, "output", "")


def set_fixed_parameter(binary: Binary) -> Yield:
    """Try rule 12: a fixed parameter cannot be set after initialization."""
    yield from _bad_set(binary, "parameter", "fixed")


def input_not_a_number(binary: Binary) -> Yield:
    """Try rule 11: the FMU survives NaN as an input; it may refuse NaN or pass it on."""
    for name in binary.names("input", "Real")[: 1 if binary.plan["once"] else 8]:
        with Instance(binary) as instance:
            instance.initialize()
            row = binary.variables[name]
            value = ct.byref(ct.c_double(math.nan))
            if accepted(instance.status("fmi2SetReal", c_references([row["reference"]]), 1, value)):
                instance.status("fmi2DoStep", instance.time, binary.plan["step"], 1)
    yield from ()


def _accepted(status: int, rule: str, what: str) -> Iterator[Finding]:
    """Yield a finding if a bad call was accepted."""
    if accepted(status):
        yield warning(rule, f"{what} returns {status_name(status)}; an error is due.")


def _bad_step(binary: Binary, h: float) -> Yield:
    with Instance(binary) as instance:
        instance.initialize()
        yield from _accepted(instance.status("fmi2DoStep", instance.time, h, 1), "11", f"fmi2DoStep with h = {h:g} s")


def _bad_set(binary: Binary, causality: str, variability: str) -> Yield:
    """Set a Real variable to its present value after initialization, which the FMU must refuse."""
    rows: list[Any] = [binary.variables[name] for name in binary.names(causality, "Real")]
    rows = [row for row in rows if not variability or row["variability"] == variability]
    if not rows:
        return
    with Instance(binary) as instance:
        instance.initialize()
        value = ct.c_double(instance.get([rows[0]["name"]])[0])
        status = instance.status("fmi2SetReal", c_references([rows[0]["reference"]]), 1, ct.byref(value))
        kind = f"{variability} {causality}".strip()
        yield from _accepted(status, "12", f"fmi2SetReal of the {kind} {shown(rows[0]['name'])} after initialization")
