"""A sensor of force and moment at the wrist, drawn: its frame, the tip, and the wrenches."""

from adaptimp_fmu import Drawing
from adaptimp_fmu.svg import BLUE, FAINT, GREEN, INK, MARK, RUST, SOFT, Picture


def wrist_sensor() -> Drawing:
    """Draw where a wrist sensor is, in whose frame it errs, and where its reading acts."""
    picture = Picture(
        560, 330, "A wrist sensor between arm and tool: its frame, the frame of the tip, and the wrenches"
    )
    picture.line([(20, 92), (118, 92)], INK, 16)
    picture.text((62, 70), "arm", anchor="middle", colour=SOFT)
    picture.box((118, 58), (38, 68), fill=MARK, colour=RUST, width=2)
    picture.text((137, 44), "sensor", anchor="middle", colour=RUST, bold=True)
    picture.line([(156, 92), (250, 92), (330, 190)], INK, 9)
    picture.text((262, 82), "tool, tool_mass", colour=SOFT, lowered=False)
    picture.circle((262, 108), 5, INK, MARK)
    picture.arrow([(262, 108), (262, 178)], SOFT, 1.6)
    picture.text((262, 194), "weight", anchor="middle", colour=SOFT, size=12)
    for end, name in (((205, 58), "1"), ((171, 160), "2")):
        picture.arrow([(137, 92), end], GREEN, 1.8)
        picture.text((end[0] + 6, end[1] + 12), name, colour=GREEN, size=13)
    picture.text((150, 160), "frame of", anchor="end", size=12, colour=GREEN)
    picture.text((150, 176), "the sensor", anchor="end", size=12, colour=GREEN)
    picture.line([(330, 190), (137, 92)], FAINT, 1.4, dashes="5 4")
    for end, name in (((398, 150), "1"), ((372, 258), "2")):
        picture.arrow([(330, 190), end], GREEN, 1.8)
        picture.text((end[0] + 6, end[1] + 6), name, colour=GREEN, size=13)
    picture.circle((330, 190), 5, INK, INK)
    picture.text((316, 208), "tip", anchor="end", bold=True)
    picture.line([(250, 300), (470, 300)], INK, 2)
    for x in range(262, 470, 18):
        picture.line([(x, 300), (x - 12, 314)], FAINT, 1.4)
    picture.arrow([(330, 190), (330, 290)], RUST, 2.6)
    picture.text((338, 284), "F_ext", colour=RUST)
    picture.arrow([(330, 190), (316, 292)], BLUE, 1.6)
    picture.text((300, 286), "F_hat", anchor="end", colour=BLUE)
    picture.arc((330, 190), 26, (-1.2, 0.9), RUST)
    return Drawing(
        picture.svg(),
        "The wrench F_ext acts at the tip, and so does the reading F_hat: force and moment about the tip, in the axes"
        " of the base. The sensor itself is at sensor_position in the frame of the tip, turned by sensor_rpy. There it"
        " measures, with its errors, bias, range and resolution; an error of force there is an error of moment at the"
        " tip, by the lever between both.",
    )
