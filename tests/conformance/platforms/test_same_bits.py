"""Every program at hand computes the bits of a figure that the master computes, and those that the page shows."""

import hashlib
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import numpy as np
import pytest

from orchestration import System
from orchestration.paper.numbers import TRUE_MASSES
from orchestration.paper.scenarios import SCENARIOS
from tests.conformance.platforms.conftest import FOREIGN
from tests.conformance.platforms.machines import Machine, MachineUnavailableError
from tests.conformance.platforms.same_bits import __main__ as command
from tests.conformance.platforms.same_bits import page
from tests.conformance.platforms.same_bits.programs import PROGRAMS, Digest, Program, driven, sha256
from tests.conformance.platforms.same_bits.proof import Proof, digest, full_length

SHORT = 500  # steps of a run in the suite
CHATTERING = "fig5"  # the run that the last bit of a function changes most; it is made in full length
HERE = {program.name: program for program in PROGRAMS[1:] if not program.name.startswith(FOREIGN)}
ONE_BY_ONE = ("linux64", "linux64, old processor")
"""Programs that step the FMUs of a system; the others are compiled for each system, and have tests of their own."""


@pytest.fixture(scope="module")
def systems(portable: Path) -> dict[str, System]:
    """Each figure's system, of FMUs for all platforms."""
    return {
        name: scenario.system({identifier: portable / f"{identifier}.fmu" for identifier in scenario.models.values()})
        for name, scenario in SCENARIOS.items()
    }


@pytest.fixture(scope="module")
def master() -> Iterator[Digest]:
    """The program that the others are compared with."""
    with PROGRAMS[0].opened() as program:
        yield program


@pytest.fixture(scope="module")
def expected(systems: dict[str, System], master: Digest) -> dict[str, str]:
    """Hash of each figure's first rows."""
    return {name: digest(master, system, SHORT) for name, system in systems.items()}


@contextmanager
def available(program: Program) -> Iterator[Digest]:
    """The hashes of a program, or the reason why the test is skipped."""
    try:
        with program.opened() as found:
            yield found
    except MachineUnavailableError as error:
        pytest.skip(f"{program.name}: {error}")


def whole_run(program: Digest, systems: dict[str, System]) -> str:
    """Hash of all rows of the run that chatters."""
    return digest(program, systems[CHATTERING], full_length(systems[CHATTERING]))


def test_other_platforms_have_the_masters_bits(
    foreign: Machine, systems: dict[str, System], expected: dict[str, str]
) -> None:
    program = driven(foreign)
    assert {name: digest(program, system, SHORT) for name, system in systems.items()} == expected
    assert whole_run(program, systems) == page.hashes()[CHATTERING]


def test_one_fmu_has_the_masters_bits_on_other_platforms(foreign: Machine, systems: dict[str, System]) -> None:
    assert whole_run(driven(foreign, whole=True), systems) == page.hashes()[CHATTERING]


@pytest.mark.parametrize("name", ONE_BY_ONE)
def test_other_programs_have_the_masters_bits(name: str, systems: dict[str, System], expected: dict[str, str]) -> None:
    with available(HERE[name]) as program:
        assert {name: digest(program, system, SHORT) for name, system in systems.items()} == expected


@pytest.mark.parametrize("name", HERE)
def test_every_program_of_this_machine_has_the_bits_on_the_page(name: str, systems: dict[str, System]) -> None:
    with available(HERE[name]) as program:
        assert whole_run(program, systems) == page.hashes()[CHATTERING]


@pytest.mark.parametrize("figure", SCENARIOS)
def test_the_page_has_the_hash_of_the_whole_run(figure: str, systems: dict[str, System], master: Digest) -> None:
    assert digest(master, systems[figure], full_length(systems[figure])) == page.hashes()[figure]


def test_the_last_digit_of_a_mass_gives_another_hash(
    systems: dict[str, System], master: Digest, expected: dict[str, str]
) -> None:
    heavier = systems["fig2"].set({"plant.m[2]": float(np.nextafter(TRUE_MASSES[1], np.inf))})
    assert digest(master, heavier, SHORT) != expected["fig2"]


def hash_of_zeros(flipped: int | None = None) -> Digest:
    """A program that shows zeros, and one bit otherwise in a row."""

    def digest_of_rows(_system: System, steps: int, _folder: Path) -> str:
        return sha256(np.array([5e-324 if k == flipped else 0.0]).tobytes() for k in range(steps + 1))

    return digest_of_rows


def planted(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, *others: Program) -> Path:
    """Replace the programs by one that shows zeros and by others, and the page by a copy; returns the copy."""
    zeros = Program("zeros", lambda: opened(hash_of_zeros()))
    copy = tmp_path / "page.md"
    copy.write_text(page.PAGE.read_text(encoding="utf-8"), encoding="utf-8")
    monkeypatch.setattr(command, "PROGRAMS", (zeros, *others))
    monkeypatch.setattr(page, "PAGE", copy)
    return copy


@contextmanager
def opened(program: Digest) -> Iterator[Digest]:
    """A program that needs nothing."""
    yield program


def not_here() -> AbstractContextManager[Digest]:
    """A program that cannot be had."""
    raise MachineUnavailableError("no such processor is here")


def test_a_last_bit_in_the_last_row_is_noticed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = planted(monkeypatch, tmp_path, Program("flipped", lambda: opened(hash_of_zeros(SHORT))))
    before = copy.read_bytes()
    assert command.main(["--figures", "fig2", "--steps", str(SHORT - 1)]) == 0
    assert "2 programs, 500 rows, 40 columns: equal" in capsys.readouterr().out
    assert command.main(["--figures", "fig2", "--steps", str(SHORT)]) == 1
    assert "DIFFERENT" in capsys.readouterr().out
    assert copy.read_bytes() == before


def test_a_program_that_is_missing_is_named_and_keeps_the_page_from_being_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = planted(monkeypatch, tmp_path, Program("other", not_here))
    before = copy.read_bytes()
    assert command.main(["--figures", "fig2", "--steps", "1"]) == 0
    assert "other is not at hand: no such processor is here." in capsys.readouterr().out
    assert command.main(["--write"]) == 1
    assert "is not written, because programs are missing: other." in capsys.readouterr().out
    assert copy.read_bytes() == before


def test_the_page_is_written_for_all_figures_in_full_length(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = planted(monkeypatch, tmp_path)
    assert command.main(["--write"]) == 0
    assert set(page.hashes()) == set(SCENARIOS)
    assert page.hashes()["fig2"] == hashlib.sha256(bytes(8 * 20_001)).hexdigest()
    assert "| fig2 | 20001 | 40 | `" in copy.read_text(encoding="utf-8")
    with pytest.raises(SystemExit):
        command.main(["--write", "--steps", "3"])
    assert "--write needs all figures in full length." in capsys.readouterr().err


def test_one_program_alone_is_no_proof_of_a_difference() -> None:
    assert Proof("fig2", 1, 1, {"master": "a"}).equal
    assert not Proof("fig2", 1, 1, {"master": "a", "other": "b"}).equal
