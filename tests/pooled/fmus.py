"""Makes systems of two FMUs, one of which does what its parameters say, and is reset as its kind says."""

import subprocess
import sys
from enum import IntEnum
from pathlib import Path

from adaptimp_fmu.toolchain import fmi_headers
from orchestration import System
from tests.strangers.fmus import U, Y, description, packed

STATES = 'canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
_REAL = '<ScalarVariable name="{}" valueReference="{}" causality="parameter" variability="fixed"><Real start="{}"/>'
_REAL += "</ScalarVariable>"
P, SINCE = _REAL.format("p", 2, 1), _REAL.format("since", 3, 0.5)
DEED = '<ScalarVariable name="deed" valueReference="0" causality="parameter" variability="fixed"><Integer start="0"/>'
DEED += "</ScalarVariable>"


class Deed(IntEnum):
    """What the FMU does in the first step that ends after `since`; as in pooled.c."""

    NOTHING = 0
    CRASH = 1
    HANG = 2
    END = 3
    DIVERGE = 4
    REFUSE = 5
    DISCARD = 6
    TERMINATE = 7
    FATAL = 8
    NOT_A_NUMBER = 9


def compiled(output: Path, *flags: str) -> None:
    """Compile the library of the FMUs into a file."""
    command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-fPIC", "-O1", "-I", str(fmi_headers())]
    command += ["-DFMI2_FUNCTION_PREFIX=", "-fno-sanitize=all", *flags]
    command += [str(Path(__file__).with_name("pooled.c")), "-o", str(output), "-lm"]
    subprocess.run(command, check=True, capture_output=True, text=True)


def system_of(folder: Path, first: Path, second: Path, kind: str = "good", flags: str = STATES) -> System:
    """Make a system of ``source`` and ``m``, which takes its input from ``source``.

    Parameters
    ----------
    folder
        Folder for both FMUs.
    first, second
        Libraries of ``source`` and of ``m``.
    kind
        How ``m`` is reset.
    """
    alone = '<Unknown index="{}" dependencies=""/>'
    source = description("good", [Y, P], outputs=alone.format(1), flags=flags, identifier="Source")
    driven = description(kind, [U, Y, P, DEED, SINCE], outputs=alone.format(2), flags=flags, identifier="Pooled")
    files = {
        "source": packed(folder / "Source.fmu", first, source),
        "m": packed(folder / f"{kind.replace(' ', '_')}.fmu", second, driven),
    }
    return System.of(files).connect("source.y -> m.u")
