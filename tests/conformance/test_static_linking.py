"""Tests of several FMUs in one program, compiled from the FMUs' own sources under FMI2_FUNCTION_PREFIX."""

import re
import shutil
import subprocess
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import ContinuousModel, build
from adaptimp_fmu.toolchain import fmi_headers, host_platform
from fmus.catalog import MODELS
from orchestration import Component, System
from orchestration.fmi.description import read_description
from tests.conformance.binary import FUNCTIONS, Binary
from tests.conformance.container import of_models
from tests.conformance.platforms.machines import DRIVER, Machine
from tests.conformance.platforms.plan import Plan
from tests.conformance.scenes import STEPS, H, random_inputs, scene
from tests.conformance.test_rebuild import COMPILERS
from tests.untested import needs

SEED = 31
ROWS = 200
AGAIN = "PlantAgain"
"""Component with the same FMU as the component Plant, under a prefix of its own."""
PREFIXES = {**{name: name for name in MODELS}, AGAIN: "Plant"}
"""Model identifiers by component; the component's name and an underscore are the prefix."""
FLAGS = ("-std=c11", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-sanitize=all")


@pytest.fixture(scope="module")
def alone(fmu_folder: Path, load: Callable[[str], Binary]) -> Plan:
    """Every FMU, and one of them twice, without connections: its scene, with random inputs and steps."""
    rng = np.random.default_rng(SEED)
    binaries = {name: load(identifier) for name, identifier in PREFIXES.items()}
    components = [
        Component(name, read_description(fmu_folder / f"{identifier}.fmu"), scene(binaries[name]))
        for name, identifier in PREFIXES.items()
    ]
    rows = [
        {f"{n}.{k}": v for n, binary in binaries.items() for k, v in random_inputs(binary, rng).items()}
        for _ in range(ROWS)
    ]
    given = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return Plan(System("alone", tuple(components)), H * rng.choice(STEPS, ROWS), given)


@pytest.fixture(scope="module")
def expected(alone: Plan, tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    """Outputs of the shared libraries."""
    return Machine(host_platform()).run(alone, tmp_path_factory.mktemp("shared"))


def command(compiler: str) -> Sequence[str]:
    if shutil.which(COMPILERS[compiler][0]) is None:
        pytest.skip(needs(f"{compiler} is not installed", compiler))
    return COMPILERS[compiler]


def compiled(compiler: Sequence[str], fmu: Path, prefix: str, folder: Path) -> Path:
    """The object of an FMU's own sources under a prefix."""
    sources, output = folder / prefix, folder / f"{prefix}.o"
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(sources, [name for name in archive.namelist() if name.startswith("sources/")])
    prefixed = ("-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-DFMI2_FUNCTION_PREFIX={prefix}")
    arguments = ["-I", str(fmi_headers()), "-c", str(sources / "sources" / "model.c"), "-o", str(output)]
    subprocess.run([*compiler, *FLAGS, *prefixed, *arguments], check=True, cwd=folder)
    return output


def table(prefixes: Sequence[str], functions: Sequence[str]) -> str:
    """The header that driver.c includes: the functions of all FMUs."""
    pairs = [(prefix, function) for prefix in prefixes for function in functions]
    declared = [f"extern {function}TYPE {prefix}{function};" for prefix, function in pairs]
    rows = [f'{{"{prefix}", "{function}", (void (*)(void)){prefix}{function}}},' for prefix, function in pairs]
    return "\n".join([*declared, "static const Linked linked[] = {", *rows, "{0, 0, 0}};", ""])


def run_linked(compiler: Sequence[str], plan: Plan, folder: Path) -> dict[str, np.ndarray]:
    """Link all FMUs of a plan and the driver into one program, and run it."""
    components = plan.system.components
    objects = [compiled(compiler, c.description.path, f"{c.name}_", folder) for c in components]
    called = re.findall(r"X\((fmi2\w+)\)", DRIVER.read_text(encoding="utf-8"))
    (folder / "linked.h").write_text(table([f"{c.name}_" for c in components], called), encoding="utf-8")
    arguments = ["-I", str(fmi_headers()), "-I", str(folder), '-DLINKED_UNITS="linked.h"', str(DRIVER)]
    linking = [*compiler, *FLAGS, *arguments, *map(str, objects), "-o", str(folder / "driver"), "-lm"]
    subprocess.run(linking, check=True, cwd=folder)
    plan.numbers().tofile(folder / "plan")
    names = [text for c in components for text in (c.name, f"{c.name}_", c.description.guid)]
    run = subprocess.run([str(folder / "driver"), "plan", *names], check=True, cwd=folder, capture_output=True)
    return plan.outputs_in(run.stdout)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_all_fmus_in_one_program_are_the_shared_libraries_bit_for_bit(
    compiler: str, alone: Plan, expected: dict[str, np.ndarray], tmp_path: Path
) -> None:
    found = run_linked(command(compiler), alone, tmp_path)
    assert {name for name, values in expected.items() if values.tobytes() != found[name].tobytes()} == set()
    own, again = ({k.partition(".")[2]: v for k, v in found.items() if k.startswith(f"{n}.")} for n in ("Plant", AGAIN))
    assert {name: own[name].tobytes() != values.tobytes() for name, values in again.items()}["q[1]"]


def visible_names(object_file: Path) -> set[str]:
    """Names that an object file defines for other object files."""
    run = subprocess.run(["nm", "-g", "--defined-only", str(object_file)], check=True, capture_output=True, text=True)
    return {line.split()[-1] for line in run.stdout.splitlines()}


@pytest.mark.skipif(shutil.which("nm") is None, reason=needs("nm is not installed", "binutils"))
@of_models
def test_an_fmu_defines_nothing_but_fmi_functions_with_its_prefix(fmu: Path, tmp_path: Path) -> None:
    object_file = compiled(command("zig cc"), fmu, "Some_", tmp_path)
    assert visible_names(object_file) == {f"Some_{function}" for function in FUNCTIONS}


@pytest.mark.skipif(shutil.which("nm") is None, reason=needs("nm is not installed", "binutils"))
def test_functions_that_casadi_adds_are_not_visible(tmp_path: Path) -> None:
    """A model of a user makes CasADi add other helpers than the project's own models do."""
    model = ContinuousModel("Helpers", "Every helper that CasADi adds for scalars")
    u = model.input("u", unit="1", start=0.5, description="Input")
    values = (u**2, ca.sign(u), ca.fmin(u, 0.2), ca.fmax(u, 0.2), ca.fabs(u), ca.if_else(u > 0, u, -u))
    for i, value in enumerate(values):
        model.output(f"y{i}", value, unit="1", description="Output")
    object_file = compiled(command("zig cc"), build(model, tmp_path), "Some_", tmp_path)
    assert visible_names(object_file) == {f"Some_{function}" for function in FUNCTIONS}
