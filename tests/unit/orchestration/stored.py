"""Results to be written, and what becomes of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from orchestration import Result
from orchestration.results.parquet_file import ParquetSink

NAMES = ("plant.x[1]", "controller.p_hat[6]", "actuator.saturated[1]")
ODD = ("a.H[1,2]", 'b."quoted" name', "straße.φ[1]", "c. spaced ", "d.line\nbreak", "#e.y")
UNITS = {"plant.x[1]": "m", "controller.p_hat[6]": "kg.m2", "actuator.saturated[1]": ""}
METADATA = {"system": "fig2, übung", "step": "0.0001", "connections": '["a.y -> b.u"]'}
QUIET_NAN, OTHER_NAN = 0x7FF8000000000000, 0xFFF8000000000123


def sample(n_rows: int = 500, names: tuple[str, ...] = NAMES) -> Result:
    """Numbers of all magnitudes, hard to print, with the special ones in front."""
    bits = np.random.default_rng(7).integers(0, 2**64, (n_rows, len(names)), dtype=np.uint64)
    rows = bits.view(np.float64)
    rows[~np.isfinite(rows)] = 1.0
    special = [np.nan, np.inf, -np.inf, -0.0, np.nextafter(0, 1), np.finfo(float).max, 0.1, 2.0**53 + 2, 3.0]
    rows.reshape(-1)[: len(special)] = special[: rows.size]
    return Result(np.arange(n_rows) * 1e-4, names, rows)


def described(result: Result) -> Result:
    """The same with everything that Parquet keeps."""
    ticks = {"steps_per_tick": {"controller": 2, "sensor": 1}, "sample_times": {"controller": 2e-4, "sensor": 1e-4}}
    return replace(result, units=UNITS, metadata=METADATA, **ticks)


def assert_same_values(a: Result, b: Result) -> None:
    assert a.names == b.names
    assert a.time.tobytes() == b.time.tobytes()
    assert a.rows.shape == b.rows.shape
    assert a.rows.tobytes() == b.rows.tobytes()


def stream(sink: ParquetSink, result: Result, length: int, stop: BaseException | None = None) -> None:
    """Append the rows of a result, `length` at a time, and then stop."""
    with sink:
        for first in range(0, len(result.time), length):
            sink.append(result.time[first : first + length], result.rows[first : first + length])
            assert sink.written is None
        if stop is not None:
            raise stop


def files(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())
