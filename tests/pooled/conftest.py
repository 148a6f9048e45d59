"""Fixtures: systems of two FMUs, one of which does what its parameters say, and is reset as its kind says."""

import subprocess
import sys
from collections.abc import Callable
from enum import IntEnum
from pathlib import Path

import pytest

from adaptimp_fmu.toolchain import fmi_headers
from orchestration import System
from tests.sharing import made_once
from tests.strangers.fmus import U, Y, description, packed

Pooled = Callable[..., System]
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


def _compiled(output: Path, *flags: str) -> None:
    command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-fPIC", "-O1", "-I", str(fmi_headers())]
    command += ["-DFMI2_FUNCTION_PREFIX=", "-fno-sanitize=all", *flags]
    command += [str(Path(__file__).with_name("pooled.c")), "-o", str(output), "-lm"]
    subprocess.run(command, check=True, capture_output=True, text=True)


@pytest.fixture(scope="session")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the library, and with one that lacks fmi2Reset."""

    def make(folder: Path) -> None:
        _compiled(folder / "whole")
        _compiled(folder / "unresettable", "-DWITHOUT_RESET")

    return made_once(tmp_path_factory, "pooled", make)


@pytest.fixture
def pooled(libraries: Path, tmp_path: Path) -> Pooled:
    """Make a system of ``source`` and ``m``, which takes its input from ``source``; the kind is that of ``m``."""

    def make(kind: str = "good", library: str = "whole", flags: str = STATES, source: str = "good") -> System:
        outputs = '<Unknown index="{}" dependencies=""/>'
        first = description(source, [Y, P], outputs=outputs.format(1), flags=flags, identifier="Source")
        second = description(kind, [U, Y, P, DEED, SINCE], outputs=outputs.format(2), flags=flags, identifier="Pooled")
        files = {
            "source": packed(tmp_path / "Source.fmu", libraries / "whole", first),
            "m": packed(tmp_path / f"{kind.replace(' ', '_')}.fmu", libraries / library, second),
        }
        return System.of(files).connect("source.y -> m.u")

    return make
