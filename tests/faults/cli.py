"""Runs the command line in this process, through its real entry point."""

import re
import sys
from collections.abc import Callable
from typing import NamedTuple

import pytest

from orchestration.cli import main


class Outcome(NamedTuple):
    """What a command left behind.

    Attributes
    ----------
    err
        Standard error without the lines on what takes more than a second, which depend on the machine.
    waits
        Those lines.
    """

    code: int
    out: str
    err: str
    waits: str = ""

    @property
    def sentence(self) -> str:
        """The one error, without its "Error: "."""
        found = re.findall(r"^Error: (.*)$", self.err, re.MULTILINE)
        assert len(found) == 1, self.err
        return found[0]


Command = Callable[..., Outcome]


def runner(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """A function that runs ``adaptimp`` with arguments."""

    def adaptimp(*arguments: object) -> Outcome:
        capsys.readouterr()
        monkeypatch.setattr(sys, "argv", ["adaptimp", *map(str, arguments)])
        with pytest.raises(SystemExit) as exit_:
            main()
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        waits = re.findall(r"^.* \.\.\.\n", err, re.MULTILINE)
        return Outcome(int(exit_.value.code or 0), out, re.sub(r"(?m)^.* \.\.\.\n", "", err), "".join(waits))

    return adaptimp
