"""Strings of FMUs: connected by every algorithm, and recorded in every form of a result."""

import signal
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from orchestration import (
    Options,
    OrchestrationError,
    Result,
    RunInterrupted,
    SimulationError,
    Snapshot,
    System,
    compare,
    prepare,
    simulate,
    stream,
)
from orchestration.master.texts import FIRST_LIMIT, TextTable
from tests.faults.cli import Command, runner
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import COUNT, HEARS, SAYS, U, Y

UNKNOWN = '<Unknown index="{}" dependencies=""/>'
STATES = 'canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
ALGORITHMS = ["gauss-seidel", "jacobi", "iterative", "newton", "adaptive"]


@pytest.fixture
def pair(stranger: Stranger) -> System:
    """A speaker, which says the time, and a listener, which shows what it hears with a mark, and its length as y."""
    speaker = stranger("speaks", [SAYS], outputs=UNKNOWN.format(1), flags=STATES, name="speaker")
    outputs = '<Unknown index="1" dependencies="3"/><Unknown index="2" dependencies="3"/>'
    listener = stranger("text", [Y, SAYS, HEARS], outputs=outputs, flags=STATES, name="listener")
    return System.of({"a": speaker, "b": listener}).connect("a.says -> b.hears")


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command line."""
    return runner(monkeypatch, capsys)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_texts_move_with_every_algorithm(pair: System, algorithm: str) -> None:
    result = simulate(pair, 0.5, 0.1, algorithm)
    said = [f"t = {t:g} s" for t in result.time]
    assert result["a.says"].tolist() == said
    heard = said if algorithm != "jacobi" else [said[0], *said[:-1]]  # a parallel exchange is a step late
    assert result["b.says"].tolist() == [f"{text}!" for text in heard]
    assert result["b.y"].tolist() == [len(text) for text in heard]


def test_a_run_without_connections_records_them(stranger: Stranger) -> None:
    system = System.of({"m": stranger("speaks", [SAYS], outputs=UNKNOWN.format(1))})
    result = simulate(system, 0.2, 0.1)
    assert (list(result), len(result), result.rows.shape) == (["m.says"], 1, (3, 0))
    assert result["m.says"].tolist() == ["t = 0 s", "t = 0.1 s", "t = 0.2 s"]


def test_inputs_and_parameters_are_recorded_too(pair: System) -> None:
    result = simulate(pair, 0.2, 0.1, record=["b.hears", "a.says"])
    assert list(result) == ["b.hears", "a.says"]
    assert result["b.hears"].tolist() == result["a.says"].tolist()


@pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning")
def test_integers_and_texts_of_a_component_keep_apart(stranger: Stranger) -> None:
    """Both have the same value references; the FMU copies Integer 0 to 1, and text 0 with a mark to 1."""
    variables = [
        COUNT.format(1, "output", ""),
        SAYS,
        COUNT.format(0, "input", ' start="7"').replace('"n"', '"i"'),
        HEARS,
    ]
    outputs = '<Unknown index="1" dependencies="3"/><Unknown index="2" dependencies="4"/>'
    one = stranger("text and choice", variables, outputs=outputs)
    system = System.of({"a": one, "b": one}).connect("a.n -> b.i", "a.says -> b.hears")
    result = simulate(system.set({"a.i": 5, "a.hears": "x"}), 0.2, 0.1)
    assert (result["b.n"].tolist(), result["b.says"].tolist()) == ([5.0] * 3, ["x!!"] * 3)


@pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning")
def test_a_text_that_starts_and_changes(pair: System) -> None:
    free = System("s", pair.components)
    assert free["b"]["hears"] == "abc"
    assert free.unconnected_inputs() == ["b.hears"]
    assert simulate(free, 0.2, 0.1)["b.says"].tolist() == ["abc!"] * 3
    result = simulate(free.set({"b.hears": "x"}), 0.3, 0.1, changes={0.1: {"b.hears": "größer"}})
    assert result["b.says"].tolist() == ["x!", "x!", "größer!", "größer!"]


def test_inputs_of_equal_names_are_connected(stranger: Stranger) -> None:
    speaker = stranger("speaks", [SAYS], outputs=UNKNOWN.format(1), name="speaker")
    listener = stranger("text", [Y, HEARS.replace('"hears"', '"says"')], outputs=UNKNOWN.format(1), name="listener")
    system = System.of({"a": speaker, "b": listener}).connect()
    assert [str(c) for c in system.connections] == ["a.says -> b.says"]


def test_a_text_does_not_drive_a_number(stranger: Stranger, pair: System) -> None:
    number = stranger("feedthrough", [U, Y], outputs='<Unknown index="2" dependencies="1"/>', name="number")
    system = System.of({"a": pair["a"], "m": number})
    with pytest.raises(OrchestrationError, match="types String and Real differ"):
        system.connect("a.says -> m.u")


def test_files_keep_texts(pair: System, tmp_path: Path) -> None:
    free = System("s", pair.components, pair.connections)
    result = simulate(free, 0.3, 0.1)
    for name in ("x.csv", "x.parquet"):
        result.write(tmp_path / name)
        read = Result.read(tmp_path / name)
        assert (read.names, list(read.texts)) == (("b.y",), ["a.says", "b.says"])
        assert compare(result, read).identical
    assert Result.read(tmp_path / "x.parquet") == result
    head, first, *_ = (tmp_path / "x.csv").read_text().splitlines()
    assert (head, first) == ('"time","b.y","a.says","b.says"', '0,7,"t = 0 s","t = 0 s!"')


@pytest.mark.parametrize("text", ["", "1.5", 'a "quoted" text', "with, comma", "two\nlines", "größer", "'=1+1"])
def test_files_keep_every_text(text: str, tmp_path: Path) -> None:
    texts = {"m.s": np.array([text, "other"], object)}
    result = Result(np.array([0.0, 1.0]), (), np.empty((2, 0)), texts=texts)
    for name in ("x.csv", "x.parquet"):
        result.write(tmp_path / name)
        assert Result.read(tmp_path / name)["m.s"].tolist() == [text, "other"]


def test_a_streamed_file_has_the_same_bytes(pair: System, tmp_path: Path) -> None:
    assert stream(tmp_path / "streamed.parquet", pair, 0.3, 0.1) == 4
    simulate(pair, 0.3, 0.1).write(tmp_path / "written.parquet")
    assert (tmp_path / "streamed.parquet").read_bytes() == (tmp_path / "written.parquet").read_bytes()


def test_other_libraries_get_texts(pair: System) -> None:
    result = simulate(pair, 0.1, 0.1)
    assert result.to_pandas()["a.says"].tolist() == ["t = 0 s", "t = 0.1 s"]
    assert result.to_xarray()["a.says"].values.tolist() == ["t = 0 s", "t = 0.1 s"]
    assert "last: t = 0.1 s" in result._repr_html_()
    with pytest.raises(OrchestrationError, match=r"a\.says is a column of texts, which cannot be drawn"):
        result.plot("a.says")


def test_an_array_of_texts_is_one() -> None:
    columns = {f"m.s[{i}]": np.array([f"{i}a", f"{i}b"], object) for i in (1, 2)}
    result = Result(np.array([0.0, 1.0]), (), np.empty((2, 0)), texts=columns)
    assert result["m.s"].tolist() == [["1a", "2a"], ["1b", "2b"]]
    assert result.to_xarray()["m.s"].dims == ("time", "m.s_1")


def test_texts_are_compared(pair: System) -> None:
    first = simulate(pair, 0.3, 0.1)
    other = {**first.texts, "a.says": np.array(["t = 0 s", "?", "t = 0.2 s", "t = 0.3 s"], object)}
    second = Result(first.time, first.names, first.rows, first.units, texts=other)
    worst = compare(first, second).worst
    assert (worst.name, worst.largest, worst.first) == ("a.says", np.inf, 0.1)
    assert not first == second
    assert compare(first, Result(first.time, first.names, first.rows)).only_in_first == ("a.says", "b.says")


def test_a_run_that_is_taken_back_has_its_texts(pair: System, tmp_path: Path) -> None:
    whole = simulate(pair, 0.5, 0.1)
    with prepare(pair, 0.5, 0.1) as run:
        run.run(until=0.2)
        path = run.save().write(tmp_path / "half.snapshot")
        run.run()
        assert run.result() == whole
    with prepare(pair, 0.5, 0.1) as run:
        run.restore(Snapshot.read(path))
        assert run.result()["a.says"].tolist() == whole["a.says"].tolist()[:3]
        run.run()
        assert run.result() == whole


FORGED: dict[str, Callable[[dict[str, np.ndarray]], object]] = {
    "it has no array text_numbers": lambda arrays: arrays.pop("text_numbers"),
    "it has no array text_bytes": lambda arrays: arrays.pop("text_bytes"),
    "array text_lengths has shape": lambda arrays: arrays.update(text_lengths=arrays["text_lengths"][None]),
    "array text_numbers has .* type float64": lambda arrays: arrays.update(text_numbers=np.zeros(1)),
    r"\d+ texts, 1 lengths of texts": lambda arrays: arrays.update(text_lengths=arrays["text_lengths"][:1]),
    r"\d+ texts, \d+ lengths of texts and 3 bytes": lambda arrays: arrays.update(text_bytes=arrays["text_bytes"][:3]),
    "two of its texts have the same number": lambda arrays: arrays["text_numbers"].fill(0),
    "its texts have the numbers -7 to": lambda arrays: arrays["text_numbers"].put(-1, -7),
    "to 9223372036854775807": lambda arrays: arrays["text_numbers"].put(-1, 2**63 - 1),
    "number 0 is not the empty one": lambda arrays: arrays["text_numbers"].__iadd__(1),
    "array discretes has the number 99 for a text": lambda arrays: arrays["discretes"].fill(99),
    "array discretes has the number -1 for a text": lambda arrays: arrays["discretes"].fill(-1),
    "array rows has the number 0.5 for a text": lambda arrays: arrays["rows"].fill(0.5),
    "array rows has the number nan for a text": lambda arrays: arrays["rows"].fill(np.nan),
}


@pytest.mark.parametrize("said", FORGED)
def test_a_snapshot_with_texts_that_somebody_made_up_is_refused(pair: System, tmp_path: Path, said: str) -> None:
    whole = simulate(pair, 0.5, 0.1)
    with prepare(pair, 0.5, 0.1) as run:
        run.run(until=0.2)
        snapshot = Snapshot.read(run.save().write(tmp_path / "half.snapshot"))
        FORGED[said](snapshot.arrays)
        forged = Snapshot.read(snapshot.write(tmp_path / "forged.snapshot"))  # with the right hash
        with pytest.raises(OrchestrationError, match=rf"^The snapshot does not fit the run: .*{said}"):
            run.restore(forged)
        run.run()  # the run goes on from where it was
        assert run.result() == whole


def test_a_large_number_of_a_text_takes_no_memory() -> None:
    table, rich = TextTable(), TextTable()
    rich.number(b"a")
    arrays = rich.save()
    arrays["text_numbers"][1] = 2**31 - 1
    table.restore(arrays)
    assert (table.text(2**31 - 1), table.number(b"a"), table.number(b"b"), len(table)) == (b"a", 2**31 - 1, 1, 3)


def test_memory_is_bounded_while_texts_change(stranger: Stranger) -> None:
    """Each step has another text; those that nobody uses are forgotten, though the connection goes on."""
    speaker = stranger("speaks", [SAYS], outputs=UNKNOWN.format(1), name="speaker")
    listener = stranger("text", [Y, HEARS], outputs=UNKNOWN.format(1), name="listener")
    system = System.of({"a": speaker, "b": listener}).connect("a.says -> b.hears")
    steps = 3 * FIRST_LIMIT
    with prepare(system, steps * 1e-3, 1e-3) as run:
        most = 0
        for k in range(1, 13):
            run.run(until=k * steps // 12 * 1e-3)
            most = max(most, len(run._assembly.texts.table))
        kept = len(run._assembly.texts.table)
    assert kept == most > FIRST_LIMIT  # they are recorded, so all of them stay
    with prepare(system, steps * 1e-3, 1e-3, options=Options(record="b.y")) as run:
        for k in range(1, 13):
            run.run(until=k * steps // 12 * 1e-3)
        assert len(run._assembly.texts.table) <= 2 * FIRST_LIMIT


def test_numbers_of_texts() -> None:
    table = TextTable()
    assert [table.number(text) for text in (b"", b"a", b"b", b"a")] == [0, 1, 2, 1]
    assert table.decoded(np.array([2.0, 1.0, 0.0, 2.0])).tolist() == ["b", "a", "", "b"]
    assert table.decoded(np.empty(0)).tolist() == []
    assert table.decoded(np.array([table.number(b"\xff")])).tolist() == ["\ufffd"]
    for k in range(FIRST_LIMIT):
        table.number(str(k).encode())
    table.forget(lambda: [np.array([2])])
    assert (len(table), table.text(2)) == (2, b"b")
    assert table.number(b"new") <= FIRST_LIMIT + 4  # a number that was in use before


def test_a_failure_names_the_call_for_texts(stranger: Stranger) -> None:
    mute = SAYS.replace('valueReference="1"', 'valueReference="99"')
    system = System.of({"m": stranger("text", [mute], outputs=UNKNOWN.format(1))})
    with pytest.raises(SimulationError, match=r"m: fmi2GetString returned fmi2Error"):
        simulate(system, 0.2, 0.1)


def test_an_interrupt_is_not_lost(pair: System) -> None:
    """The interrupt may come while Python translates texts for the loop; the rows are complete nevertheless."""
    timer = threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT))
    with prepare(pair, 1e4, 1e-3, options=Options(record="b.y")) as run:
        timer.start()
        with pytest.raises(RunInterrupted) as interrupted:
            run.run()
        result = interrupted.value.result
    assert isinstance(result, Result)
    assert len(result["b.y"]) == len(result.time) == run.count


def test_packages_keep_connections_of_texts(pair: System, tmp_path: Path) -> None:
    package = pair.write(tmp_path / "s.ssp")
    assert [str(c) for c in System.read(package).connections] == ["a.says -> b.hears"]
    assert simulate(package, 0.3, 0.1)["b.says"].tolist() == simulate(pair, 0.3, 0.1)["b.says"].tolist()


def test_the_command_line_shows_the_last_text(pair: System, adaptimp: Command, tmp_path: Path) -> None:
    package = pair.write(tmp_path / "s.ssp")
    outcome = adaptimp("run", package, "--step", "0.1", "--stop", "0.3", "--record", "b.hears,a.says")
    assert (outcome.code, outcome.err) == (0, "")
    assert [line.split(maxsplit=1) for line in outcome.out.splitlines() if line.startswith("b.")] == [
        ["b.hears", "t = 0.3 s"]
    ]
    out = tmp_path / "x.csv"
    outcome = adaptimp("run", package, "--step", "0.1", "--stop", "0.3", "--out", out)
    assert "4 rows, 3 columns" in outcome.out
    assert Result.read(out)["b.says"].tolist()[-1] == "t = 0.3 s!"
