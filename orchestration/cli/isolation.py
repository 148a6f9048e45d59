"""The option ``--isolate`` of ``adaptimp run``: components whose FMUs live in processes of their own."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from orchestration.fmi.isolation import Isolation

ISOLATE = "--isolate"
EVERY = "*"
"""What stands for all components."""


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
