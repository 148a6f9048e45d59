"""What a sensor, an actuator, a virtual trajectory and a target impedance do, drawn."""

import math

from adaptimp_fmu import Drawing
from adaptimp_fmu.svg import BLUE, FAINT, INK, RUST, SOFT, Picture


def sensor() -> Drawing:
    """Draw the disc that the error of a measured force stays in."""
    picture = Picture(420, 250, "The measured force: the true force plus an error within a disc")
    origin, force = (50.0, 200.0), (250.0, 105.0)
    picture.arrow([origin, (390, 200)], SOFT, 1.2)
    picture.text((396, 205), "1", colour=SOFT)
    picture.arrow([origin, (50, 25)], SOFT, 1.2)
    picture.text((50, 18), "2", colour=SOFT, anchor="middle")
    picture.circle(force, 58, SOFT, "var(--mark, #fbe9dd)")
    picture.arrow([origin, force], INK, 2.2)
    picture.text((140, 142), "F_ext", anchor="end")
    noisy = (284.0, 76.0)
    picture.arrow([force, noisy], RUST, 1.8)
    picture.text((276, 104), "error", colour=RUST)
    picture.arrow([origin, noisy], BLUE, 1.6)
    picture.text((180, 92), "F_hat", colour=BLUE, anchor="end")
    picture.text((250, 182), "radius noise_bound", anchor="middle", colour=SOFT, size=12, lowered=False)
    return Drawing(
        picture.svg(),
        "The error is within noise_bound of zero, whatever its direction, and its density is that of a normal"
        " distribution. Bias, range and resolution act after the error; they are off by default.",
    )


def saturation() -> Drawing:
    """Draw the torque over its command."""
    picture = Picture(420, 260, "Torque over commanded torque, limited to plus and minus tau_max")
    picture.arrow([(20, 135), (400, 135)], SOFT, 1.2)
    picture.text((400, 155), "tau_cmd", colour=SOFT, anchor="end")
    picture.arrow([(205, 250), (205, 15)], SOFT, 1.2)
    picture.text((215, 24), "tau", colour=SOFT)
    for x, y, text, at in ((275, 65, "tau_max", 198), (135, 205, "-tau_max", 212)):
        picture.line([(x, 135), (x, y)], FAINT, 1.2, dashes="4 4")
        picture.line([(205, y), (x, y)], FAINT, 1.2, dashes="4 4")
        picture.text((at, y + 5), text, anchor="end" if at < 205 else "start", size=12)
    picture.line([(40, 205), (135, 205), (275, 65), (385, 65)], BLUE, 2.8)
    picture.text((330, 55), "saturated", colour=RUST, anchor="middle", size=12)
    picture.text((80, 224), "saturated", colour=RUST, anchor="middle", size=12)
    return Drawing(
        picture.svg(),
        "Each joint on its own. A limit of the rate and a first-order lag follow; both are off by default.",
    )


def cut_ellipse(walls: int = 1) -> Drawing:
    """Draw the virtual trajectory: an ellipse, cut where it lies deeper in a wall than `depth`."""
    picture = Picture(480, 300, "The virtual trajectory: an ellipse with a straight segment inside the wall")
    centre, a, b, cut = (260.0, 155.0), 170.0, 112.0, 108.0
    floor = 215.0 if walls > 1 else 1e3
    turns = [2 * math.pi * i / 120 for i in range(121)]
    ellipse = [(centre[0] + a * math.cos(t), centre[1] - b * math.sin(t)) for t in turns]
    picture.line(ellipse, FAINT, 1.6, dashes="5 4")
    picture.arrow([centre, (centre[0] + 205, centre[1])], SOFT, 1.2)
    picture.text((centre[0] + 203, centre[1] + 20), "x_1", colour=SOFT)
    picture.arrow([centre, (centre[0], centre[1] - 145)], SOFT, 1.2)
    picture.text((centre[0] + 8, centre[1] - 136), "x_2", colour=SOFT)
    picture.line([(cut + 16, 18), (cut + 16, 282)], INK, 2)
    picture.text((cut + 22, 280), "wall", colour=SOFT, size=13)
    if walls > 1:
        picture.line([(cut + 16, floor - 16), (470, floor - 16)], INK, 2)
        picture.text((150, floor - 24), "second wall", colour=SOFT, size=13)
    picture.line([(max(x, cut), min(y, floor)) for x, y in ellipse], BLUE, 2.8)
    picture.arrow([(cut - 40, centre[1]), (cut, centre[1])], RUST, 1.4)
    picture.arrow([(cut + 60, centre[1]), (cut + 16, centre[1])], RUST, 1.4)
    picture.text((cut + 64, centre[1] + 5), "depth", colour=RUST, size=13)
    picture.circle((centre[0] + a, centre[1]), 5, BLUE, BLUE)
    picture.arc(centre, 132, (0.12, 0.55), BLUE)
    picture.text((centre[0] + a - 6, centre[1] + 24), "t = 0", anchor="end", size=13)
    return Drawing(
        picture.svg(),
        "The virtual trajectory x_v begins on the axis x1 and runs counter-clockwise, one turn in the time period."
        " Along the wall x_v lies at the given depth inside the wall, so that the tip is to press.",
    )


def impedance() -> Drawing:
    """Draw the target impedance between the virtual position and the tip, along one axis."""
    picture = Picture(
        520, 190, "Target impedance along one axis: a mass on a spring and a damper, and the contact force"
    )
    picture.line([(60, 30), (60, 150)], BLUE, 3)
    picture.text((60, 172), "x_v", colour=BLUE, anchor="middle")
    teeth = [(110.0 + 14 * i, 48.0 if i % 2 else 72.0) for i in range(9)]
    picture.line([(60, 60), (100, 60), *teeth, (240, 60), (290, 60)], INK, 1.8)
    picture.text((166, 38), "K", anchor="middle")
    picture.line([(60, 120), (150, 120)], INK, 1.8)
    picture.line([(190, 104), (150, 104), (150, 136), (190, 136)], INK, 1.8)
    picture.line([(172, 110), (172, 130)], INK, 1.8)
    picture.line([(172, 120), (290, 120)], INK, 1.8)
    picture.text((170, 158), "B", anchor="middle")
    picture.box((290, 36), (84, 108), width=1.8)
    picture.text((332, 96), "M", anchor="middle")
    picture.arrow([(460, 90), (374, 90)], RUST, 2.4)
    picture.text((420, 80), "-F_ext", colour=RUST, anchor="middle")
    picture.text((332, 172), "x", anchor="middle")
    return Drawing(
        picture.svg(),
        "What the tip is to feel like, along each axis: a mass M on a spring K and a damper B, which hang on the"
        " virtual position x_v. The wall pushes with -F_ext.",
    )
