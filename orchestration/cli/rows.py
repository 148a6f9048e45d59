"""Writes the rows of a run to the file that was asked for, and those of a run that ended early beside it."""

from dataclasses import dataclass
from pathlib import Path

from adaptimp_fmu.files.parts import require
from orchestration.cli.output import output
from orchestration.cli.places import require_folder, written
from orchestration.cli.report import RunReport
from orchestration.errors import RecordedRows, SystemDescriptionError
from orchestration.results.extremes import extremes, extremes_of_file
from orchestration.results.places import partial_path
from orchestration.results.result import Result

STREAMED = ".parquet"
FORMATS = (".csv", STREAMED)


@dataclass(frozen=True)
class Destination:
    """A file for the rows of a run, or none.

    Attributes
    ----------
    path
        The file; None if the rows go nowhere.
    present
        Which of the file and of that for the rows of a failed run there were before.
    """

    path: Path | None
    present: frozenset[Path]

    @classmethod
    def of(cls, path: Path | None) -> "Destination":
        """The destination of a path.

        Raises
        ------
        SystemDescriptionError
            If the suffix is not that of a format, or the path is a folder.
        """
        if path is None:
            return cls(None, frozenset())
        if path.suffix not in FORMATS:
            msg = f"{path}: results are written as {' or '.join(FORMATS)}."
            raise SystemDescriptionError(msg)
        if path.suffix == STREAMED:
            require("pyarrow")
        if path.is_dir():
            msg = f"{path} is a folder; a file for the result is needed."
            raise SystemDescriptionError(msg)
        return cls(path, frozenset(file for file in (path, partial_path(path)) if file.exists()))

    @property
    def streamed(self) -> Path | None:
        """The file, if rows go there while the run makes them."""
        return self.path if self.path is not None and self.path.suffix == STREAMED else None

    def make_folder(self) -> None:
        """Make the folder of the file; errors are those of `require_folder`."""
        if self.path is not None:
            require_folder(self.path.parent)

    def complete(self, result: Result, report: RunReport) -> None:
        """Write all rows, unless they are already written."""
        if self.path is None:
            report.extremes = extremes([result])
            return
        if self.streamed is None:
            result.write(self.path)
        said = self._written(self.path, report)
        output.say(f"{said}: {report.rows} rows, {len(result)} columns")
        if output.data_only:
            report.extremes = extremes_of_file(self.path) if self.streamed else extremes([result])

    def partial(self, result: RecordedRows | None, report: RunReport, when: str) -> None:
        """Write the complete rows of a run that ended early; rows in a Parquet file are already written."""
        if not isinstance(result, Result):
            return
        if self.streamed is None:
            report.rows, report.extremes = len(result.time), extremes([result])
        if self.path is None:
            return
        file = partial_path(self.path)
        if self.streamed is None:
            result.write(file)
        elif not file.is_file():
            return
        elif output.data_only:
            report.extremes = extremes_of_file(file)
        output.remark(f"{self._written(file, report)}: the {report.rows} rows {when}")

    def _written(self, file: Path, report: RunReport) -> str:
        report.file, report.replaced = file, file in self.present
        return written(file, existed=report.replaced)
