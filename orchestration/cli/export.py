"""Writes a system as an SSP package, or as one program in one of several forms: ``adaptimp export``."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from orchestration.analysis.doctor.finding import counted
from orchestration.cli.output import output, watched
from orchestration.cli.places import require_folder, written
from orchestration.cli.systems import PACKAGE, SystemRequest
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion
from orchestration.system.registry import CONTAINERS, program_writer
from orchestration.system.system import System

SSP = "ssp"
"""Form that is a package of FMUs and not one program."""


@dataclass(frozen=True)
class ExportRequest:
    """What is written, and where.

    Attributes
    ----------
    form
        `SSP` or one of `CONTAINERS`; None chooses by the suffix of `out`.
    step
        Communication step of the system, s; None leaves it.
    order
        Names of the components in the order of stepping, with commas; None leaves it.
    algorithm, platforms
        Choices for a program; None and empty for the usual ones.
    """

    asked: SystemRequest
    out: Path
    form: str | None = None
    step: float | None = None
    order: str | None = None
    algorithm: str | None = None
    platforms: Sequence[str] = ()

    def system(self) -> System:
        """Make the system, with its step and its order."""
        system = self.asked.system()
        if self.order is not None:
            system = system.ordered([name.strip() for name in self.order.split(",")])
        return system if self.step is None else replace(system, step=self.step)


def export_system(wanted: ExportRequest) -> None:
    """Write a system, with all that was changed in it.

    Raises
    ------
    OrchestrationError
        If there is no such form, the path does not fit the form, or the system cannot have the form.
    """
    form = _form(wanted)
    out = wanted.out
    if out.is_dir() and (form == SSP or CONTAINERS[form].suffix):
        msg = f"{out} is a folder; a file for the {'package' if form == SSP else 'program'} is needed."
        raise SystemDescriptionError(msg)
    with watched() as line:
        system = wanted.system()
        for notice in system.notices:
            output.remark(f"Notice: {notice}")
        require_folder(out.parent)
        existed = out.exists()
        if form == SSP:
            system.write(out)
        else:
            line.begin(f"writing {system.name} as {form}")
            program_writer(form)(system, out, **_choices(wanted, form))
            line.end()
    output.say(f"{written(out, existed=existed)}: {_contents(system, form)}")


def _form(wanted: ExportRequest) -> str:
    """Return the form that was asked for, by name or by the suffix of the path."""
    suffixes = {PACKAGE: SSP} | {program.suffix: form for form, program in CONTAINERS.items() if program.suffix}
    form = wanted.form
    suffix = wanted.out.suffix.lower()
    if form is None:
        if suffix not in suffixes:
            known = ", ".join(suffixes)
            msg = f"{wanted.out}: the name does not say what to write; end it with one of {known}, or give --as c."
            raise SystemDescriptionError(msg)
        form = suffixes[suffix]
    if form != SSP and form not in CONTAINERS:
        msg = f"--as {form}: there is no such form; {suggestion(form, [SSP, *CONTAINERS])}"
        raise SystemDescriptionError(msg)
    needed = PACKAGE if form == SSP else CONTAINERS[form].suffix
    if needed and suffix != needed:
        other = f", not in {suffix}" if suffix else ""
        msg = (
            f"{wanted.out}: with --as {form} the name of the file ends in {needed}{other};"
            f" write {wanted.out.with_suffix(needed).name}."
        )
        raise SystemDescriptionError(msg)
    if form == SSP and wanted.algorithm is not None:
        msg = (
            f"--algorithm {wanted.algorithm}: a package has no algorithm;"
            " leave the option out, or write one program (--as fmu, wasm or c)."
        )
        raise SystemDescriptionError(msg)
    if wanted.platforms and (form == SSP or not CONTAINERS[form].platforms):
        what = {SSP: "a package of this command", "c": "a folder of C"}.get(form, f"a program as {form}")
        msg = f"--platform {wanted.platforms[0]}: {what} has no binaries for platforms; leave the option out."
        raise SystemDescriptionError(msg)
    return form


def _choices(wanted: ExportRequest, form: str) -> dict[str, object]:
    """Options of the function that writes a program, as far as they were given."""
    choices: dict[str, object] = {}
    if wanted.algorithm is not None:
        choices["algorithm"] = wanted.algorithm
    if wanted.platforms and CONTAINERS[form].platforms:
        choices["platforms"] = tuple(wanted.platforms)
    return choices


def _contents(system: System, form: str) -> str:
    """What was written, in words."""
    counts = ", ".join([counted(len(system.components), "component"), counted(len(system.connections), "connection")])
    if form != SSP:
        return f"{counts}, in steps of {system.run_step():g} s"
    return counts + (f", {len(system.assumptions)} assumed values with their reasons" if system.assumptions else "")
