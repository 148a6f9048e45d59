"""Measures the largest error of each function of the runtime.

    python -m tests.property.mathematics.measure [--count N] [FUNCTION ...]

N random arguments per function, 1e6 if not given, are shared among its ranges; docs/mathematics.md has the table.
"""

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from tests.property.mathematics.exact import JUDGED
from tests.property.mathematics.judge import all_draws, worst_of_many
from tests.property.mathematics.library import Mathematics

SEED = 14


def main() -> None:
    """Print a row for each function."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("functions", nargs="*", help="all of them, if none is named")
    parser.add_argument("--count", type=int, default=1_000_000, help="random arguments per function")
    given = parser.parse_args()
    console = Console(soft_wrap=True)
    console.print("| function | largest error, ulp | at |\n|---|---|---|", highlight=False)
    with TemporaryDirectory() as folder:
        mathematics = Mathematics(Path(folder))
        for name in given.functions or JUDGED:
            judged = JUDGED[name]
            arguments = all_draws(judged, given.count // len(judged.draws) + 1, SEED)
            worst = worst_of_many(mathematics, name, judged, arguments)
            where = ", ".join(map(repr, worst.arguments))
            console.print(f"| `{name}` | {worst.error:.4f} | {where} |", highlight=False)


if __name__ == "__main__":
    main()
