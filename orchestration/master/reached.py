"""How far a run is: its time, its steps and its rows."""

from orchestration.master.block import Block
from orchestration.master.kernel.records import State
from orchestration.master.recorder import Recorder


class Reached:
    """What a run says about its progress, inside its ``with`` block."""

    _block: Block
    _recorder: Recorder
    _state: State

    @property
    def count(self) -> int:
        """Number of rows recorded."""
        self._block.require_begun()
        return self._recorder.count

    @property
    def time(self) -> float:
        """Time that the run has reached, s."""
        self._block.require_begun()
        return float(self._state.time)

    @property
    def steps_made(self) -> int:
        """Number of steps that were accepted."""
        self._block.require_begun()
        return int(self._state.steps_made)
