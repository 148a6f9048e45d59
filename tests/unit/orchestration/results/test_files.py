"""Tests of files of results: no bit is lost, other tools can read the files, and each file is complete or absent."""

import csv
import os
import subprocess
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path

import fmpy.util
import numpy as np
import pyarrow.parquet as pq
import pytest

from orchestration import OrchestrationError, Result
from orchestration.results import arrow_table, csv_file
from orchestration.results.parquet_file import ParquetSink
from tests.unit.orchestration.stored import (
    METADATA,
    NAMES,
    ODD,
    OTHER_NAN,
    QUIET_NAN,
    UNITS,
    assert_same_values,
    described,
    files,
    sample,
    stream,
)


@pytest.mark.parametrize("n_rows", [0, 1, 500])
@pytest.mark.parametrize("names", [NAMES, ODD, ()])
@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".CSV"])
def test_values_come_back_bitwise(tmp_path: Path, n_rows: int, names: tuple[str, ...], suffix: str) -> None:
    result = sample(n_rows, names)
    path = tmp_path / "new" / f"result{suffix}"
    result.write(path)
    assert_same_values(Result.read(path), result)
    assert files(path.parent) == [path.name]


@pytest.mark.parametrize("length", [100, 128, 500])
def test_csv_is_the_same_in_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, length: int) -> None:
    result = sample()
    result.write_csv(tmp_path / "whole.csv")
    monkeypatch.setattr(arrow_table, "ROW_GROUP_BYTES", length * 8 * (len(NAMES) + 1))
    result.write_csv(tmp_path / "parts.csv")
    assert (tmp_path / "parts.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_csv_is_read_in_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = sample(500, ODD)
    result.write_csv(tmp_path / "x.csv")
    monkeypatch.setattr(csv_file, "CSV_BLOCK_BYTES", 2**11)
    assert_same_values(Result.read(tmp_path / "x.csv"), result)


def test_whole_numbers_stay_floats_in_csv_with_a_mark_of_byte_order(tmp_path: Path) -> None:
    result = Result(np.array([-0.0, 1.0]), ("straße.φ",), np.array([[1.0], [-0.0]]))
    result.write_csv(tmp_path / "x.csv")
    assert_same_values(Result.read(tmp_path / "x.csv"), result)  # -0 is lost where a column is taken for integers
    (tmp_path / "y.csv").write_bytes(b"\xef\xbb\xbf" + (tmp_path / "x.csv").read_bytes())  # as spreadsheets do
    assert_same_values(Result.read(tmp_path / "y.csv"), result)


def test_numbers_that_another_tool_quotes_stay_numbers(tmp_path: Path) -> None:
    """As pandas writes a table with csv.QUOTE_ALL."""
    result = sample(20)
    with (tmp_path / "x.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, quoting=csv.QUOTE_ALL)
        writer.writerow(["time", *NAMES])
        writer.writerows(
            [repr(float(t)), *map(repr, row.tolist())] for t, row in zip(result.time, result.rows, strict=True)
        )
    back = Result.read(tmp_path / "x.csv")
    assert back.texts == {}
    assert_same_values(back, result)


def test_parquet_keeps_what_describes_the_values(tmp_path: Path) -> None:
    result = described(sample())
    result.write_parquet(str(tmp_path / "x.parquet"))
    back = Result.read(str(tmp_path / "x.parquet"))
    assert back.units == result.units
    assert back.steps_per_tick == result.steps_per_tick
    assert back.sample_times == result.sample_times
    assert back.metadata == result.metadata
    np.testing.assert_array_equal(back.at_ticks("controller.p_hat[6]"), result["controller.p_hat[6]"][1::2])


def test_parquet_keeps_the_bits_of_nan(tmp_path: Path) -> None:
    bits = np.array([[QUIET_NAN], [OTHER_NAN], [0], [1 << 63]] * 9, np.uint64)
    Result(np.arange(36.0), ("a.y",), bits.view(float)).write_parquet(tmp_path / "x.parquet")
    assert Result.read(tmp_path / "x.parquet").rows.tobytes() == bits.tobytes()


def test_other_tools_find_units_and_metadata_in_parquet(tmp_path: Path) -> None:
    described(sample()).write_parquet(tmp_path / "x.parquet")
    schema = pq.read_table(tmp_path / "x.parquet").schema
    assert schema.names == ["time", *NAMES]
    assert [str(kind) for kind in schema.types] == ["double"] * 4
    assert [field.metadata[b"unit"] for field in schema] == [b"s", b"m", b"kg.m2", b""]
    for found in (schema.metadata, pq.read_metadata(tmp_path / "x.parquet").metadata):
        assert found[b"adaptimp.system"].decode() == METADATA["system"]
        assert (
            found[b"adaptimp.units"]
            == b'{"plant.x[1]": "m", "controller.p_hat[6]": "kg.m2", "actuator.saturated[1]": ""}'
        )
        assert found[b"adaptimp.steps_per_tick"] == b'{"controller": 2, "sensor": 1}'


def test_parquet_of_other_tools_is_read(tmp_path: Path) -> None:
    import pyarrow as pa

    fields = [pa.field("time", pa.float64()), pa.field("a.n", pa.int32(), metadata={"unit": "m"})]
    table = pa.table([[0.0, 0.5], [1, -2]], schema=pa.schema(fields))
    pq.write_table(table, tmp_path / "x.parquet")
    back = Result.read(tmp_path / "x.parquet")
    np.testing.assert_array_equal(back["a.n"], [1.0, -2.0])
    assert back.units["a.n"] == "m"


def test_fmpy_reads_our_csv(tmp_path: Path) -> None:
    result = sample()
    result.write_csv(tmp_path / "x.csv")
    table = fmpy.util.read_csv(tmp_path / "x.csv")
    assert table.dtype.names == ("time", *NAMES)
    assert table["time"].tobytes() == result.time.tobytes()
    for name in NAMES:
        assert table[name].tobytes() == result[name].tobytes()


def test_we_read_csv_of_fmpy_and_write_the_same_names(tmp_path: Path) -> None:
    result = sample()
    columns = [("time", float), *((name, float) for name in NAMES)]
    table = np.array([(t, *row) for t, row in zip(result.time, result.rows, strict=True)], columns)
    fmpy.util.write_csv(tmp_path / "theirs.csv", table)
    result.write_csv(tmp_path / "ours.csv")
    assert_same_values(Result.read(tmp_path / "theirs.csv"), result)
    headers = [(tmp_path / name).read_text().splitlines()[0] for name in ("theirs.csv", "ours.csv")]
    assert headers[0] == headers[1] == '"time","plant.x[1]","controller.p_hat[6]","actuator.saturated[1]"'


def test_numpy_reads_our_csv(tmp_path: Path) -> None:
    result = sample()
    result.write_csv(tmp_path / "x.csv")
    table = np.genfromtxt(tmp_path / "x.csv", delimiter=",", names=True, deletechars="")
    assert table.dtype.names == ("time", *NAMES)
    for name in NAMES:
        assert table[name].tobytes() == result[name].tobytes()


def test_odd_names_are_those_of_rfc_4180(tmp_path: Path) -> None:
    result = sample(3, ODD)
    result.write_csv(tmp_path / "x.csv")
    with (tmp_path / "x.csv").open(newline="", encoding="utf-8") as file:
        header, *lines = csv.reader(file)
    assert header == ["time", *ODD]
    assert np.array(lines, float)[:, 1:].tobytes() == result.rows.tobytes()


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_same_result_same_bytes_in_any_process(tmp_path: Path, suffix: str) -> None:
    code = (
        "import sys; from pathlib import Path\n"
        "from tests.unit.orchestration.results.test_files import described, sample\n"
        "described(sample()).write(Path(sys.argv[1]))\n"
    )
    described(sample()).write(tmp_path / f"here{suffix}")
    environment = {**os.environ, "PYTHONHASHSEED": "1", "TZ": "Asia/Tokyo"}
    there = tmp_path / "elsewhere" / f"there{suffix}"
    subprocess.run([sys.executable, "-c", code, there], check=True, env=environment)
    assert there.read_bytes() == (tmp_path / f"here{suffix}").read_bytes()


def test_order_of_metadata_does_not_matter(tmp_path: Path) -> None:
    result = described(sample())
    result.write_parquet(tmp_path / "1.parquet")
    replace(result, metadata=dict(reversed(METADATA.items()))).write_parquet(tmp_path / "2.parquet")
    assert (tmp_path / "1.parquet").read_bytes() == (tmp_path / "2.parquet").read_bytes()


@pytest.mark.parametrize("length", [1, 63, 64, 65, 200, 500])
def test_a_stream_gives_the_bytes_of_the_whole(tmp_path: Path, small_groups: int, length: int) -> None:
    result = described(sample())
    result.write_parquet(tmp_path / "whole.parquet")
    ticks = {"steps_per_tick": result.steps_per_tick, "sample_times": result.sample_times}
    with ParquetSink(tmp_path / "s.parquet", NAMES, UNITS, **ticks) as sink:
        for first in range(0, 500, length):
            sink.append(result.time[first : first + length], result.rows[first : first + length])
            assert not sink.path.exists()
        sink.metadata.update(METADATA)  # known only at the end
    assert (sink.count, sink.written) == (500, tmp_path / "s.parquet")
    assert sink.path.read_bytes() == (tmp_path / "whole.parquet").read_bytes()
    assert pq.read_metadata(sink.path).num_row_groups == -(-500 // small_groups)
    assert files(tmp_path) == ["s.parquet", "whole.parquet"]


def test_a_sink_holds_one_row_group(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arrow_table, "ROW_GROUP_BYTES", 2**18)
    result = sample(2000)
    tracemalloc.start()  # traces numpy's arrays
    with ParquetSink(tmp_path / "x.parquet", NAMES) as sink:
        for _ in range(40):  # 2.6 MB
            sink.append(result.time, result.rows)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert next(tmp_path.glob("x.parquet.*.part")).stat().st_size > 2**18  # repeated rows compress, but not so far
    assert peak < 2**19  # the buffer, and as much again


@pytest.mark.parametrize("stop", [KeyboardInterrupt(), ValueError("diverged")])
@pytest.mark.parametrize("n_rows", [1, 64, 130])
@pytest.mark.usefixtures("small_groups")
def test_an_exception_keeps_the_rows_apart(tmp_path: Path, stop: BaseException, n_rows: int) -> None:
    result = described(sample(n_rows))
    (tmp_path / "x.parquet").write_text("old")
    sink = ParquetSink(tmp_path / "x.parquet", NAMES, UNITS, METADATA, steps_per_tick=result.steps_per_tick)
    with pytest.raises(type(stop)) as caught:
        stream(sink, result, 1, stop)
    assert caught.value is stop
    assert sink.written == tmp_path / "x.partial.parquet"
    back = Result.read(tmp_path / "x.partial.parquet")
    assert_same_values(back, result)
    assert (back.units, back.metadata, back.steps_per_tick) == (UNITS, METADATA, result.steps_per_tick)
    status = "interrupted" if isinstance(stop, KeyboardInterrupt) else "failed"
    assert (back.status, back.message) == (status, str(stop))
    assert files(tmp_path) == ["x.parquet", "x.partial.parquet"]
    assert (tmp_path / "x.parquet").read_text() == "old"


def test_an_exception_before_the_first_row_leaves_nothing(tmp_path: Path) -> None:
    sink = ParquetSink(tmp_path / "x.parquet", NAMES)
    with pytest.raises(ValueError, match="too early"):
        stream(sink, sample(0), 1, ValueError("too early"))
    assert sink.written is None
    assert files(tmp_path) == []


@pytest.mark.parametrize(
    "metadata", [{"units": "SI"}, {"steps_per_tick": "1"}, {"sample_times": "1"}, {"status": "x"}, {"step": 1e-4}]
)
def test_metadata_that_cannot_be_kept_is_refused(tmp_path: Path, metadata: dict[str, str]) -> None:
    result = replace(sample(), metadata=metadata)
    keys = "units, steps_per_tick, sample_times, status, message"
    message = rf"x\.parquet: metadata '\w+' = .*: a text is needed, under another key than {keys}\.$"
    with pytest.raises(OrchestrationError, match=message):
        result.write_parquet(tmp_path / "x.parquet")
    assert files(tmp_path) == []
    sink = ParquetSink(tmp_path / "x.parquet", NAMES, UNITS)
    sink.metadata.update(metadata)
    with pytest.raises(OrchestrationError, match=message):
        stream(sink, result, 100)  # too late to lose the rows for it
    assert files(tmp_path) == ["x.partial.parquet"]
    assert Result.read(tmp_path / "x.partial.parquet").units == UNITS


def test_rows_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    message = r"times of shape \(2,\) and rows of shape \(2, 4\) were given; \(n,\) and \(n, 3\) are needed\.$"
    with pytest.raises(OrchestrationError, match=message), ParquetSink(tmp_path / "x.parquet", NAMES) as sink:
        sink.append(np.zeros(2), np.zeros((2, 4)))
    assert files(tmp_path) == []


def test_a_sink_that_is_not_open_takes_no_rows(tmp_path: Path) -> None:
    sink = ParquetSink(tmp_path / "x.parquet", NAMES)
    for _ in range(2):
        with pytest.raises(OrchestrationError, match=r"x\.parquet: rows can be appended only within"):
            sink.append(np.zeros(1), np.zeros((1, 3)))
        if sink.written is None:
            with sink:
                pass


@pytest.mark.parametrize("name", ["x.xlsx", "x", "x.csv.gz"])
def test_another_suffix_is_refused(tmp_path: Path, name: str) -> None:
    suffix = Path(name).suffix or "a file without a suffix"
    with pytest.raises(OrchestrationError, match=rf"results are written as \.csv or \.parquet, not as {suffix}\.$"):
        sample().write(tmp_path / name)
    with pytest.raises(OrchestrationError, match=rf"results are read as \.csv or \.parquet, not as {suffix}\.$"):
        Result.read(tmp_path / name)
    assert files(tmp_path) == []


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_places_that_cannot_be_written(tmp_path: Path, suffix: str) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / f"taken{suffix}").mkdir()
    for place in (f"file/x{suffix}", f"taken{suffix}"):
        with pytest.raises(OrchestrationError, match=rf"{place}: the result cannot be written: \w[\w ]+; choose"):
            sample().write(tmp_path / place)
    assert files(tmp_path) == ["file", f"taken{suffix}"]


def test_a_sink_sees_a_folder_in_its_place_before_the_run(tmp_path: Path) -> None:
    (tmp_path / "x.parquet").mkdir()
    sink = ParquetSink(tmp_path / "x.parquet", NAMES)
    with pytest.raises(OrchestrationError, match=r"x\.parquet: the result cannot be written: Is a directory; choose"):
        sink.__enter__()
    assert files(tmp_path) == ["x.parquet"]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("x.csv", None, r"x\.csv: there is no such file of a result; its folder has no \.csv file\.$"),
        ("x.parquet", None, r"x\.parquet: there is no such file of a result; its folder has no \.parquet file\.$"),
        (
            "x.csv",
            b"",
            r"x\.csv does not hold a result: Empty CSV file; a CSV file with time",
        ),
        (
            "x.csv",
            b"t,y\n1,2\n",
            r"x\.csv does not hold a result: its first column is t, not time; a CSV file",
        ),
        ("x.csv", b"time,y\n1,on\n", r"x\.csv does not hold a result: .*invalid value 'on'; a CSV file"),
        ("x.csv", b"time,y\n1,\n", r"x\.csv does not hold a result: .*invalid value ''; a CSV file"),
        ("x.csv", b"time,y\n1\n", r"x\.csv does not hold a result: .*Expected 2 columns, got 1.*\.$"),
        ("x.csv", b"time,\xff\n1,2\n", r"x\.csv does not hold a result: .*\.$"),
        ("x.parquet", b"PAR1", r"x\.parquet does not hold a result: .*\.$"),
        ("x.parquet", b"time\n1\n" * 9, r"x\.parquet does not hold a result: .*\.$"),
    ],
)
def test_a_file_without_a_result_is_refused(tmp_path: Path, name: str, content: bytes | None, message: str) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(OrchestrationError, match=message) as caught:
        Result.read(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_cells_without_a_value_are_refused(tmp_path: Path) -> None:
    import pyarrow as pa

    pq.write_table(pa.table({"time": [0.0, 1.0], "a.y": [None, 1.0]}), tmp_path / "x.parquet")
    with pytest.raises(
        OrchestrationError,
        match=r"result: column a\.y has 1 cells without a value; a Parquet file",
    ):
        Result.read(tmp_path / "x.parquet")


def test_importing_the_module_loads_no_arrow() -> None:
    code = "import sys, orchestration.results.result; print('pyarrow' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "False\n"
