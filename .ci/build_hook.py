"""Adds to a wheel what running needs besides the modules: FMUs for five platforms, scenarios, files of the standards.

The FMUs are built from the sources beside this file, by `orchestration.paper.carry`.
"""

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CarryHook(BuildHookInterface):
    """Fills a temporary folder, and lets the wheel include its files."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the files before the wheel is written; an editable installation gets none.

        Raises
        ------
        subprocess.CalledProcessError
            If an FMU cannot be built; the reason is on standard error.
        """
        if version == "editable":
            return
        self._folder = Path(tempfile.mkdtemp(prefix="adaptimp-wheel-"))
        carried, standards = self._folder / "carried", self._folder / "standards"
        carried.mkdir()
        environment = {**os.environ, "PYTHONPATH": self.root, "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-m", "orchestration.paper.carry", str(carried)]
        subprocess.run(command, cwd=self._folder, env=environment, check=True, stdout=sys.stderr)
        self._copy_standards(standards)
        build_data["force_include"] |= {str(carried): "fmus/carried", str(standards): "adaptimp_fmu/standards"}

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:  # noqa: ARG002
        """Remove the temporary folder."""
        if version != "editable":
            shutil.rmtree(self._folder, ignore_errors=True)

    def _copy_standards(self, folder: Path) -> None:
        """Copy what running needs of fmpy's package folder, with fmpy's license."""
        sys.path.insert(0, self.root)
        try:
            from adaptimp_fmu.files.standards import CARRIED_FOLDERS
        finally:
            sys.path.remove(self.root)
        found = importlib.util.find_spec("fmpy")
        assert found is not None  # noqa: S101 - the backend has asked for it
        assert found.origin is not None  # noqa: S101
        source = Path(found.origin).parent
        for name in CARRIED_FOLDERS:
            shutil.copytree(source / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", "*.py"))
        (license_file,) = source.parent.glob("[fF][mM][pP][yY]-*.dist-info/licenses/LICENSE.txt")
        shutil.copyfile(license_file, folder / "LICENSE-fmpy.txt")
