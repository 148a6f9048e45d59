"""Runs figures in every program that is at hand, and compares the hashes of their rows."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from adaptimp_fmu import PLATFORMS as ALL
from adaptimp_fmu import build, host_platform
from fmus.catalog import MODELS
from orchestration import System
from orchestration.paper.scenarios import SCENARIOS
from tests.conformance.platforms.machines import MachineUnavailableError
from tests.conformance.platforms.same_bits.programs import PLATFORMS, Digest, Program, plan


@dataclass(frozen=True)
class Proof:
    """Hashes of a figure's rows.

    Attributes
    ----------
    rows, columns
        Counts; row 0 is one of the rows.
    hashes
        SHA-256 of all rows by the name of the program.
    """

    figure: str
    rows: int
    columns: int
    hashes: Mapping[str, str]

    @property
    def equal(self) -> bool:
        """Whether all programs computed the same bits."""
        return len(set(self.hashes.values())) == 1


def systems(figures: Iterable[str], folder: Path) -> list[System]:
    """The systems of figures, made of FMUs for all the platforms of a proof, which are built into a folder."""
    found = [SCENARIOS[figure] for figure in figures]
    names = dict.fromkeys(name for scenario in found for name in scenario.models.values())
    platforms = dict.fromkeys((host_platform().name, *PLATFORMS))
    files = {name: build(MODELS[name](), folder, [ALL[platform] for platform in platforms]) for name in names}
    return [scenario.system(files) for scenario in found]


def full_length(system: System) -> int:
    """Number of steps of the whole run."""
    return round(system.run_stop_time() / system.run_step())


def digest(program: Digest, system: System, steps: int) -> str:
    """SHA-256 of the rows of the first steps of a system."""
    with TemporaryDirectory(prefix="same-bits-") as folder:
        return program(system, steps, Path(folder))


@contextmanager
def at_hand(programs: Sequence[Program]) -> Iterator[tuple[dict[str, Digest], dict[str, str]]]:
    """Set up programs: those that run here, and why the others do not, both by name."""
    running, missing = {}, {}
    with ExitStack() as stack:
        for program in programs:
            try:
                running[program.name] = stack.enter_context(program.opened())
            except MachineUnavailableError as error:
                missing[program.name] = str(error)
        yield running, missing


def prove(system: System, steps: int, running: Mapping[str, Digest]) -> Proof:
    """Run the first steps of a system in every program."""
    hashes = {name: digest(program, system, steps) for name, program in running.items()}
    return Proof(system.name, steps + 1, len(plan(system, 1).outputs), hashes)
