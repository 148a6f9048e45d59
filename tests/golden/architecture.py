"""Draws docs/images/architecture.svg from the contracts of pyproject.toml and the folders that there are.

python -m tests.golden.architecture            says whether the picture is up to date
python -m tests.golden.architecture --write    draws it
"""

import argparse
import ast
import tomllib
from dataclasses import dataclass
from pathlib import Path

from lxml import etree
from rich.console import Console

ROOT = Path(__file__).parents[2]
PICTURE = ROOT / "docs" / "images" / "architecture.svg"
WIDTH, MARGIN, GAP = 1080, 24, 14  # px
LINE, PADDING = 17, 12  # px
CHARACTER = 6.2  # px of width that a character of the small text takes
FILLS = {"orchestration": "#e8eef7", "fmus": "#e6f4e6", "adaptimp_fmu": "#f8e9e9"}
STYLE = """
text { font-family: system-ui, "Segoe UI", "DejaVu Sans", sans-serif; fill: #1d2733; }
.package { font-size: 17px; font-weight: 700; } .room { font-size: 14px; font-weight: 700; }
.says { font-size: 12px; } .modules { font-size: 11.5px; fill: #4b5968; }
.mark { font-size: 11.5px; fill: #7a4b00; text-anchor: end; }
rect { stroke: #8796a8; stroke-width: 1; rx: 6; } .outer { fill: none; stroke: #b8c2ce; }
"""


@dataclass(frozen=True)
class Room:
    """A module or a folder.

    Attributes
    ----------
    says
        First paragraph of the docstring.
    modules
        Names of the modules in it, one text for its own and one for each of its folders.
    mark
        What a contract allows this room and few others.
    """

    name: str
    says: str
    modules: tuple[str, ...]
    mark: str = ""

    def lines(self, width: float) -> list[str]:
        """The modules, wrapped to a width in px."""
        return [line for group in self.modules for line in wrapped(group, width)]

    def height(self, width: float) -> float:
        """Height of the box in px."""
        return 2 * PADDING + LINE * (bool(self.name) + len(self.texts(width))) - 2

    def texts(self, width: float) -> list[tuple[str, str]]:
        """Lines below the name with their style, wrapped to a width in px."""
        says = [("says", line) for line in wrapped(self.says, width)]
        return says + [("modules", line) for line in self.lines(width)]


def wrapped(text: str, width: float) -> list[str]:
    """A sentence in lines that fit a width in px."""
    lines, most = [""], int(width / CHARACTER)
    for word in text.split():
        if len(lines[-1]) + 1 + len(word) > most and lines[-1]:
            lines.append(word)
        else:
            lines[-1] = f"{lines[-1]} {word}".strip()
    return [line for line in lines if line]


def room(path: Path) -> Room:
    """The room at a path without suffix."""
    if not path.is_dir():
        return Room(path.name, _says(path.with_suffix(".py")), ())
    folders = [file.parent for file in sorted(path.rglob("__init__.py")) if file.parent != path]
    nested = [f"{folder.relative_to(path).as_posix()}/ {_modules(folder)}" for folder in sorted(folders)]
    groups = (_modules(path), *nested)
    return Room(f"{path.name}/", _says(path / "__init__.py"), tuple(g for g in groups if g), _mark(path))


def _modules(folder: Path) -> str:
    return " \N{MIDDLE DOT} ".join(p.stem for p in sorted(folder.glob("*.py")) if not p.stem.startswith("__"))


def _says(file: Path) -> str:
    """The first paragraph of a docstring, as plain text."""
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].replace("`", "").split())


def _mark(path: Path) -> str:
    """What contracts of type protected allow a room."""
    name = ".".join(path.relative_to(ROOT).parts)
    protected = [c for c in contracts().values() if c["type"] == "protected"]
    seen = [
        m
        for c in protected
        if any(f"{a}.".startswith(f"{name}.") for a in c["allowed_importers"])
        for m in c["protected_modules"]
    ]
    return f"may import {', '.join(seen)}" if seen and path.parent != ROOT else ""


def contracts() -> dict[str, dict]:
    """The contracts of import-linter by id."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return {contract["id"]: contract for contract in settings["tool"]["importlinter"]["contracts"]}


def floors(package: str) -> list[list[Room]]:
    """Rooms of a package from the top down, side by side where neither may import the other."""
    root, rooms = ROOT / package, contracts()["rooms"]
    if package not in rooms["containers"]:
        whole = room(root)
        inside = [room(folder) for folder in sorted(root.iterdir()) if (folder / "__init__.py").exists()]
        return [[Room("", "", whole.modules[:1])], *([inside] if inside else [])]
    names = [[name.strip().strip("()") for name in layer.split("|")] for layer in rooms["layers"]]
    there = [[name for name in layer if (root / name).is_dir() or (root / f"{name}.py").exists()] for layer in names]
    return [[room(root / name) for name in layer] for layer in there if layer]


def draw() -> bytes:
    """The picture, as SVG."""
    svg = etree.Element("svg", xmlns="http://www.w3.org/2000/svg", role="img")
    etree.SubElement(svg, "title").text = "Rooms of the project; each imports only what stands below it"
    etree.SubElement(svg, "style").text = STYLE
    y = float(MARGIN)
    for package in contracts()["packages"]["layers"]:
        y = _package(svg, package, y) + GAP
    svg.set("viewBox", f"0 0 {WIDTH} {y - GAP + MARGIN:g}")
    etree.indent(svg)
    return etree.tostring(svg, encoding="utf-8") + b"\n"


def _package(svg: etree._Element, package: str, top: float) -> float:
    """Draw a package from a height on; returns where it ends."""
    y = top + PADDING + LINE
    outer = etree.SubElement(svg, "rect", {"class": "outer", "x": str(MARGIN), "width": str(WIDTH - 2 * MARGIN)})
    _text(svg, "package", MARGIN + PADDING, y, f"{package}/")
    _text(svg, "says", MARGIN + PADDING + 150, y, room(ROOT / package).says)
    y += PADDING
    for floor in floors(package):
        width = (WIDTH - 2 * MARGIN - 2 * PADDING - GAP * (len(floor) - 1)) / len(floor)
        height = max(r.height(width - 2 * PADDING) for r in floor)
        for i, r in enumerate(floor):
            _room(svg, r, (MARGIN + PADDING + i * (width + GAP), y, width, height), FILLS[package])
        y += height + GAP / 2
    outer.set("y", f"{top:g}")
    outer.set("height", f"{y + PADDING - GAP / 2 - top:g}")
    return y + PADDING - GAP / 2


def _room(svg: etree._Element, r: Room, box: tuple[float, float, float, float], fill: str) -> None:
    x, y, width, height = box
    shape = {"x": f"{x:g}", "y": f"{y:g}", "width": f"{width:g}", "height": f"{height:g}", "fill": fill}
    etree.SubElement(svg, "rect", shape)
    y += PADDING + 10 - LINE
    if r.name:
        y += LINE
        _text(svg, "room", x + PADDING, y, r.name)
        _text(svg, "mark", x + width - PADDING, y, r.mark)
    for style, line in r.texts(width - 2 * PADDING):
        y += LINE
        _text(svg, style, x + PADDING, y, line)


def _text(svg: etree._Element, kind: str, x: float, y: float, text: str) -> None:
    etree.SubElement(svg, "text", {"class": kind, "x": f"{x:g}", "y": f"{y:g}"}).text = text


def main() -> None:
    """Compare or draw."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--write", action="store_true", help="draw the picture anew")
    if parser.parse_args().write:
        PICTURE.write_bytes(draw())
    elif PICTURE.read_bytes() != draw():
        raise SystemExit(f"{PICTURE.name} is out of date: python -m tests.golden.architecture --write")
    Console().print(f"{PICTURE.name} shows the rooms as they are.", highlight=False)


if __name__ == "__main__":
    main()
