"""The build backend of adaptimp: hatchling, which for a wheel also needs the toolchain that builds the FMUs in it.

An editable installation, such as that of ``uv run``, carries no FMUs, and does not wait for the toolchain.
"""

import tomllib
from pathlib import Path
from typing import Any

from hatchling.build import *  # noqa: F403 - the other functions of a backend
from hatchling.build import get_requires_for_build_wheel as hatchling_requires

ROOT = Path(__file__).parents[1]


def get_requires_for_build_wheel(config_settings: dict[str, Any] | None = None) -> list[str]:
    """Packages that the build of a wheel needs: those of the core and of the part ``build``."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [*hatchling_requires(config_settings), *project["dependencies"], *project["optional-dependencies"]["build"]]
