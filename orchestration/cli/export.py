"""Writes a system as an SSP package: ``adaptimp export``."""

from pathlib import Path

from orchestration.cli.output import output, watched
from orchestration.cli.places import require_folder, written
from orchestration.cli.systems import PACKAGE, SystemRequest
from orchestration.errors import SystemDescriptionError


def export_system(asked: SystemRequest, out: Path) -> None:
    """Write a system, with all that was changed in it, as an SSP package.

    Raises
    ------
    SystemDescriptionError
        If the file is not to be an .ssp file, or is a folder.
    """
    if out.suffix.lower() != PACKAGE:
        msg = f"{out}: a system is written as .ssp."
        raise SystemDescriptionError(msg)
    if out.is_dir():
        msg = f"{out} is a folder; a file for the package is needed."
        raise SystemDescriptionError(msg)
    with watched():
        system = asked.system()
        for notice in system.notices:
            output.remark(f"Notice: {notice}")
        require_folder(out.parent)
        existed = out.exists()
        system.write(out)
    counts = f"{len(system.components)} components, {len(system.connections)} connections"
    assumed = f", {len(system.assumptions)} assumed values with their reasons" if system.assumptions else ""
    output.say(f"{written(out, existed=existed)}: {counts}{assumed}")
