"""Parts of the installation: which optional package belongs to which, and one error for those that are missing.

The core of adaptimp runs systems of FMUs. The other parts are extras of the package, such as ``adaptimp[build]``.
"""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

PARTS = {
    "casadi": "build",
    "fmpy": "build",
    "latex2mathml": "build",
    "ziglang": "build",
    "pyarrow": "files",
    "bokeh": "report",
    "scipy": "studies",
    "distributed": "cluster",
    "cloudpickle": "cluster",
    "SALib": "sensitivity",
    "optuna": "tuning",
}
"""Part that brings a package, by the name under which Python imports the package."""
GIVES = {
    "build": "builds FMUs and programs from equations",
    "files": "keeps results in Parquet files and runs in stores",
    "studies": "draws samples and optimizes",
    "paper": "measures the claims of the paper",
    "report": "writes pages about runs",
    "cluster": "makes runs on several machines",
    "sensitivity": "computes sensitivity indices",
    "tuning": "tunes gains by Optuna",
}
"""What each part does, by its name."""


class MissingPartError(ImportError):
    """A part of adaptimp that is needed is not installed; the message has the command that installs it.

    Parameters
    ----------
    package, part
        The package that is missing, and the part of adaptimp that brings it.
    what
        What needs the package: the subject of the message's first sentence, and any sentences before.

    Examples
    --------
    >>> from adaptimp_fmu.files.parts import MissingPartError
    >>> print(MissingPartError("pyarrow", "files"))
    This needs pyarrow, which is not installed. The part "files" of adaptimp has it and reads and writes results ...
    """

    def __init__(self, package: str, part: str, what: str = "This") -> None:
        self.part = part
        super().__init__(
            f'{what} needs {package}, which is not installed. The part "{part}" of adaptimp has it and {GIVES[part]};'
            f' install it: pip install "adaptimp[{part}]"',
            name=package,
        )


def imported(module: str, part: str | None = None) -> ModuleType:
    """Import a module that may need an optional package.

    Parameters
    ----------
    module
        Name of an optional package, or of a module that imports some.
    part
        The part to install if a package is missing. Default: that of the package in `PARTS`.

    Raises
    ------
    MissingPartError
        If an optional package is missing.

    Examples
    --------
    >>> from adaptimp_fmu.files.parts import imported
    >>> imported("casadi").__name__
    'casadi'
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        missing = missing_part(error, part)
        if missing is None:
            raise
        raise missing from error


def has(package: str) -> bool:
    """Return whether an optional package is installed, without importing it.

    Examples
    --------
    >>> from adaptimp_fmu.files.parts import has
    >>> has("ziglang")
    True
    """
    return find_spec(package) is not None


def lacks(part: str) -> list[str]:
    """Return the packages of a part that are not installed.

    Examples
    --------
    >>> from adaptimp_fmu.files.parts import lacks
    >>> lacks("build")
    []
    """
    return [package for package, its_part in PARTS.items() if its_part == part and not has(package)]


def require(package: str, part: str | None = None) -> None:
    """Refuse work that needs an optional package, before any work is done.

    Parameters
    ----------
    part
        The part to install if the package is missing. Default: that of the package in `PARTS`.

    Raises
    ------
    MissingPartError
        If the package is missing.

    Examples
    --------
    >>> from adaptimp_fmu.files.parts import require
    >>> require("pyarrow")
    """
    if not has(package):
        raise MissingPartError(package, part or PARTS[package])


def missing_part(error: ImportError, part: str | None = None) -> MissingPartError | None:
    """Return the error of a missing part for one of an import; None if the import has failed for another reason."""
    if isinstance(error, MissingPartError):
        return error
    package = (error.name or "").partition(".")[0]
    return MissingPartError(package, part or PARTS[package]) if package in PARTS else None
