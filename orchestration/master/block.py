"""The ``with`` block of a run, outside of which there are no instances to step."""

from orchestration.errors import OrchestrationError


class Block:
    """Whether the block of a run has begun, and whether it is open.

    Parameters
    ----------
    system
        Name of the system, for messages.
    """

    def __init__(self, system: str) -> None:
        self.system = system
        self.begun = self.open = False

    def begin(self) -> None:
        """Say that the instances are there."""
        self.begun = self.open = True

    def end(self) -> None:
        """Say that the instances are freed; the recorded rows stay."""
        self.open = False

    def require_open(self) -> None:
        """Refuse what needs instances.

        Raises
        ------
        OrchestrationError
            Outside the block.
        """
        if not self.open:
            when = "is over" if self.begun else "has not begun"
            example = "with prepare(system, stop_time, step) as simulation: simulation.run()"
            msg = f"System {self.system}: the run {when}; step it inside its block, as in `{example}`."
            raise OrchestrationError(msg)

    def require_begun(self) -> None:
        """Refuse what needs rows.

        Raises
        ------
        OrchestrationError
            Before the block.
        """
        if not self.begun:
            self.require_open()
