"""Cost of the equations of spatial arms as compiled C: operations, and the time of a call.

    uv run python -m tests.benchmarks.spatial [ARM...]

CasADi's C of each function is compiled by zig with -O2. A call's time is the least of 20 rounds of 2000 calls, whose
first joint coordinate moves on from call to call.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import casadi as ca

from fmus.mechanics.spatial_arm import SpatialArm
from tests.property.robots import NAMES, chain

LAWS = ("acceleration", "inverse_dynamics", "regressor", "inertia", "bias", "jacobian_rate")
CLOCK = r"""
#include <stdio.h>
#include <time.h>
int FUNCTION(const double **arg, double **res, long long *iw, double *w, int memory);
static double values[8][200], result[2000], work[20000];
static long long integers[200];
int main(void) {
    const double *arguments[16];
    double *results[8] = {result}, best = 1e9;
    for (int i = 0; i < 8; i++) {
        for (int j = 0; j < 200; j++) values[i][j] = 0.1 + 0.01 * ((37 * i + 11 * j) % 50);
        arguments[i] = values[i];
    }
    for (int round = 0; round < 20; round++) {
        struct timespec start, end;
        clock_gettime(CLOCK_MONOTONIC, &start);
        for (int k = 0; k < 2000; k++) {
            values[0][0] += 1e-6;
            FUNCTION(arguments, results, integers, work, 0);
        }
        clock_gettime(CLOCK_MONOTONIC, &end);
        double time = ((end.tv_sec - start.tv_sec) * 1e9 + (end.tv_nsec - start.tv_nsec)) / 2000;
        if (time < best) best = time;
    }
    printf("%.3f\n", best / 1e3);
    return 0;
}
"""


def microseconds(function: ca.Function) -> float:
    """Time of a call of the compiled function, us."""
    with tempfile.TemporaryDirectory() as folder:
        generator = ca.CodeGenerator("equations.c")
        generator.add(function)
        generator.generate(folder + "/")
        clock, program = Path(folder, "clock.c"), Path(folder, "clock")
        clock.write_text(CLOCK.replace("FUNCTION", function.name()), encoding="utf-8")
        sources = [str(clock), str(Path(folder, "equations.c"))]
        command = [sys.executable, "-m", "ziglang", "cc", "-O2", *sources, "-o", str(program), "-lm"]
        subprocess.run(command, check=True, capture_output=True)
        return float(subprocess.run([str(program)], check=True, capture_output=True, text=True).stdout)


def main(names: list[str]) -> None:
    """Print a table of the arms."""
    rows = [["arm", "n", *(law.replace("_", " ") for law in LAWS)]]
    for name in names:
        arm = SpatialArm(chain(name))
        functions = [getattr(arm, law) for law in LAWS]
        costs = [f"{f.n_instructions()}, {microseconds(f):.2f} us" for f in functions]
        rows.append([name, str(arm.n), *costs])
    for row in rows:
        sys.stdout.write("| " + " | ".join(row) + " |\n")


if __name__ == "__main__":
    main(sys.argv[1:] or [*NAMES])
