"""What the page in an FMU says besides the model's declaration: formulas, drawings, neighbours, topics, examples.

Everything is optional: a model that states nothing has a page of its variables, its rules and its author's text.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Formula:
    """A formula with the sentence that introduces the formula.

    Attributes
    ----------
    latex
        LaTeX of the mathematical mode, without dollar signs.
    text
        What the formula says, in words.
    number
        Number of the equation in its source, such as ``11``; empty if the equation has no number.

    Examples
    --------
    >>> from adaptimp_fmu import Formula
    >>> law = Formula(r"F = K (x_v - x)", "The force grows with the deviation.", "3")
    """

    latex: str
    text: str
    number: str = ""


@dataclass(frozen=True)
class Formulas:
    """Formulas under a heading.

    Examples
    --------
    >>> from adaptimp_fmu import Formula, Formulas, Guide, SampledModel
    >>> model = SampledModel("Spring", "A spring")
    >>> law = Formulas("Law", [Formula(r"F = K (x_v - x)", "The force grows with the deviation.")])
    >>> model.guide = Guide(formulas=[law])
    """

    title: str
    items: Sequence[Formula]


@dataclass(frozen=True)
class Drawing:
    """A drawing: an ``svg`` element, and the caption below it. The element has a title for those who cannot see it.

    Examples
    --------
    >>> from adaptimp_fmu import Drawing, Guide, SampledModel
    >>> from adaptimp_fmu.svg import Picture
    >>> picture = Picture(120, 40, "A force that points to the right")
    >>> picture.arrow([(10, 20), (110, 20)])
    >>> model = SampledModel("Force", "A force")
    >>> model.guide = Guide(drawings=[Drawing(picture.svg(), "The force is positive to the right.")])
    """

    svg: str
    caption: str


@dataclass(frozen=True)
class Signal:
    """Where a signal comes from and where it goes to, as components of the system that the FMU is made for.

    Examples
    --------
    >>> from adaptimp_fmu import Guide, Signal
    >>> guide = Guide(signals={"F": Signal("controller", ["cart"]), "x": Signal("cart", ["controller"])})
    """

    source: str
    targets: Sequence[str]


@dataclass(frozen=True)
class Grid:
    """How elements of arrays stand in tables, such as the parameters of the bodies of an arm: a body in each row.

    Rows that have the same columns are one table. The page has such a table in the place of a row for each element.

    Attributes
    ----------
    arrays
        Names of arrays that are laid out in this way. Elements beyond the end of an array have no cell.
    places
        Row and column of each element, counted from 1 in the FMU.
    what
        What the elements are, such as ``parameters of the arm``.
    legend
        What rows and columns are, in a sentence or two.

    Examples
    --------
    >>> from adaptimp_fmu import Grid, Guide, SampledModel
    >>> model = SampledModel("Gain", "A gain")
    >>> k = model.parameter("k", [2.0, 3.0], description=["Gain of the left", "Gain of the right"])
    >>> model.guide = Guide(grids=[Grid(["k"], [("left", "gain"), ("right", "gain")], "gains of the sides")])
    """

    arrays: Sequence[str]
    places: Sequence[tuple[str, str]]
    what: str
    legend: str = ""


@dataclass(frozen=True)
class Example:
    """A program that a user of the FMU can run.

    Attributes
    ----------
    title
        Heading.
    text
        What the program does, what it needs, and what to see.
    code
        The program.

    Examples
    --------
    >>> from adaptimp_fmu import Example, Guide
    >>> code = "from fmpy import simulate_fmu" + chr(10) + "print(simulate_fmu('Gain.fmu')['y'][-1])"
    >>> guide = Guide(examples=[Example("A first run", "The program prints what the gain makes of its input.", code)])
    """

    title: str
    text: str
    code: str


@dataclass(frozen=True)
class Numbers:
    """A table of numbers that are fixed in the equations and no parameters, such as where the joints of an arm are.

    Attributes
    ----------
    title
        Heading.
    text
        What the numbers are.
    heads
        Name and unit of each column after the first, which names the rows; a unit may be empty.
    rows
        Name of each row, with its texts.

    Examples
    --------
    >>> from adaptimp_fmu import Guide, Numbers
    >>> where = Numbers("Wheels", "Distance from the axle.", [("distance", "m")], [("left", ["0.4"])])
    >>> guide = Guide(numbers=[where])
    """

    title: str
    text: str
    heads: Sequence[tuple[str, str]]
    rows: Sequence[tuple[str, Sequence[str]]]


@dataclass(frozen=True)
class Guide:
    """What the page in an FMU shows besides the declared variables.

    Attributes
    ----------
    formulas
        Formulas under headings, in the order of the page.
    drawings
        Drawings of what the variables mean, such as frames and signs.
    place
        Drawings of the system with this component marked.
    signals
        Partners of inputs and outputs, by the name of a variable or of an array.
    topics
        Names of parameters or of their arrays, by topic. Parameters without a topic come last.
    grids
        Arrays whose elements stand in tables of several columns.
    examples
        Programs that use the FMU.
    numbers
        Tables of numbers that are fixed in the equations.

    Examples
    --------
    >>> from adaptimp_fmu import Guide, SampledModel
    >>> model = SampledModel("Gain", "A gain")
    >>> k = model.parameter("k", 2.0, description="Gain")
    >>> model.guide = Guide(topics={"Law": ["k"], "Sampling": ["sample_time"]})
    """

    formulas: Sequence[Formulas] = ()
    drawings: Sequence[Drawing] = ()
    place: Sequence[Drawing] = ()
    signals: Mapping[str, Signal] = field(default_factory=dict)
    topics: Mapping[str, Sequence[str]] = field(default_factory=dict)
    grids: Sequence[Grid] = ()
    examples: Sequence[Example] = ()
    numbers: Sequence[Numbers] = ()
