"""Makes FMUs with C sources as other tools export them: a small one in many spellings, and a controller for Fig. 5."""

import subprocess
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from adaptimp_fmu.toolchain import fmi_headers, host_platform
from tests.interop.foreign.builders import HERE, hand_written
from tests.strangers.contained.program import QUICKEST
from tests.strangers.fmus import HEAD

SOURCES = Path(__file__).with_name("sources")
_UNITS = '<UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit>'
_UNITS += '<Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>'
_UNITS += '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit><Unit name="K"><BaseUnit K="1"/></Unit>'
_UNITS += "</UnitDefinitions>"
_MODES = '<TypeDefinitions><SimpleType name="Mode"><Enumeration><Item name="slow" value="1"/>'
_MODES += '<Item name="fast" value="2"/></Enumeration></SimpleType></TypeDefinitions>'
# name, type, value reference, causality, variability, start, initial
VARIABLES: Sequence[tuple[str, str, int, str, str, str, str]] = (
    ("u", "Real", 0, "input", "continuous", "0.25", ""),
    ("y", "Real", 1, "output", "continuous", "", ""),
    ("k", "Real", 2, "parameter", "fixed", "2", ""),
    ("b", "Real", 3, "parameter", "tunable", "0.5", ""),
    ("x", "Real", 4, "local", "continuous", "1", "exact"),
    ("m", "Integer", 0, "input", "discrete", "1", ""),
    ("count", "Integer", 1, "output", "discrete", "", ""),
    ("mode", "Enumeration", 2, "parameter", "fixed", "2", ""),
    ("fault", "Integer", 3, "parameter", "fixed", "0", ""),
    ("on", "Boolean", 0, "input", "discrete", "false", ""),
    ("odd", "Boolean", 1, "output", "discrete", "", ""),
)
_FUNCTIONS = "GetVersion Instantiate FreeInstance SetupExperiment EnterInitializationMode ExitInitializationMode"
_FUNCTIONS += " Terminate DoStep GetReal SetReal GetInteger SetInteger GetBoolean SetBoolean GetString SetString"
_FUNCTIONS += " GetFMUstate SetFMUstate FreeFMUstate"
_NAMES = "\n".join(f"#define fmi2{name} fmi2FullName(fmi2{name})" for name in _FUNCTIONS.split())
OWN_HEADER = f"""
#ifndef fmi2Functions_h
#define fmi2Functions_h
#include <stddef.h>
typedef void *fmi2Component, *fmi2FMUstate, *fmi2ComponentEnvironment;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef const char *fmi2String;
typedef enum {{ fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending }} fmi2Status;
typedef enum {{ fmi2ModelExchange, fmi2CoSimulation }} fmi2Type;
typedef struct {{
    void (*logger)(void *, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(void *, fmi2Status);
    void *componentEnvironment;
}} fmi2CallbackFunctions;
#define FMI2_Export __attribute__((visibility("default")))
#if defined(FMI2_FUNCTION_PREFIX)
#define fmi2Paste(a, b) a##b
#define fmi2PasteB(a, b) fmi2Paste(a, b)
#define fmi2FullName(name) fmi2PasteB(FMI2_FUNCTION_PREFIX, name)
#else
#define fmi2FullName(name) name
#endif
{_NAMES}
#endif
"""
SPELLINGS: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "FMI's header": ('#define HEADER "fmi2Functions.h"\n', {}),
    "a prefix with FMI's header": ('#define FMI2_FUNCTION_PREFIX Own_\n#define HEADER "fmi2Functions.h"\n', {}),
    "a prefix with a header of its own": (
        '#ifndef LIBRARY\n#define FMI2_FUNCTION_PREFIX Own_\n#endif\n#define HEADER "fmi2Functions.h"\n',
        {"fmi2Functions.h": OWN_HEADER},
    ),
    "names written out": (
        '#ifndef LIBRARY\n#define NAMED(name) Own_##name\n#endif\n#define HEADER "types.h"\n',
        {"types.h": OWN_HEADER},
    ),
}
"""Beginnings of the source file, and more files, by what they say of FMI's names."""


def small_sources(spelling: str = "FMI's header", gain: float = 3.0, before: str = "") -> dict[str, str]:
    """Sources of the small FMU by name; `before` comes before its first line."""
    head, more = SPELLINGS[spelling]
    files = {path.relative_to(SOURCES).as_posix(): path.read_text(encoding="utf-8") for path in SOURCES.rglob("*.[ch]")}
    named = "#ifndef NAMED\n#define NAMED(name) name\n#endif\n"
    files["small.c"] = head + named + before + files["small.c"]
    return {**files, "gain.h": f"#define GAIN {gain}\n", **more}


def small_description(
    name: str,
    *,
    files: Sequence[str] = ("small.c", "parts/helper.c"),
    flags: str = 'canGetAndSetFMUstate="true"',
    units: Mapping[str, str] | None = None,
    more: str = "",
    exact_output: bool = False,
) -> str:
    """The description of a small FMU.

    Parameters
    ----------
    files
        SourceFiles.
    flags
        More attributes of the CoSimulation element.
    units
        Physical units of Reals by name.
    more
        More ScalarVariables.
    exact_output
        Whether the state is an output.
    """
    rows = []
    for variable, type_, reference, causality, variability, start, initial in VARIABLES:
        unit = (units or {}).get(variable)
        inner = "".join((f' unit="{unit}"' if unit else "", f' start="{start}"' if start else ""))
        inner += ' declaredType="Mode"' if type_ == "Enumeration" else ""
        exact = f' initial="{initial}"' if initial else ""
        if exact_output and variable == "x":
            causality = "output"
        head = f'name="{variable}" valueReference="{reference}" causality="{causality}"'
        head += f' variability="{variability}"{exact}'
        rows.append(f"<ScalarVariable {head}><{type_}{inner}/></ScalarVariable>")
    listed = "".join(f'<File name="{file}"/>' for file in files)
    sources = f"<SourceFiles>{listed}</SourceFiles>" if files else ""
    root = f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="small">'
    outputs = "".join(f'<Unknown index="{i}" dependencies="10"/>' for i in (2, *[5] * exact_output, 7, 11))
    return (
        f'{HEAD}{root}<CoSimulation modelIdentifier="{name}" {flags}>{sources}</CoSimulation>{_UNITS}{_MODES}'
        f"<ModelVariables>{''.join(rows)}{more}</ModelVariables>"
        f"<ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}</InitialUnknowns></ModelStructure>"
        "</fmiModelDescription>"
    )


def packed_sources(path: Path, xml: str, sources: Mapping[str, str], library: Path | None) -> Path:
    """An FMU of a description, sources and a library."""
    identifier = xml.partition('modelIdentifier="')[2].partition('"')[0]
    host = host_platform()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", xml)
        for name, text in sources.items():
            archive.writestr(f"sources/{name}", text.encode("utf-8", "surrogateescape"))
        if library is not None:
            archive.write(library, f"binaries/{host.name}/{identifier}{host.extension}")
    return path


def library_of(folder: Path, sources: Mapping[str, str], files: Sequence[str]) -> Path:
    """The library of sources, as their author would compile it."""
    folder.mkdir(parents=True)
    for name, text in sources.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(text.encode("utf-8", "surrogateescape"))
    output = folder / f"library{host_platform().extension}"
    command = [*QUICKEST, "-shared", "-fPIC", "-std=gnu11", "-O2", "-ffp-contract=off", "-DLIBRARY"]
    command += ["-I", str(fmi_headers()), *files, "-o", str(output), "-lm"]
    subprocess.run(command, check=True, cwd=folder)
    return output


def small(
    folder: Path,
    name: str = "Small",
    *,
    spelling: str = "FMI's header",
    gain: float = 3.0,
    before: str = "",
    binary: bool = True,
    edit: Mapping[str, str] | None = None,
    **description: Any,
) -> Path:
    """A small FMU with its sources; `edit` replaces files, and the rest is as `small_description` says."""
    xml = small_description(name, **description)
    sources = small_sources(spelling, gain, before) | dict(edit or {})
    files = ("small.c", "parts/helper.c")
    library = library_of(folder / f"{name}.library", sources, files) if binary else None
    return packed_sources(folder / f"{name}.fmu", xml, sources, library)


def controller(folder: Path) -> Path:
    """The hand-written controller of the interoperability tests, with its source."""
    listed = '><SourceFiles><File name="impedance.c"/></SourceFiles></CoSimulation>'
    end = 'canSerializeFMUstate="true"'
    path = hand_written(folder, description=lambda text: text.replace(f"{end}/>", f"{end}{listed}"))
    with zipfile.ZipFile(path, "a") as archive:
        archive.write(HERE / "impedance.c", "sources/impedance.c")
    return path
