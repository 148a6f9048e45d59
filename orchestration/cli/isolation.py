"""The option ``--isolate`` of commands: components whose FMUs live in processes of their own."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from orchestration.cli.program import Command

if TYPE_CHECKING:
    from orchestration.fmi.isolation import Isolation

ISOLATE = "--isolate"
EVERY = "*"
"""What stands for all components."""


class IsolatingCommand(Command):
    """A command whose option ``--isolate`` takes one word or none."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the words of the command line, after ``--isolate`` got its word."""
        return super().parse_args(ctx, completed(args))


def completed(words: Sequence[str]) -> list[str]:
    """Give ``--isolate`` the word `EVERY` where no name follows."""
    found: list[str] = []
    for k, word in enumerate(words):
        found.append(word)
        if word == ISOLATE and (k + 1 == len(words) or words[k + 1].startswith("-")):
            found.append(EVERY)
    return found


def isolation_of(words: Sequence[str]) -> "Isolation | None":
    """What the words after ``--isolate`` ask for, each with names between commas; None without any."""
    from orchestration.fmi.isolation import Isolation

    names = [name.strip() for word in words for name in word.split(",") if name.strip()]
    if not words:
        return None
    return Isolation() if EVERY in names else Isolation(names)
