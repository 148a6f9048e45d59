"""The pages in ``documentation/`` of a container: which FMUs and numbers it is made of, and how to rebuild it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

from adaptimp_fmu.codegen import RUNTIME_LICENSE, runtime_license, runtime_sources
from adaptimp_fmu.description import number
from adaptimp_fmu.pages import page_environment
from adaptimp_fmu.variables import Type
from orchestration.containers.fmu.description import summary
from orchestration.containers.fmu.drawn_diagram import drawn
from orchestration.containers.plan import FIXED, INPUT, OUTPUT, TUNABLE, Member, Plan
from orchestration.fmi.codes import BOOLEAN, REAL
from orchestration.fmi.document import Document
from orchestration.sandbox.archive import entry_names, read_entries
from orchestration.system.system import System

INDEX = "index.html"
LICENSE = "licenses/license.txt"  # the place FMI 2.0.5, section 2.3, reserves for it
_LICENSES = "documentation/licenses/"
_MOST_LICENSES = 10**6  # bytes of all license files of one FMU
_KINDS = {"Inputs": (INPUT,), "Outputs": (OUTPUT,), "Parameters": (FIXED, TUNABLE)}


@dataclass(frozen=True)
class Part:
    """A component as the documentation shows it, with texts about its FMU."""

    name: str
    model: str
    file: str
    guid: str
    hash: str
    license: str


@dataclass(frozen=True)
class Row:
    """A row of an interface table."""

    name: str
    type: str
    unit: str
    start: str
    tunable: str
    description: str


def adaptimp_version() -> str:
    """Return the version of this project; ``unknown`` if it is not installed."""
    try:
        return version("adaptimp")
    except PackageNotFoundError:
        return "unknown"


def container_documentation(plan: Plan, documents: Mapping[str, Document], sources: Sequence[str]) -> dict[str, bytes]:
    """Return the files of ``documentation/`` by name; the same system gives the same files.

    Parameters
    ----------
    plan
        The system as a program.
    documents
        Description of each component's FMU, by the name of the component.
    sources
        Names of the C files in ``sources/`` that are compiled.
    """
    parts = [_part(member, documents[member.name]) for member in plan.members]
    template = page_environment("orchestration.containers").get_template("container.html.j2")
    page = template.render(
        plan=plan,
        summary=summary(plan),
        saves_state=plan.saves,
        libraries=["m"] if any(fmu.needed for fmu in plan.fmus) else [],
        parts_made=parts,
        diagram=drawn(plan.system),
        given=_given(plan.system),
        tables={title: _rows(plan, roles) for title, roles in _KINDS.items()},
        sources=sources,
        most_steps=_most_steps(),
        version=adaptimp_version(),
        license_file=LICENSE,
    )
    return {INDEX: page.encode(), LICENSE: _license_index(parts).encode(), **_licenses(plan.system)}


def _most_steps() -> str:
    """Limit of the runtime, read from its source, so that the page cannot contradict it."""
    return runtime_sources()["container.c"].partition("#define MAX_INNER_STEPS ")[2].partition("\n")[0]


def _part(member: Member, document: Document) -> Part:
    stated = filter(None, (document.root.get("license"), document.root.get("copyright")))
    return Part(
        member.name,
        document.model_name,
        member.fmu.path.name,
        document.guid,
        member.fmu.sha256,
        ", ".join(stated) or "not stated",
    )


def _given(system: System) -> list[tuple[str, str, str]]:
    """Start values that differ from the FMUs': path, value with unit, and why it was assumed."""
    found = []
    for component in system.components:
        for name, value in component.start.items():
            variable = component.variable(name)
            if value == variable.start:
                continue
            shown = value if isinstance(value, str) else number(float(value), _type(variable.type))
            path = f"{component.name}.{name}"
            found.append((path, f"{shown} {variable.unit}".strip(), system.assumptions.get(path, "")))
    return found


def _type(name: str) -> Type:
    return Type(name) if name in (REAL, BOOLEAN) else Type.INTEGER


def _rows(plan: Plan, roles: Sequence[str]) -> list[Row]:
    return [
        Row(
            variable.path,
            variable.declared.type,
            variable.declared.unit,
            number(variable.start, _type(variable.declared.type)) if variable.role != OUTPUT else "",
            "yes" if variable.role == TUNABLE else "",
            variable.declared.description,
        )
        for variable in plan.with_role(*roles)
    ]


def _license_index(parts: Sequence[Part]) -> str:
    """Which license covers which part, and the license of the runtime."""
    lines = [f"{part.name} ({part.file}): {part.license}" for part in parts]
    return (
        "Each component has the license of its FMU. License files that an FMU brings stand in a folder with the\n"
        "name of the FMU, beside this file.\n\n"
        + "\n".join(lines)
        + f"\n\nThe program around the components has this license, which is in sources/fmi/{RUNTIME_LICENSE}, too:\n\n"
        + runtime_license()
    )


def _licenses(system: System) -> dict[str, bytes]:
    """License files of the FMUs, each in a folder with the name of its FMU."""
    found: dict[str, bytes] = {}
    for component in system.components:
        names = [name for name in entry_names(component.path) if name.startswith(_LICENSES) and name[-1] != "/"]
        for name, content in read_entries(component.path, names, _MOST_LICENSES):
            found[f"licenses/{component.path.stem}/{name.removeprefix(_LICENSES)}"] = content
    return found
