"""What the FMUs of a run logged: kept with the result, and said once if it is a warning."""

import json
from collections.abc import Sequence

from orchestration.errors import warn_caller
from orchestration.fmi.instance import Instance
from orchestration.results.columns import MESSAGES


class FmuWarning(UserWarning):
    """Warning that an FMU logged a message with the status fmi2Warning; a run gives one for each component.

    Examples
    --------
    To run FMUs that warn of much, and to look at their messages afterwards:

    >>> import warnings
    >>> from orchestration import FmuWarning, scenario, simulate
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", FmuWarning)
    ...     result = simulate(scenario("fig2"), stop_time=0.01)
    >>> result.messages
    ()
    """


def kept_messages(instances: Sequence[Instance]) -> dict[str, str]:
    """Return metadata of a result: JSON of a list of messages with the names of their components; empty without any."""
    found = []
    for instance in instances:
        messages = instance.messages
        if (lost := messages.total - len(messages)) > 0:
            found.append(f"{instance.name}: {lost} earlier messages are not kept.")
        found += [f"{instance.name}: {text}" for text in messages]
    return {MESSAGES: json.dumps(found, ensure_ascii=False)} if found else {}


def report_warnings(instances: Sequence[Instance]) -> None:
    """Warn of each component whose FMU has logged messages with the status fmi2Warning, unless that was said before."""
    for instance in instances:
        first, count = instance.messages.take_warnings()
        if count:
            more = f" and {count - 1} more" if count > 1 else ""
            msg = f'{instance.name} logged fmi2Warning: "{first}"{more}; result.messages, or --verbose, has the texts.'
            warn_caller(msg, FmuWarning)
