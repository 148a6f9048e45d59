"""Builds SSP packages as other tools write them, and FMUs whose variables have other units."""

import re
import zipfile
from pathlib import Path

from adaptimp_fmu import ContinuousModel, SampledModel, build
from tests.unit.orchestration.small_models import H

_HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
 xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
 xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
 xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" version="1.0" name="theirs">"""
_UNITS = """<ssd:Units>
<ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit>
<ssc:Unit name="fine"><ssc:BaseUnit m="1" factor="0.0009765625"/></ssc:Unit>
<ssc:Unit name="s"><ssc:BaseUnit s="1"/></ssc:Unit>
<ssc:Unit name="K"><ssc:BaseUnit K="1"/></ssc:Unit>
<ssc:Unit name="degC"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit>
<ssc:Unit name="half"><ssc:BaseUnit m="1" factor="0.5"/></ssc:Unit>
</ssd:Units>"""


def foreign(path: Path, system: str, fmus: dict[str, Path], others: dict[str, str] | None = None) -> Path:
    """A package with this outermost system; FMUs under ``resources/`` by model identifier."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", f"{_HEAD}{system}{_UNITS}</ssd:SystemStructureDescription>")
        for name, fmu in fmus.items():
            archive.write(fmu, f"resources/{name}.fmu")
        for name, text in (others or {}).items():
            archive.writestr(name, text)
    return path


def system_xml(name: str, elements: str, connections: str = "", connectors: str = "", bindings: str = "") -> str:
    """A system from the texts of its parts."""
    parts = {"Connectors": connectors, "ParameterBindings": bindings, "Elements": elements, "Connections": connections}
    inner = "".join(f"<ssd:{tag}>{text}</ssd:{tag}>" for tag, text in parts.items() if text)
    return f'<ssd:System name="{name}">{inner}</ssd:System>'


def component(name: str, model: str, bindings: str = "", connectors: str = "") -> str:
    """A component from the name of its FMU."""
    inner = f"<ssd:Connectors>{connectors}</ssd:Connectors>" if connectors else ""
    inner += f"<ssd:ParameterBindings>{bindings}</ssd:ParameterBindings>" if bindings else ""
    return f'<ssd:Component name="{name}" source="resources/{model}.fmu">{inner}</ssd:Component>'


def _unit(name: str) -> str:
    return f' unit="{name}"' if name else ""


def connector(name: str, kind: str, unit: str = "") -> str:
    """A Real connector."""
    return f'<ssd:Connector name="{name}" kind="{kind}"><ssc:Real{_unit(unit)}/></ssd:Connector>'


def connection(start: str, end: str, inner: str = "", attributes: str = "") -> str:
    """A connection from ``element.connector`` to another; without an element to the system's own."""
    texts = []
    for side, path in (("start", start), ("end", end)):
        element, dot, name = path.rpartition(".")
        texts.append((f'{side}Element="{element}" ' if dot else "") + f'{side}Connector="{name}"')
    return f"<ssd:Connection {' '.join(texts)} {attributes}>{inner}</ssd:Connection>"


def scaled(factor: float, offset: float = 0.0) -> str:
    """A linear transformation."""
    return f'<ssc:LinearTransformation factor="{factor!r}" offset="{offset!r}"/>'


def binding(values: str, mapping: str = "", attributes: str = "") -> str:
    """Parameters inline, and a mapping."""
    text = f'<ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>{values}</ssv:Parameters></ssv:ParameterSet>'
    if mapping:
        mapping = f'<ssm:ParameterMapping version="1.0">{mapping}</ssm:ParameterMapping>'
        mapping = f"<ssd:ParameterMapping>{mapping}</ssd:ParameterMapping>"
    values = f"<ssd:ParameterValues>{text}</ssd:ParameterValues>"
    return f"<ssd:ParameterBinding {attributes}>{values}{mapping}</ssd:ParameterBinding>"


def real(name: str, value: float, unit: str = "") -> str:
    """A Real parameter."""
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value!r}"{_unit(unit)}/></ssv:Parameter>'


def entry(source: str, target: str, inner: str = "", attributes: str = "") -> str:
    """An entry of a mapping."""
    return f'<ssm:MappingEntry source="{source}" target="{target}" {attributes}>{inner}</ssm:MappingEntry>'


def decay(name: str) -> ContinuousModel:
    """A decaying state with direct feedthrough: dz/dt = u - z, y = z + u / 4."""
    model = ContinuousModel(name, "Follows its input", dt_max=H / 8)
    u = model.input("u", 0.0, unit="m", description="A length")
    z = model.state("z", model.parameter("z_start", 8.0, unit="m", description="First z"))
    model.derivative(z, u - z)
    model.output("y", z + u / 4, unit="m", description="z and some u", scalar=True)
    return model


def controller(name: str, position: str, gain: str, torque: str) -> SampledModel:
    """Torque = 2 position + gain, with two elements, under any names."""
    model = SampledModel(name, "Scales its position", sample_time=H)
    x = model.input(position, [0.0, 0.0], unit="m", description="Where the arm is")
    offset = model.parameter(gain, 1.0, unit="m", description="Offset of the torque")
    model.output(torque, 2 * x + offset, unit="m", description="What to do")
    return model


def finer(fmu: Path) -> Path:
    """A copy whose lengths are in units of 2**-10 m, so that conversions are exact; the equations stay."""
    copy = fmu.with_name(f"Fine{fmu.name}")
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(copy, "w") as new:
        for entry in old.namelist():
            content = old.read(entry)
            if entry == "modelDescription.xml":
                text = re.sub(r'(<BaseUnit m="1")', r'\1 factor="0.0009765625"', content.decode())
                content = (
                    text.replace('unit="m"', 'unit="fine"').replace('<Unit name="m"', '<Unit name="fine"').encode()
                )
                assert content.count(b"fine") > 2
                assert b"0.0009765625" in content
            new.writestr(entry, content)
    return copy


def build_foreign(folder: Path) -> dict[str, Path]:
    """Build small models; FMU files by name, ``Fine`` before the name means a finer unit of length."""
    models = [
        decay("Decay"),
        controller("Ours", "x", "offset", "tau_cmd"),
        controller("Stranger", "Position", "Gain", "Torque"),
    ]
    fmus = {model.name: build(model, folder) for model in models}
    return {**fmus, **{f"Fine{name}": finer(fmu) for name, fmu in fmus.items()}}
