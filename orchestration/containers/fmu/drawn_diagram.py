"""The block diagram of a system as a drawing for the page in a container."""

from adaptimp_fmu.guide import Drawing
from adaptimp_fmu.svg import BLUE, SOFT, Picture
from orchestration.errors import printable
from orchestration.ssp.diagram import diagram
from orchestration.system.system import System

_SMALL = 9.5  # pixels, size of the names of connectors


def drawn(system: System) -> Drawing:
    """Draw the components and the connections of a system."""
    layout = diagram(system)
    names = [printable(component.name) for component in system.components]
    title = f"Block diagram of {printable(system.name)}: {', '.join(names)}"
    picture = Picture(layout.width, layout.height, title)
    for route in layout.routes:
        picture.arrow(route, SOFT, 1.0)
    for component, name in zip(system.components, names, strict=True):
        box = layout.boxes[component.name]
        picture.box((box.x, box.y), (box.width, box.height), colour=BLUE)
        for variable, height in box.inputs.items():
            picture.text((box.x + 5, height + 3), variable, size=_SMALL, colour=SOFT, lowered=False)
        for variable, height in box.outputs.items():
            at = (box.x + box.width - 5, height + 3)
            picture.text(at, variable, size=_SMALL, colour=SOFT, anchor="end", lowered=False)
        picture.text((box.x + box.width / 2, box.y + 19), name, anchor="middle", bold=True, size=13, lowered=False)
    return Drawing(
        picture.svg(),
        "A component stands to the right of those that step before it and feed it. A line leads from an output to an"
        " input; lines from one component to another run together.",
    )
