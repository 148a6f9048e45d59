"""Cost of a step of the built controllers of arms in space: fmi2DoStep with one tick, from a loop of C.

    uv run python -m tests.benchmarks.spatial_controllers [ARM...]

The inputs stay at their start values. A step's time is the least of 20 rounds of 500 steps. The limits are those that
were set for arms of six joints, 10 us, and of seven joints, 15 us.
"""

import ctypes
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from adaptimp_fmu import SampledModel, build
from fmus.craig_adaptive_impedance import craig_adaptive_impedance
from fmus.hogan_impedance import MOBILITY, hogan_impedance
from fmus.slotine_li_adaptive_impedance import slotine_li_adaptive_impedance
from fmus.spong_ortega_adaptive_impedance import spong_ortega_adaptive_impedance
from tests.benchmarks.native import HERE, compile_c
from tests.driver import Driver
from tests.property.spatial_robots import robot

STEP = 1e-4  # s
ROUNDS, STEPS = 20, 500
LAWS: dict[str, Callable[[Any], SampledModel]] = {
    "Hogan": lambda arm: hogan_impedance(arm, "Hogan"),
    "Hogan, form (5)": lambda arm: hogan_impedance(arm, "Hogan5", form=MOBILITY),
    "Craig": lambda arm: craig_adaptive_impedance("Craig", arm),
    "Slotine and Li": lambda arm: slotine_li_adaptive_impedance("SlotineLi", arm),
    "Spong and Ortega": lambda arm: spong_ortega_adaptive_impedance("SpongOrtega", arm),
}
SQUARE_ONLY = ("Craig", "Spong and Ortega")


@cache
def _loop() -> ctypes.CDLL:
    """The compiled loop; it stays loaded when its file is gone."""
    with TemporaryDirectory(prefix="benchmark-", ignore_cleanup_errors=True) as folder:
        return compile_c([HERE / "steps.c"], Path(folder) / "steps")


def microseconds(model: SampledModel, rounds: int = ROUNDS) -> float:
    """Time of a step of the model's FMU, us.

    Raises
    ------
    RuntimeError
        If a step fails.
    """
    driver = Driver(build(model))
    try:
        driver.initialize()
        called = [ctypes.c_void_p(driver.instance.address("fmi2DoStep")), ctypes.c_void_p(driver.instance.component)]
        best = float("inf")
        for k in range(rounds):
            span = ctypes.c_int64(STEPS * k), ctypes.c_int64(STEPS)
            begin = perf_counter()
            status = _loop().steps(*called, ctypes.c_double(STEP), *span)
            best = min(best, perf_counter() - begin)
            if status:
                msg = f"{model.name}: a step failed: {list(driver.messages)}"
                raise RuntimeError(msg)
    finally:
        driver.close()
    return 1e6 * best / STEPS


def laws(arm: Any) -> list[str]:
    """Names of the laws that an arm can have."""
    return [law for law in LAWS if arm.n == arm.task.size or law not in SQUARE_ONLY]


def main(names: list[str]) -> None:
    """Print a table of the arms."""
    sys.stdout.write(f"| arm | n | {' | '.join(LAWS)} |\n")
    for name in names:
        arm = robot(name)
        costs = [f"{microseconds(LAWS[law](arm)):.2f} us" if law in laws(arm) else "-" for law in LAWS]
        sys.stdout.write(f"| {name} | {arm.n} | {' | '.join(costs)} |\n")


if __name__ == "__main__":
    main(sys.argv[1:] or ["PUMA", "UR5", "Panda"])
