"""What the paper does not say either, and what is assumed without a range: no study varies it."""

from dataclasses import dataclass

from orchestration.paper.studies.open_values import ADAPTIVE, ALGORITHM_1


@dataclass(frozen=True)
class FixedValue:
    """An assumption without a range.

    Attributes
    ----------
    name
        What the paper leaves open.
    value
        What is assumed.
    reason
        Why.
    claims
        Claims that the assumption takes part in, as text.
    """

    name: str
    value: str
    reason: str
    claims: str


FIXED = (
    FixedValue("gravity", "0 m/s2", "the figures show a plane, and no weight holds the arm at the start", "all"),
    FixedValue("side of the wall", "left, vertical", "Fig. 1 draws the wall where the ellipse ends on its left", "all"),
    FixedValue("straight segment", "parallel to the wall", "a steady force asks for a steady depth", "all"),
    FixedValue("friction of the joints", "none", "(1) has a term f, and section V gives no number for it", "all"),
    FixedValue("sampling of Figs. 2 to 4", "1e-4 s", "without adaptation nothing chatters", "C1 to C3"),
    FixedValue(
        "norm of the noise",
        "the Euclidean norm of both components has the bound",
        "(21) bounds the norm; the paper's sentence speaks of a random noise, not of its components",
        ADAPTIVE,
    ),
    FixedValue(
        "peak of the contact force",
        "of Fig. 5 without noise",
        "a peak with noise would depend on the noise whose bound it gives",
        ADAPTIVE,
    ),
    FixedValue(
        "run that gives the largest torque",
        "Fig. 5 with the first seed of the noise",
        '"required in the preceding simulation" is one run',
        "C4 to C10, C19, C20",
    ),
    FixedValue("bound that F_c knows", "the bound of the noise", "(21) calls it known", ALGORITHM_1),
    FixedValue(
        "force in F_c",
        "F_c acts while a force is measured",
        "without contact there is no noise, and F_c chatters",
        ALGORITHM_1,
    ),
    FixedValue("gains of both axes", "equal", "the plane has no direction of its own but for the wall", ADAPTIVE),
    FixedValue("parameters adapted", "m2 alone, without projection", "section V adapts m2 alone", ADAPTIVE),
    FixedValue("integration of m2_hat", "explicit Euler at every tick", "the simplest one", ADAPTIVE),
    FixedValue("torque between ticks", "held", "as a digital controller does", "all"),
)
"""The assumptions without a range."""
