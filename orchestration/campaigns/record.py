"""What a store keeps of a study, so that the study can be continued: numbers and texts that JSON has.

Systems are kept beside it as SSP packages. Of a function the record has its name and the hash of its code, since a
store must not bring code of its own.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from orchestration.campaigns.design.design import Block, Design
from orchestration.campaigns.design.factor import Factor
from orchestration.campaigns.measuring.measure import Measure
from orchestration.campaigns.setting import Setting
from orchestration.errors import StudyError
from orchestration.fmi.isolation import Isolation
from orchestration.results.measures.parser import parse_formula
from orchestration.system.system import System


def study_record(setting: Setting, design: Design, *, compares: bool) -> dict[str, Any]:
    """What a store keeps of a study."""
    return {
        "compares": compares,
        "systems": [
            {"variant": variant, "name": system.name, "step": system.step, "stop_time": system.stop_time}
            for variant, system in setting.systems.items()
        ],
        "measures": [_measure_record(measure) for measure in setting.measures],
        "stop_time": setting.stop_time,
        "step": setting.step,
        "algorithm": setting.algorithm,
        "isolation": None if setting.isolation is None else asdict(setting.isolation),
        "blocks": [_block_record(block) for block in design.blocks],
    }


def recorded_setting(
    record: Mapping[str, Any], system: Callable[[str], System], functions: Mapping[str, Measure]
) -> tuple[Setting, Design]:
    """The setting and the design that a record describes.

    Parameters
    ----------
    system
        Reads a system of the study by the name of its variant.
    functions
        Measures that are functions, by their first name.

    Raises
    ------
    StudyError
        If a function is missing, or its code is another one than that of the record.
    """
    systems = {
        item["variant"]: replace(
            system(item["variant"]), name=item["name"], step=item["step"], stop_time=item["stop_time"]
        )
        for item in record["systems"]
    }
    isolation = record["isolation"]
    setting = Setting(
        systems,
        tuple(_recorded_measure(item, functions) for item in record["measures"]),
        record["stop_time"],
        record["step"],
        record["algorithm"],
        None if isolation is None else Isolation(**isolation),
    )
    blocks = tuple(
        Block(
            tuple(Factor(item["name"], item["variables"]) for item in block["factors"]),
            np.array(block["values"], dtype=np.float64).reshape(-1, len(block["factors"])),
            block["samples"],
        )
        for block in record["blocks"]
    )
    return setting, Design(tuple(systems), blocks)


def _measure_record(measure: Measure) -> dict[str, Any]:
    common = {"names": list(measure.names), "units": list(measure.units)}
    if measure.formula is not None:
        return {**common, "formula": str(measure.formula)}
    return {**common, "function": measure.identity, "columns": list(measure.columns)}


def _recorded_measure(record: Mapping[str, Any], functions: Mapping[str, Measure]) -> Measure:
    names, units = tuple(record["names"]), tuple(record["units"])
    if "formula" in record:
        return Measure(names, units, parse_formula(record["formula"]))
    given = functions.get(names[0])
    if given is None or given.function is None:
        msg = (
            f"The study has the function {names[0]} as a measure; give it again, as Study.resume(folder, measure=...)."
        )
        raise StudyError(msg)
    measure = Measure.of(given.function, names, units, record["columns"])
    if measure.identity != record["function"]:
        msg = f"The code of measure {measure.label} is not that of the study any more; begin a new study with it."
        raise StudyError(msg)
    return measure


def _block_record(block: Block) -> dict[str, Any]:
    factors: Sequence[Factor] = block.factors
    return {
        "factors": [{"name": factor.name, "variables": list(factor.variables)} for factor in factors],
        "samples": block.samples,
        "values": block.values.tolist(),
    }
