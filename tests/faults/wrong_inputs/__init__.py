"""The table of wrong inputs: what a user may get wrong, and the words that the message must have."""

from tests.faults.wrong_inputs import building, commands, components, files, results, runs, systems
from tests.faults.wrong_inputs.case import Bench, Wrong

FUNCTIONS: tuple[Wrong, ...] = (
    *files.TABLE,
    *systems.TABLE,
    *components.TABLE,
    *runs.TABLE,
    *results.TABLE,
    *building.TABLE,
)
"""Wrong calls of the Python packages."""

COMMANDS: tuple[Wrong, ...] = commands.TABLE
"""Wrong command lines."""

FILES: tuple[Wrong, ...] = building.FILES
"""Wrong files of models, which a command builds."""

__all__ = ["COMMANDS", "FILES", "FUNCTIONS", "Bench", "Wrong"]
