"""Draws the picture of one or several results into a file: ``adaptimp plot`` and ``adaptimp run --plot``."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from adaptimp_fmu.files.cache_folder import let_matplotlib_write
from adaptimp_fmu.files.parts import require
from orchestration.cli.output import output, watched
from orchestration.cli.pages import PAGE, is_page, write_page_of
from orchestration.cli.places import require_folder, written
from orchestration.errors import SystemDescriptionError
from orchestration.results.formats import READERS
from orchestration.results.picture_file import FORMATS, MOVING, require_picture
from orchestration.results.result import Result
from orchestration.system.system import System

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from orchestration.paper.figures.theme import Theme

MOST_RESULTS = 7  # that colours can tell apart


@dataclass(frozen=True)
class PictureRequest:
    """A file for a picture, or none.

    Attributes
    ----------
    path
        The file; None for no picture.
    dark
        Whether the picture is for a dark page.
    names
        Columns, arrays or patterns to draw by unit; without any, the panels of the paper where that is possible.
    option
        Option that the file comes from.
    page
        Whether the file may be a page, .html.
    """

    path: Path | None = None
    dark: bool = False
    names: Sequence[str] = ()
    option: str = "--out"
    page: bool = False

    def require(self) -> None:
        """Refuse a path that no picture can have.

        Raises
        ------
        SystemDescriptionError
            If the suffix is not that of a format, or the path is a folder.
        MissingPartError
            If the file is a page, and Bokeh is not installed.
        """
        if self.path is None:
            return
        page = self.page and is_page(self.path)
        if page and self.dark:
            msg = f"--dark is for pictures; {self.path} is a page, which has a button for that."
            raise SystemDescriptionError(msg)
        if page:
            require("bokeh")
        else:
            require_picture(self.path, SystemDescriptionError, (*FORMATS, *MOVING, *((PAGE,) if self.page else ())))
        if self._moves and self.names:
            msg = f"{self.path}: a moving picture shows the arm and no chosen columns; leave {self.names[0]} out."
            raise SystemDescriptionError(msg)
        if self.path.is_dir():
            msg = f"{self.path} is a folder; a file for the picture is needed."
            raise SystemDescriptionError(msg)

    @property
    def _moves(self) -> bool:
        return self.path is not None and self.path.suffix.lower() in MOVING

    def make_folder(self) -> None:
        """Make the folder of the file; errors are those of `require_folder`."""
        if self.path is not None:
            require_folder(self.path.parent, self.option)

    def draw(self, results: Mapping[str, Result], systems: Mapping[str, System] | None = None) -> None:
        """Draw results by their labels, or write a page about them, and say what was written.

        Parameters
        ----------
        systems
            Systems that were run, by the label of the run; a page tells more with them.

        Raises
        ------
        OrchestrationError
            If a name chooses no column, or the file cannot be written.
        """
        if self.path is None:
            return
        if is_page(self.path):
            write_page_of(results, systems or {}, self.path)
            return
        let_matplotlib_write()
        from matplotlib import rc_context

        from orchestration.paper.figures.theme import DARK_PAGE, LIGHT_PAGE
        from orchestration.results.picture_file import save

        existed = self.path.exists()
        theme = DARK_PAGE if self.dark else LIGHT_PAGE
        _require_rows(results)
        with rc_context(theme.settings()):
            if self._moves:
                self._move(results, theme, self.path)
            else:
                save(self._figure(results), self.path)
        output.say(written(self.path, existed=existed))

    @staticmethod
    def _move(results: Mapping[str, Result], theme: "Theme", path: Path) -> None:
        """The arm of one run, moving."""
        from orchestration.paper.figures.moving import moving_picture

        if len(results) > 1:
            msg = f"{path}: a moving picture shows one result, and {len(results)} were given."
            raise SystemDescriptionError(msg)
        for label, result in results.items():
            moving_picture(label, result, theme, path)

    def _figure(self, results: Mapping[str, Result]) -> "Figure":
        """The panels of the paper, or else panels by unit, which is said."""
        from orchestration.paper.figures.overlay import missing_columns, overlay_figure, tasks
        from orchestration.paper.figures.theme import DARK_PAGE, LIGHT_PAGE
        from orchestration.results.plotting import figure_by_unit

        title = ", ".join(dict.fromkeys(result.metadata.get("system", label) for label, result in results.items()))
        lacking = {label: missing_columns(result) for label, result in results.items()}
        first = next((label for label, names in lacking.items() if names), None)
        apart = tasks(results)
        if not self.names and first is None and len(apart) == 1:
            return overlay_figure(results, DARK_PAGE if self.dark else LIGHT_PAGE, title)
        if not self.names and first is not None:
            columns = " and ".join(filter(None, (", ".join(lacking[first][:-1]), lacking[first][-1])))
            output.remark(f"Notice: {first} has no {columns} of the paper's loop, so each unit has a panel.")
        elif not self.names:
            arms = " and ".join(f"{label} has {size}" for size, label in apart.items())
            output.remark(f"Notice: {arms} task coordinates, so each unit has a panel.")
        return figure_by_unit(results, self.names, title)


def _require_rows(results: Mapping[str, Result]) -> None:
    for label, result in results.items():
        if not len(result.time):
            msg = f"{label}: the result has no rows, so there is nothing to draw; record at least one step."
            raise SystemDescriptionError(msg)


def plot_results(words: Sequence[str], out: Path | None, *, dark: bool) -> None:
    """Draw the results among the words into a file; the other words are names of columns.

    Parameters
    ----------
    out
        Default: the name of the first result with ``.png``, in the current folder.

    Raises
    ------
    OrchestrationError
        If no word is a file of a result, a file cannot be read, or the picture cannot be written.
    """
    files = [Path(word) for word in words if Path(word).suffix.lower() in READERS]
    names = [word for word in words if Path(word).suffix.lower() not in READERS]
    if not files:
        msg = f"{names[0]}: a result to draw is needed, a file with the suffix .csv or .parquet."
        raise SystemDescriptionError(msg)
    if len(files) > MOST_RESULTS:
        msg = f"{len(files)} results were given, and colours tell {MOST_RESULTS} apart; draw fewer in one picture."
        raise SystemDescriptionError(msg)
    picture = PictureRequest(out or Path(f"{files[0].stem}.png"), dark, names)
    picture.require()
    with watched() as line:
        line.begin("drawing")
        results = {label: Result.read(file) for label, file in zip(labels(files), files, strict=True)}
        picture.make_folder()
        picture.draw(results)


def labels(files: Sequence[Path]) -> list[str]:
    """Short names of files, each another one: the name without the suffix, or else the path.

    Raises
    ------
    SystemDescriptionError
        If a file is given twice.
    """
    twice = next((file for place, file in enumerate(files) if file in files[:place]), None)
    if twice is not None:
        msg = f"{twice} is given twice; name each result once."
        raise SystemDescriptionError(msg)
    stems = [file.stem for file in files]
    return [file.stem if stems.count(file.stem) == 1 else str(file) for file in files]
