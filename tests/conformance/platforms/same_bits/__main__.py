"""Prints one SHA-256 of all rows of each figure for each program that runs on this machine.

    python -m tests.conformance.platforms.same_bits [--figures FIGURE ...] [--steps N] [--write]

Ends with 1 if a program computes other bits than the master.
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from orchestration.paper.scenarios import SCENARIOS
from tests.conformance.platforms.same_bits import page
from tests.conformance.platforms.same_bits.programs import PROGRAMS
from tests.conformance.platforms.same_bits.proof import Proof, at_hand, full_length, prove, systems


def main(arguments: Sequence[str] | None = None) -> int:
    """Prove, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Hashes of the rows of the paper's figures, program by program.")
    parser.add_argument("--figures", nargs="+", choices=SCENARIOS, default=list(SCENARIOS), metavar="FIGURE")
    parser.add_argument("--steps", type=int, help="steps of each run; the whole run if not given")
    parser.add_argument("--write", action="store_true", help=f"write the hashes into docs/{page.PAGE.name}")
    given = parser.parse_args(arguments)
    if given.write and (given.steps is not None or set(given.figures) != set(SCENARIOS)):
        parser.error("--write needs all figures in full length.")
    console = Console(soft_wrap=True)
    with TemporaryDirectory(prefix="same-bits-") as folder, at_hand(PROGRAMS) as (running, missing):
        proofs = []
        for system in systems(given.figures, Path(folder)):
            proofs.append(prove(system, given.steps or full_length(system), running))
            _print(proofs[-1], console)
    for name, reason in missing.items():
        console.print(f"{name} is not at hand: {reason}.", highlight=False)
    equal = all(proof.equal for proof in proofs)
    if given.write and equal and not missing:
        page.write(proofs)
    elif given.write:
        _refuse(missing, console)
    return 0 if equal and not (given.write and missing) else 1


def _print(proof: Proof, console: Console) -> None:
    """Print the hash of each program, and whether all are equal."""
    for name, found in proof.hashes.items():
        console.print(f"{proof.figure}  {name:<24} {found}", highlight=False)
    verdict = "equal" if proof.equal else "DIFFERENT"
    programs = "1 program" if len(proof.hashes) == 1 else f"{len(proof.hashes)} programs"
    count = f"{programs}, {proof.rows} rows, {proof.columns} columns"
    console.print(f"{proof.figure}  {count}: {verdict}", highlight=False, style="bold")


def _refuse(missing: Mapping[str, str], console: Console) -> None:
    """Say why the page is not written."""
    why = f"programs are missing: {', '.join(missing)}" if missing else "the hashes of a figure differ"
    console.print(f"docs/{page.PAGE.name} is not written, because {why}.", highlight=False)


if __name__ == "__main__":
    raise SystemExit(main())
