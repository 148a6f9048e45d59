"""Tables of each FMU's start values in the paper's runs, which the FMU carries as its parameter sets.

Runs that give an FMU the same values share a column, whose head names them all.
"""

from collections.abc import Mapping
from pathlib import Path

from adaptimp_fmu import SampledModel
from adaptimp_fmu.files.whole_file import write_whole
from fmus.catalog import MODELS
from orchestration.paper.scenarios import SCENARIOS, VARIANTS, Scenario

Values = Mapping[str, float]


def write_parameter_sets(name: str, folder: Path) -> None:
    """Write ``folder/NAME/NAME_sets.csv`` for a model identifier; nothing if no run has such an FMU.

    The first column holds the parameters in their order in the FMU, each other column the values of some runs. A field
    is empty where the runs leave a parameter at its start value.
    """
    sets = _sets(name)
    if not sets:
        return
    given = {parameter for values in sets.values() for parameter in values}
    parameters = [variable.name for variable in MODELS[name]().ordered_variables() if variable.name in given]
    lines = ['"parameter",' + ",".join(f'"{" ".join(runs)}"' for runs in sets)]
    for parameter in parameters:
        fields = (_text(values[parameter]) if parameter in values else "" for values in sets.values())
        lines.append(f'"{parameter}",' + ",".join(fields))
    (folder / name).mkdir(parents=True, exist_ok=True)
    write_whole(folder / name / f"{name}_sets.csv", "".join(f"{line}\n" for line in lines).encode())


def _sets(name: str) -> Mapping[tuple[str, ...], Values]:
    """Different sets of values, by the names of the runs that have them, in the order of the runs."""
    runs: dict[tuple[tuple[str, float], ...], list[str]] = {}
    for scenario in (*SCENARIOS.values(), *VARIANTS.values()):
        for component, identifier in scenario.models.items():
            if identifier == name:
                runs.setdefault(tuple(sorted(_values(scenario, component).items())), []).append(scenario.name)
    return {tuple(names): dict(values) for values, names in runs.items()}


def _values(scenario: Scenario, component: str) -> Values:
    """Start values of a component in a run; its sampling period is the run's step."""
    given = {}
    for path, value in scenario.values.items():
        owner, _, parameter = path.partition(".")
        if owner == component:
            given[parameter] = value.number
    model = MODELS[scenario.models[component]]()
    return {**given, model.period_name: scenario.step} if isinstance(model, SampledModel) else given


def _text(value: float) -> str:
    """A number with as few digits as tell it from all others."""
    return repr(float(value)).removesuffix(".0")
