"""Draws docs/images/loop.svg, the block diagram of README.md, from the drawing that the FMUs hold.

python -m tests.golden.loop            says whether the picture is up to date
python -m tests.golden.loop --write    draws it
"""

import sys
from pathlib import Path

from rich.console import Console

from fmus.drawings.loop import CONTROLLER, loop

PICTURE = Path(__file__).parents[2] / "docs" / "images" / "loop.svg"


def draw() -> str:
    """The picture; it has a paper of its own, since a page that shows it may be dark."""
    return loop(CONTROLLER).svg.replace(
        'font-family="sans-serif">', 'font-family="sans-serif" style="background:#fff">'
    )


def main(arguments: list[str]) -> None:
    """Draw the picture, or say whether it is up to date."""
    if arguments == ["--write"]:
        PICTURE.write_text(draw() + "\n", encoding="utf-8")
    elif PICTURE.read_text(encoding="utf-8") != draw() + "\n":
        raise SystemExit(f"{PICTURE.name} is out of date: python -m tests.golden.loop --write")
    Console().print(f"{PICTURE.name} shows the loop as the FMUs do.", highlight=False)


if __name__ == "__main__":
    main(sys.argv[1:])
