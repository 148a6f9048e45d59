"""The icon of a container: blocks that are connected in a loop, inside of a frame."""

from adaptimp_fmu.icon import Icon, Stroke, png

_COLOUR = (40, 60, 80)
_FRAME = [(0.1, 0.12), (0.1, 0.88), (0.9, 0.88), (0.9, 0.12), (0.1, 0.12)]
_LOOP = [(0.32, 0.66), (0.68, 0.66), (0.68, 0.34), (0.32, 0.34), (0.32, 0.66)]
_BLOCK = 0.17  # of the icon's side


def container_icon() -> bytes:
    """Return the file ``model.png`` of a container."""
    blocks = [Stroke([corner], width=_BLOCK) for corner in _LOOP[:4]]
    return png(Icon(_COLOUR, [Stroke(_FRAME, width=0.035), Stroke(_LOOP, width=0.035), *blocks]))
