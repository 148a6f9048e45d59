"""The job of a check's child process: it runs experiments with a binary and writes down what each one finds."""

from collections.abc import Mapping
from typing import Any

from orchestration.check.dynamic.experiments import BASE, experiment
from orchestration.check.dynamic.instance import Binary, MissingError, RefusedError
from orchestration.check.findings import Finding, Severity
from orchestration.sandbox.worker import Announce, Write

KNOWN = ("random", "moves", "step", "rows")


def run_experiments(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:
    """Run the experiments that the plan lists, in its order.

    The lines that it writes tell which experiment begins and ends, what the experiment found or measured, and what
    later experiments need to know. If an experiment of `BASE` fails, it is the last one.
    """
    facts = {**plan, "told": list(plan["told"])}

    def tell(found: Finding) -> None:
        write(**_line(found), known={"told": facts["told"]})

    try:
        binary = Binary(facts, announce, tell)
    except OSError as failed:
        write(begin="loading")
        write(refused=f"the library cannot be loaded: {failed}.")
        return
    for name in plan["experiments"]:
        write(begin=name)
        failed = False
        try:
            for found in experiment(name)(binary):
                failed |= isinstance(found, Finding) and found.severity == Severity.ERROR
                write(**_line(found))
        except (RefusedError, MemoryError, OverflowError) as refused:
            failed = True
            write(refused=str(refused) or "the memory does not suffice.")
        except MissingError as missing:
            failed = True
            write(missing=str(missing))
        if failed and name in BASE:
            return
        write(known={key: binary.plan[key] for key in KNOWN if key in binary.plan}, end=name)


def _line(found: Finding | str) -> dict[str, Any]:
    return {"fact": found} if isinstance(found, str) else {"finding": [found.rule, found.severity, found.message]}
