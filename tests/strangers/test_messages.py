"""What FMUs log: the messages of the call that failed, and all others with the result."""

import json
import warnings
from pathlib import Path

import pytest

from orchestration import Fmu, FmuWarning, Result, SimulationError, System, prepare, simulate, stream
from orchestration.fmi.logging import FIRST_SHOWN, LAST_SHOWN, Message, Messages
from tests.faults.cli import Command, runner
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import P, U, Y

ALONE, DEPENDS = '<Unknown index="1" dependencies=""/>', '<Unknown index="2" dependencies="1"/>'
STATES = 'canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true"'
ALGORITHMS = ["gauss-seidel", "jacobi", "iterative", "newton", "adaptive"]


def storm(stranger: Stranger, count: int) -> System:
    """A component that logs that many messages in each step, and fails after 0.2 s."""
    system = System.of({"m": stranger("storm", [Y, P], outputs=ALONE, flags=STATES)})
    return system.set({"m.p": count})


def failure(system: System, algorithm: str = "gauss-seidel", step: float = 0.1) -> str:
    """The sentence of a run that fails."""
    with pytest.raises(SimulationError) as failed:
        simulate(system, 1.0, step, algorithm)
    return str(failed.value)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("step", [0.1, 1e-3], ids=["at once", "after many calls"])
def test_the_messages_of_the_failing_call_are_shown(stranger: Stranger, algorithm: str, step: float) -> None:
    said = failure(storm(stranger, 3), algorithm, step)
    expected = '"100 % even at t = 0 s", "odd at t = 1 s", "100 % even at t = 2 s"'
    assert f"its 3 messages: {expected}." in said


def test_many_messages_are_shown_in_part(stranger: Stranger) -> None:
    said = failure(storm(stranger, 1000))
    assert "; its 1000 messages: " in said
    assert said.count("odd at") + said.count("even at") == FIRST_SHOWN + LAST_SHOWN
    assert '"odd at t = 19 s", 960 more, "100 % even at t = 980 s"' in said


def test_messages_from_threads_are_shown(stranger: Stranger) -> None:
    system = System.of({"m": stranger("from threads", [Y], outputs=ALONE)})
    assert 'its 3 messages: "a thread at t = 0.3 s", "a thread at t = 0.3 s", "a thread' in failure(system)


def test_a_silent_call_is_told_from_earlier_ones() -> None:
    messages = Messages()
    assert messages.last() == "it logged nothing"
    messages.begin_call()
    messages.append("ready")
    assert messages.last() == 'its last message: "ready"'
    messages.begin_call()
    assert messages.last() == 'it logged nothing then, and before: "ready"'


def test_one_fmu_alone_shows_them_too(stranger: Stranger) -> None:
    with Fmu(stranger("storm", [Y, P], outputs=ALONE), p=2.0) as fmu:
        for _ in range(3):
            fmu.step(0.1)
        with pytest.raises(SimulationError, match=r'its 2 messages: "100 % even at t = 0 s", "odd at t = 1 s"'):
            fmu.step(0.1)
        assert len(fmu.messages) == 8


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_following_the_calls_changes_no_number(stranger: Stranger, algorithm: str) -> None:
    """The FMU logs in each step, and has inputs, outputs and states."""
    talks = stranger("integrates and talks", [U, Y], outputs=DEPENDS, flags=STATES, name="talks")
    silent = stranger("integrates", [U, Y], outputs=DEPENDS, flags=STATES, name="silent")
    results = []
    for path in (talks, silent):
        system = System.of({"a": path, "b": path}).connect("a.y -> b.u", "b.y -> a.u")
        results.append(simulate(system, 0.5, 0.01, algorithm))
    assert results[0]["b.y"].tobytes() == results[1]["b.y"].tobytes()
    assert len(results[0].messages) >= 100
    assert results[1].messages == ()


@pytest.fixture
def warning(stranger: Stranger) -> System:
    """A component that warns in each step."""
    return System.of({"m": stranger("warns", [Y], outputs=ALONE)})


def test_a_warning_is_said_once(warning: System) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with prepare(warning, 1.0, 0.1) as run:
            run.run(until=0.5)
            run.run()
            result = run.result()
    found = [str(w.message) for w in caught if issubclass(w.category, FmuWarning)]
    assert {w.filename for w in caught} == {__file__}
    assert len(found) == 1
    assert found[0].startswith('m logged fmi2Warning: "nearly empty at t = 0 s" and 4 more; result.messages')
    assert result.messages[0] == "m: fmi2Warning: nearly empty at t = 0 s"
    assert len(result.messages) == 10


@pytest.mark.filterwarnings("ignore::orchestration.FmuWarning")
def test_files_keep_messages(warning: System, tmp_path: Path) -> None:
    stream(tmp_path / "x.parquet", warning, 0.2, 0.1)
    assert Result.read(tmp_path / "x.parquet").messages == (
        "m: fmi2Warning: nearly empty at t = 0 s",
        "m: fmi2Warning: nearly empty at t = 0.1 s",
    )


def test_the_last_messages_are_kept(stranger: Stranger) -> None:
    with pytest.raises(SimulationError) as failed:
        simulate(storm(stranger, 1000), 1.0, 0.1)
    assert isinstance(failed.value.result, Result)
    first, *others = failed.value.result.messages
    assert first == "m: 3900 earlier messages are not kept."
    assert (len(others), others[-1]) == (100, "m: odd at t = 999 s")


def test_the_command_line_shows_them_if_asked(
    warning: System, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    adaptimp: Command = runner(monkeypatch, capsys)
    asked = ("run", warning.write(tmp_path / "s.ssp"), "--step", "0.1", "--stop", "0.2", "--no-verdict")
    plain, verbose = adaptimp(*asked), adaptimp(*asked, "--verbose")
    assert plain.err.count("nearly empty") == 1
    assert plain.err.startswith("Warning: m logged fmi2Warning")
    assert "m: fmi2Warning: nearly empty at t = 0.1 s\n" in verbose.err
    assert json.loads(adaptimp(*asked, "--json").out)["messages"] == [
        "m: fmi2Warning: nearly empty at t = 0 s",
        "m: fmi2Warning: nearly empty at t = 0.1 s",
    ]


def test_a_message_has_its_status() -> None:
    assert (Message("full", 1), str(Message("full", 1)), str(Message("full"))) == ("full", "fmi2Warning: full", "full")
