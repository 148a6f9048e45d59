"""Everything that the live page computes with: modules, scenarios, settings, claims, as one object for JSON."""

import json
import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.containers.wasm.module import DESCRIPTION, write_wasm
from orchestration.errors import OrchestrationError
from orchestration.master.simulate import simulate
from orchestration.paper.page.live_claims import live_claims
from orchestration.paper.page.live_settings import FIGURES, live_settings
from orchestration.paper.page.live_starts import HOMES, Program, starts
from orchestration.paper.ready import scenario
from orchestration.paper.studies.fixed_values import FIXED
from orchestration.results.result import Result
from orchestration.results.row_hash import row_hash
from orchestration.system.system import System

_BINDING = re.compile(r'<ssd:ParameterBinding type="[^"]*" source="resources/(\w+)\.ssv"/>')
_NAME, _STEP = re.compile(r'(?<= name=)"loop"'), re.compile(r'(?<=<step size=)"[^"]*"')
_KEPT = ("name", "index", "role", "type", "unit", "start")


def live_data(programs: Mapping[str, Program], hashes: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Collect what the page computes with, besides the modules.

    Parameters
    ----------
    programs
        By the model identifier of the controller.
    hashes
        SHA-256 of the rows of each scenario, from runs of the master. Default: they are run here.
    """
    variables = [v for program in programs.values() for v in program.record["description"]["variables"]]
    return {
        "figures": {name: _figure(name, hashes) for name in FIGURES},
        "units": {v["name"]: v["unit"] for v in variables if v["role"] == "output"},
        "starts": starts(programs),
        "controllers": {identifier: program.record for identifier, program in programs.items()},
        "settings": [setting.record() for setting in live_settings()],
        "fixed": [{"name": one.name, "value": one.value, "reason": one.reason} for one in FIXED],
        **live_claims({v["name"] for v in variables if v["role"] == "output"}),
    }


def native_hashes(results: Mapping[str, Result]) -> dict[str, str]:
    """SHA-256 of the rows of the scenarios; those that are not among the given results are run."""
    return {name: row_hash(results[name] if name in results else simulate(scenario(name))) for name in FIGURES}


def plain_script(module: str) -> str:
    """A module as a script: its imports left out, its exports plain declarations."""
    without = re.sub(r"^import [^;]*;\n", "", module, flags=re.MULTILINE)
    return re.sub(r"^export (?=const|function|class|async)", "", without, flags=re.MULTILINE)


def _figure(name: str, hashes: Mapping[str, str] | None) -> dict[str, Any]:
    """A scenario: its controller, its times and its start values."""
    found = FIGURES[name]
    return {
        "caption": found.caption,
        "controller": found.models["controller"],
        "step": found.step,
        "stop": found.stop_time,
        "hash": hashes[name] if hashes is not None else row_hash(simulate(scenario(name))),
    }


def programs() -> dict[str, Program]:
    """The paper's loop with each controller, by model identifier.

    A module that the wheel does not carry is taken from the cache, or compiled, which needs the part ``build``.
    """
    return {identifier: _program(identifier) for identifier in HOMES}


def _program(identifier: str) -> Program:
    home, label = HOMES[identifier]
    system = replace(scenario(home), name="loop")
    bare = _without_numbers(system)
    with temporary_folder() as folder:
        path = write_wasm(bare, folder / "loop.wasm", variable_step=True, known=_carried)
        described = json.loads(path.with_suffix(DESCRIPTION).read_text(encoding="utf-8"))
        module = path.read_bytes()
        package = system.write(folder / "loop.ssp")
        structure = zipfile.ZipFile(package).read("SystemStructure.ssd").decode()
    kept = {key: described[key] for key in ("abi", "name", "identity", "step", "startTime")}
    kept["variables"] = [{key: v[key] for key in _KEPT} for v in described["variables"]]
    structure = _structure(structure, described["variables"])
    return Program(module, {"label": label, "description": kept, "structure": structure})


def _carried(identity: str) -> bytes | None:
    """The module of an identity that the wheel carries."""
    from fmus.carried import ChangedFileError, carried_module

    try:
        return carried_module(identity)
    except ChangedFileError as error:
        raise OrchestrationError(str(error)) from error


def _structure(structure: str, variables: Sequence[Mapping[str, Any]]) -> str:
    """An .ssd file with ``@name@`` in the place of the system's name, the step, and the value of each parameter."""

    def inline(binding: re.Match[str]) -> str:
        prefix = f"{binding[1]}."
        values = "".join(
            f'<ssv:Parameter name="{v["name"].removeprefix(prefix)}">'
            f'<ssv:{v["type"]} value="@{v["name"]}@"/></ssv:Parameter>'
            for v in variables
            if v["role"] == "parameter" and v["name"].startswith(prefix)
        )
        parameters = f"<ssv:Parameters>{values}</ssv:Parameters>"
        holder = f'<ssv:ParameterSet version="1.0" name="parameters">{parameters}</ssv:ParameterSet>'
        values = f"<ssd:ParameterValues>{holder}</ssd:ParameterValues>"
        return f"<ssd:ParameterBinding>{values}</ssd:ParameterBinding>"

    return _STEP.sub('"@step@"', _NAME.sub('"@figure@"', _BINDING.sub(inline, structure)))


def _without_numbers(system: System) -> System:
    """The system with the start values of its FMUs, so that a module does not depend on a calibration."""
    bare = replace(system, assumptions={}, components=tuple(replace(c, start={}) for c in system.components))
    return bare.with_sample_time(system.run_step())
