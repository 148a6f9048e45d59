"""Looks of the figures of any runs, on a light and on a dark page."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from matplotlib.rcsetup import cycler

from orchestration.paper.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, SHADE, SKY, STYLE, VERMILLION, WALL

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

PURPLE, YELLOW = "#CC79A7", "#F0E442"  # Okabe & Ito (2008), as the colours of the style
DASHES = ("-", "--", ":")
"""Lines of the components of a vector."""


@dataclass(frozen=True)
class Theme:
    """Colours of a figure.

    Attributes
    ----------
    paper, ink, faint
        Of the page, of texts and frames, and of the grid.
    curves
        Of the runs, or of the components of a single run, in their order.
    wall, contact, flight, saturated
        Of the wall, and of the bands of the phases.
    """

    paper: str
    ink: str
    faint: str
    curves: tuple[str, ...]
    wall: str
    contact: str
    flight: str
    saturated: str

    def settings(self) -> "dict[RcKeyType, Any]":
        """Return the settings of matplotlib with which figures are drawn and saved."""
        ink = ("text.color", "axes.labelcolor", "axes.edgecolor", "axes.titlecolor", "xtick.color", "ytick.color")
        paper = ("figure.facecolor", "axes.facecolor", "savefig.facecolor")
        colours: dict[RcKeyType, Any] = {**dict.fromkeys(ink, self.ink), **dict.fromkeys(paper, self.paper)}
        cycle = cycler(linestyle=DASHES) * cycler(color=self.curves)
        return {**STYLE, **colours, "grid.color": self.faint, "axes.prop_cycle": cycle}


LIGHT_PAGE = Theme(
    "#FFFFFF", BLACK, "#B0B0B0", (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, BLACK), WALL, SHADE, "#D9EEF9", ORANGE
)
DARK_PAGE = Theme(
    "#14171A",
    "#E6E6E6",
    GREY,
    (SKY, ORANGE, GREEN, PURPLE, VERMILLION, YELLOW, "#FFFFFF"),
    "#5A5A5A",
    "#3C3C3C",
    "#27566E",
    YELLOW,
)
MOST_RUNS = len(LIGHT_PAGE.curves)
"""As many runs as there are colours."""
