"""The command that makes a recorded run again, from what the result tells of its origin."""

import shlex
from collections.abc import Iterator, Mapping

from orchestration.master.algorithm import find_algorithm
from orchestration.paper.scenarios import ALL_SCENARIOS, Scenario
from orchestration.report.origin import Origin, origin_of
from orchestration.results.result import Result

SAMPLE_TIME = "sample_time"
CONTROLLER = "controller"
CHANGED, INPUTS = "changes", "inputs"
"""Keys of the metadata of runs in which something came from outside."""


def command_again(result: Result) -> str:
    """The command, or a sentence why there is none; empty if the result does not tell its origin.

    A run of a scenario gets each option that differs from the scenario. Of another system the result does not know
    the file, so the command names the system in capitals.
    """
    origin = origin_of(result)
    if origin is None:
        return ""
    if CHANGED in result.metadata or INPUTS in result.metadata:
        return "None: values came from outside while it ran, which the file does not hold."
    if origin.algorithm_text != repr(find_algorithm(origin.algorithm)):
        return f"None: {origin.algorithm} had settings of its own: {origin.algorithm_text}"
    scenario = ALL_SCENARIOS.get(origin.system)
    words = ["adaptimp", "run"]
    if scenario is not None and _is_of(origin, scenario):
        words += [scenario.name, *_differing(origin, scenario)]
    else:
        words += ["SYSTEM", *_times(origin)]
    if origin.algorithm != "gauss-seidel":
        words += ["--algorithm", origin.algorithm]
    words.append("--hash")
    comment = "" if words[2] != "SYSTEM" else f"  # SYSTEM: the file of the system {origin.system}"
    return f"{shlex.join(words)}{comment}"


def _is_of(origin: Origin, scenario: Scenario) -> bool:
    """Whether a run has the scenario's components and their models; the controller may be another shipped one."""
    from fmus.catalog import MODELS, VARIANTS

    models = {component["name"]: component["identifier"] for component in origin.components}
    others = {name: model for name, model in scenario.models.items() if name != CONTROLLER}
    known = models.get(CONTROLLER, "") in (*MODELS, *VARIANTS)
    return known and models.keys() == scenario.models.keys() and others.items() <= models.items()


def _differing(origin: Origin, scenario: Scenario) -> Iterator[str]:
    models = {component["name"]: component["identifier"] for component in origin.components}
    if models[CONTROLLER] != scenario.models[CONTROLLER]:
        yield from ("--controller", models[CONTROLLER])
    for component, values in origin.start.items():
        for name, value in values.items():
            path = f"{component}.{name}"
            known = scenario.values.get(path)
            if name != SAMPLE_TIME and (known is None or known.number != value):
                yield from ("--set", f"{path}={value!r}" if isinstance(value, float) else f"{path}={value}")
    if origin.order != list(scenario.models):
        yield from ("--order", ",".join(origin.order))
    periods = _periods(origin)
    if origin.step is not None and origin.step != scenario.step:
        yield from ("--sample-time" if set(periods.values()) == {origin.step} else "--step", repr(origin.step))
    if origin.stop_time is not None and origin.stop_time != scenario.stop_time:
        yield from ("--stop", repr(origin.stop_time))


def _times(origin: Origin) -> Iterator[str]:
    for option, value in (("--step", origin.step), ("--stop", origin.stop_time)):
        if value is not None:
            yield from (option, repr(value))


def _periods(origin: Origin) -> Mapping[str, float | str | None]:
    return {name: values[SAMPLE_TIME] for name, values in origin.start.items() if SAMPLE_TIME in values}
