"""Compilation of the loop: it is over when a run's context is entered, and makes no step."""

import signal
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from numba import typeof

from orchestration import System, prepare
from orchestration.cli.interrupts import Interrupts, signal_of
from orchestration.master.compilation import compile_loop
from orchestration.master.kernel import fixed_step, step_control
from orchestration.master.kernel.compiled import compilations
from orchestration.sandbox.interrupts import SIGNALS

LOOPS = {"gauss-seidel": fixed_step, "jacobi": fixed_step, "newton": step_control, "adaptive": step_control}


@pytest.mark.parametrize("algorithm", LOOPS)
def test_the_loop_is_called_with_no_step_first(fig2: System, monkeypatch: pytest.MonkeyPatch, algorithm: str) -> None:
    loop: Callable[..., Any] = LOOPS[algorithm].run
    types: list[list[Any]] = []

    def spy(*arguments: Any) -> Any:
        types.append([typeof(argument) for argument in arguments])
        return loop(*arguments)

    monkeypatch.setattr(LOOPS[algorithm], "run", spy)
    with prepare(fig2, 0.01, algorithm=algorithm) as simulation:
        assert len(types) == 1
        assert simulation.compile_seconds > 0
        assert (simulation.time, simulation.steps_made, simulation.count) == (0.0, 0, 1)
        compiled = compilations()
        simulation.run()
        assert len(types) > 1
        assert compilations() == compiled, "nothing is compiled while steps are made"
        assert all(later == types[0] for later in types), "machine code is kept for each kind of arguments"
        assert simulation.time == 0.01


@pytest.mark.usefixtures("heeded")
def test_an_interrupt_waits_for_the_end() -> None:
    """The compiler's callbacks would swallow it."""
    done = []

    def interrupted() -> None:
        signal.raise_signal(signal.SIGINT)
        done.append("compiled")

    with pytest.raises(KeyboardInterrupt):
        compile_loop(interrupted)
    assert done == ["compiled"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.usefixtures("heeded")
def test_further_interrupts_wait_too() -> None:
    done = []

    def interrupted() -> None:
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        done.append("compiled")

    with pytest.raises(KeyboardInterrupt):
        compile_loop(interrupted)
    assert done == ["compiled"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.fixture(params=SIGNALS, ids=lambda number: number.name)
def handled(request: pytest.FixtureRequest) -> Iterator[signal.Signals]:
    """A signal that the command line handles as it does in the foreground."""
    number = request.param
    usual = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
    before = signal.signal(number, usual)
    yield number
    signal.signal(number, before)


def test_signals_of_the_command_line_wait_for_the_end(handled: signal.Signals) -> None:
    """They have handlers of their own there."""
    done = []

    def interrupted() -> None:
        signal.raise_signal(handled)
        done.append("compiled")

    with Interrupts(), pytest.raises(KeyboardInterrupt) as ended:
        compile_loop(interrupted)
    assert done == ["compiled"]
    assert signal_of(ended.value) == handled
