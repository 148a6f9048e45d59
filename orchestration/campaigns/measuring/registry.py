"""Ready measures by name. A room above has them, since this one knows no robot."""

from collections.abc import Mapping
from importlib import import_module

READY = "orchestration.paper.ready_measures:READY"
"""Where the ready measures are: a mapping from a name to a formula and what it says."""


def ready_measures() -> Mapping[str, tuple[str, str]]:
    """Formula and description of each ready measure, by its name."""
    module, _, name = READY.partition(":")
    return getattr(import_module(module), name)
