"""Follows a page of Markdown as its reader would: writes its files, types its commands, keeps what they print.

A fence of ``sh`` is typed into one shell for the whole page. A fence of ``text`` is what the commands before it print.
Any other fence is a file, named at the end of the line before it: **`name`**. A fence of ``python`` without a name, and
what it shows, are left to `tests.scenarios.pages`. There is one difference to a reader's machine: ``uv run COMMAND`` is
``COMMAND`` with the scripts of this Python first, so nothing is installed.

    uv run python -m tests.scenarios.tutorial PAGE FOLDER    prints all there is to show, for who edits the page
"""

import re
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"\*\*`([\w./]+)`\*\*\n\n$")
UV = f"""set -e
export PATH="{sysconfig.get_path("scripts")}:$PATH" COLUMNS=80
uv() {{ test "$1" = run; shift; "$@"; }}
"""
END = "--- end of block"
WAIT = re.compile(r"^.* \.\.\.\n", re.MULTILINE)
"""A line on what takes more than a second, which depends on the machine."""


@dataclass(frozen=True)
class Block:
    """A fence of the page.

    Attributes
    ----------
    line
        Number of its first line.
    file
        Name of the file that it shows, empty for commands and for what they print.
    """

    kind: str
    text: str
    line: int
    file: str


@dataclass(frozen=True)
class Printed:
    """What the page shows for some commands, and what they really print."""

    line: int
    shown: str
    real: str

    @property
    def agree(self) -> bool:
        """Whether they are the same words; ``...`` stands for any, line breaks and frames do not count."""
        parts = [re.escape(" ".join(_words(part))) for part in self.shown.split("...")]
        return re.fullmatch(r"\s*" + r"\s*.*?\s*".join(parts) + r"\s*", " ".join(_words(self.real))) is not None


def blocks(page: Path) -> list[Block]:
    """Fences of a page in their order."""
    text, found = page.read_text(encoding="utf-8"), []
    for fence in FENCE.finditer(text):
        named = None if fence[1] in ("sh", "text") else FILE.search(text[: fence.start()])
        line = text.count("\n", 0, fence.start()) + 1
        found.append(Block(fence[1], fence[2], line, named[1] if named else ""))
    return found


def follow(page: Path, folder: Path, skip: tuple[str, ...] = ()) -> list[Printed]:
    """Do what the page says, from an empty folder on.

    Parameters
    ----------
    skip
        First words of fences whose commands are not typed.

    Raises
    ------
    AssertionError
        If a command fails, with all it printed.
    """
    printed, last, typed = [], "", True
    shell = subprocess.Popen(
        ["sh"], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    with shell:
        here = _typed(shell, UV, folder / "start.sh")[1]
        for block in blocks(page):
            if block.kind == "python" and not block.file:
                typed = False
            elif block.kind == "text":
                printed += [Printed(block.line, block.text, last)] if typed else []
            elif block.kind != "sh":
                (here / block.file).parent.mkdir(parents=True, exist_ok=True)
                (here / block.file).write_text(block.text, encoding="utf-8")
            elif not block.text.startswith(skip or ("\0",)):
                last, here = _typed(shell, block.text, folder / f"line_{block.line}.sh")
                last, typed = WAIT.sub("", last), True
    return printed


def _typed(shell: subprocess.Popen[str], commands: str, script: Path) -> tuple[str, Path]:
    """What commands print, and the folder they end in."""
    assert shell.stdin is not None
    assert shell.stdout is not None
    script.write_text(commands, encoding="utf-8")
    shell.stdin.write(f'. "{script}" < /dev/null\necho "{END}"\npwd\n')
    shell.stdin.flush()
    lines = []
    for line in shell.stdout:
        if line.strip() == END:
            return "".join(lines), Path(shell.stdout.readline().rstrip("\n"))
        lines.append(line)
    msg = f"{script.name} fails:\n{commands}\n{''.join(lines)}"
    raise AssertionError(msg)


def _words(text: str) -> list[str]:
    """Words without the frames of tables."""
    return re.sub("[━╇┃│─┼]", " ", text).split()


if __name__ == "__main__":
    for result in follow(Path(sys.argv[1]), Path(sys.argv[2])):
        sys.stdout.write(f"line {result.line}: {'agree' if result.agree else 'DIFFER'}\n{result.real}\n")
