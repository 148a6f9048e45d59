"""The loop of the five components as a block diagram, with one of them marked."""

from collections.abc import Sequence

from adaptimp_fmu import Drawing, Signal
from adaptimp_fmu.svg import INK, MARK, RUST, SOFT, Picture

PLANT, SENSOR, ACTUATOR, TRAJECTORY, CONTROLLER = "plant", "sensor", "actuator", "trajectory", "controller"
LINKS: tuple[tuple[str, Sequence[str], Sequence[str]], ...] = (
    (TRAJECTORY, ("x_v", "dx_v", "ddx_v"), (CONTROLLER,)),
    (SENSOR, ("F_hat",), (CONTROLLER,)),
    (CONTROLLER, ("tau_cmd",), (ACTUATOR,)),
    (ACTUATOR, ("tau",), (PLANT,)),
    (ACTUATOR, ("saturated",), (CONTROLLER,)),
    (PLANT, ("q", "dq", "ddq"), (CONTROLLER,)),
    (PLANT, ("F_ext",), (SENSOR,)),
)
"""Signals of the loop: the component that has them as outputs, their names, and the components that take them."""
_BOXES = {
    TRAJECTORY: ((20.0, 40.0), "trajectory"),
    CONTROLLER: ((240.0, 40.0), "controller"),
    ACTUATOR: ((430.0, 40.0), "actuator"),
    PLANT: ((590.0, 40.0), "plant: arm, wall"),
    SENSOR: ((430.0, 190.0), "force sensor"),
}
_WIDTH, _HEIGHT = 130.0, 56.0


def signals() -> dict[str, Signal]:
    """Partners of all signals of the loop by name."""
    return {name: Signal(source, targets) for source, names, targets in LINKS for name in names}


def loop(marked: str, also_measured: Sequence[str] = ()) -> Drawing:
    """Draw the loop.

    Parameters
    ----------
    marked
        Name of the component that the page is about, one of the constants above.
    also_measured
        Names of signals that the sensor takes from the plant besides F_ext.
    """
    picture = Picture(740, 290, f"Block diagram of the loop; the {_BOXES[marked][1]} is marked")
    for name, (corner, label) in _BOXES.items():
        here = name == marked
        colour, fill = (RUST, MARK) if here else (INK, "var(--paper, #fff)")
        picture.box(corner, (_WIDTH, _HEIGHT), colour=colour, fill=fill, width=2.4 if here else 1.4)
        middle = (corner[0] + _WIDTH / 2, corner[1] + _HEIGHT / 2 + 5)
        picture.text(middle, label, anchor="middle", bold=here, size=13.5)
    _arrows(picture, ", ".join(("F_ext", *also_measured)))
    return Drawing(
        picture.svg(),
        f"The loop and this component, {marked}. In each step the components run in the order trajectory, sensor,"
        " controller, actuator, plant.",
    )


def _arrows(picture: Picture, measured: str) -> None:
    """Draw the signals between the boxes."""
    picture.arrow([(150, 58), (240, 58)])
    picture.text((195, 50), "x_v, dx_v,", anchor="middle", size=13)
    picture.text((195, 76), "ddx_v", anchor="middle", size=13)
    picture.arrow([(370, 58), (430, 58)])
    picture.text((400, 50), "tau_cmd", anchor="middle", size=13)
    picture.arrow([(560, 58), (590, 58)])
    picture.text((575, 50), "tau", anchor="middle", size=13)
    picture.arrow([(655, 96), (655, 218), (560, 218)])
    picture.text((647, 166), measured, anchor="end", size=13)
    picture.arrow([(430, 218), (325, 218), (325, 96)])
    picture.text((378, 210), "F_hat", anchor="middle", size=13)
    picture.arrow([(495, 96), (495, 128), (350, 128), (350, 96)], SOFT)
    picture.text((422, 145), "saturated (adaptive controllers)", anchor="middle", size=12, colour=SOFT)
    picture.arrow([(690, 96), (690, 268), (285, 268), (285, 96)])
    picture.text((487, 283), "q, dq, ddq", anchor="middle", size=13)
