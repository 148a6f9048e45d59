"""Makes FMUs of one small C program; the description is the test's own, the behaviour is chosen by a word."""

import subprocess
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

from adaptimp_fmu.toolchain import fmi_headers, host_platform

SOURCE = Path(__file__).with_name("stranger.c")
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
U = '<ScalarVariable name="u" valueReference="0" causality="input"><Real start="3"/></ScalarVariable>'
Y = '<ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>'
P = '<ScalarVariable name="p" valueReference="2" causality="parameter" variability="fixed"><Real start="1"/>'
P += "</ScalarVariable>"
SAYS = '<ScalarVariable name="says" valueReference="1" causality="output" variability="discrete"><String/>'
SAYS += "</ScalarVariable>"
HEARS = '<ScalarVariable name="hears" valueReference="0" causality="input" variability="discrete">'
HEARS += '<String start="abc"/></ScalarVariable>'
COUNT = (
    '<ScalarVariable name="n" valueReference="{}" causality="{}" variability="discrete"><Integer{}/></ScalarVariable>'
)


def compiled(folder: Path, *flags: str) -> Path:
    """The library of the program."""
    output = folder / f"stranger{'_'.join(flags)}{host_platform().extension}"
    command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-fPIC", "-O1", "-I", str(fmi_headers())]
    command += ["-DFMI2_FUNCTION_PREFIX=", "-fno-sanitize=all", *flags, str(SOURCE), "-o", str(output), "-lm"]
    subprocess.run(command, check=True, capture_output=True, text=True)
    return output


def description(
    kind: str,
    variables: Sequence[str],
    *,
    outputs: str,
    flags: str = "",
    before: str = "",
    identifier: str = "Stranger",
) -> str:
    """The description of an FMU of a kind.

    Parameters
    ----------
    outputs
        The Unknown elements of its outputs.
    flags
        More attributes of the CoSimulation element.
    before
        Elements before ModelVariables.
    """
    root = f'<fmiModelDescription fmiVersion="2.0" modelName="Stranger" guid="stranger-{kind}">'
    simulation = f'<CoSimulation modelIdentifier="{identifier}" {flags}/>'
    structure = f"<ModelStructure><Outputs>{outputs}</Outputs></ModelStructure>"
    listed = f"<ModelVariables>{''.join(variables)}</ModelVariables>"
    return f"{HEAD}{root}{simulation}{before}{listed}{structure}</fmiModelDescription>"


def packed(path: Path, library: Path, xml: str, entries: Sequence[tuple[str, bytes]] = ()) -> Path:
    """An FMU of a library and a description, with more entries in the archive."""
    identifier = xml.partition('modelIdentifier="')[2].partition('"')[0]
    host = host_platform()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", xml)
        archive.write(library, f"binaries/{host.name}/{identifier}{host.extension}")
        for name, content in entries:
            archive.writestr(name, content)
    return path
