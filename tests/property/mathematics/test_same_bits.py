"""The runtime's mathematics gives the same bits with every compiler, at every level of optimization."""

import shutil
import sys
from pathlib import Path

import pytest

from tests.property.mathematics.library import HASHED, ZIG, compile_functions, hashes
from tests.untested import needs

LEVELS = ("-O0", "-O2", "-O3")
PROGRAM = f"-DHASHES={HASHED}"


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The hashes of the compiler that FMUs are built with."""
    program = tmp_path_factory.mktemp("zig") / "hashes"
    compile_functions(program, ZIG, "-O2", "-ffp-contract=off", PROGRAM)
    return hashes(program)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_compilers_agree(compiler: str, level: str, expected: dict[str, str], tmp_path: Path) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(needs(f"{compiler} is not here", compiler))
    program = tmp_path / "hashes"
    compile_functions(program, (compiler,), level, PROGRAM)
    assert hashes(program) == expected


@pytest.mark.parametrize("level", LEVELS)
def test_levels_of_optimization_agree(level: str, expected: dict[str, str], tmp_path: Path) -> None:
    program = tmp_path / "hashes"
    compile_functions(program, ZIG, level, PROGRAM)
    assert hashes(program) == expected


@pytest.mark.skipif(sys.platform == "win32", reason="gcc of Debian")
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_instructions_that_multiply_and_add_are_not_used(
    compiler: str, expected: dict[str, str], tmp_path: Path
) -> None:
    """Also where the compiler may use them, which GNU's C does and ISO's does not."""
    if shutil.which(compiler) is None:
        pytest.skip(needs(f"{compiler} is not here", compiler))
    if "fma" not in Path("/proc/cpuinfo").read_text(encoding="utf-8"):
        pytest.skip("the processor has no such instructions")
    program = tmp_path / "hashes"
    compile_functions(program, (compiler,), "-O2", "-mfma", "-std=gnu11", PROGRAM)
    assert hashes(program) == expected


def test_square_roots_of_integers_are_those_of_the_processor(expected: dict[str, str], tmp_path: Path) -> None:
    sources = tmp_path / "sources"
    shutil.copytree(Path("adaptimp_fmu/runtime"), sources)
    numbers = sources / "real_numbers.h"
    text = numbers.read_text(encoding="utf-8")
    numbers.write_text(text.replace("return REAL_SQRT(x);", "return real_sqrt_of_integers(x);"), encoding="utf-8")
    assert "REAL_SQRT(x);" not in numbers.read_text(encoding="utf-8")
    program = tmp_path / "hashes"
    compile_functions(program, ZIG, "-O2", PROGRAM, sources=sources)
    assert hashes(program) == expected
