"""How far the reference agrees with itself after a tiny change of its start, when the force F_c chatters.

    python -m tests.reference.sensitivity

prints a table for the runs of algorithm 1 with noise. The initial angle q[1] moves by 1e-14 rad. The table shows the
largest difference of each kind of signal over its range, before and after the first contact.
"""

from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from tests.reference.monolithic import simulate_reference
from tests.reference.test_adaptive import CHATTERING, PERTURBATION, RUNS, reference, setup
from tests.reference.test_gauss_seidel import scale

SIGNALS = (
    "controller.tau_cmd[1]",
    "plant.ddq[1]",
    "plant.F_ext[1]",
    "plant.x[1]",
    "controller.p_hat[2]",
    "controller.e[1]",
)


def sensitivity(name: str) -> dict[str, tuple[float, float]]:
    """Return the largest difference of each signal over its range, before the first contact and from there on."""
    expected, given = reference(name), setup(RUNS[name])
    moved = simulate_reference(replace(given, q_start=(given.q_start[0] + PERTURBATION, given.q_start[1])))
    contact = int(np.flatnonzero(expected["plant.gap"] > 0)[0])
    found = {}
    for column in SIGNALS:
        miss = np.abs(moved[column] - expected[column]) / scale(expected, column)
        found[column] = float(miss[:contact].max()), float(miss[contact:].max())
    return found


def main() -> None:
    """Print the table of all runs and signals."""
    table = Table("run", "signal", "before contact", "from contact on")
    for name in CHATTERING:
        for column, (before, after) in sensitivity(name).items():
            table.add_row(name, column, f"{before:.1e}", f"{after:.1e}")
    Console().print(table)


if __name__ == "__main__":
    main()
