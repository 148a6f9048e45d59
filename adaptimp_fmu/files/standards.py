"""Files of the standards FMI and SSP that come from the package fmpy: schemas, and the library that formats messages.

The wheel of adaptimp carries those that running needs, so that running does not need fmpy. A checkout has none, and
takes them from fmpy, which is found without being imported: that would take half a second.
"""

from importlib.util import find_spec
from pathlib import Path

from adaptimp_fmu.files.parts import MissingPartError

CARRIED = Path(__file__).parents[1] / "standards"
"""Folder in the wheel; files have the places that they have in fmpy."""
CARRIED_FOLDERS = ("schema/fmi2", "ssp/schema", "logging/linux64", "logging/darwin64", "logging/win64")
"""Folders of fmpy that the wheel carries."""


def standard_file(*parts: str) -> Path:
    """Return the path of a file or folder below fmpy's package folder, which need not exist.

    Raises
    ------
    MissingPartError
        If neither the wheel carries it nor fmpy is installed.

    Examples
    --------
    >>> from adaptimp_fmu.files.standards import standard_file
    >>> standard_file("schema", "fmi2", "fmi2ModelDescription.xsd").exists()
    True
    """
    carried = CARRIED.joinpath(*parts)
    if carried.exists():
        return carried
    found = find_spec("fmpy")
    if found is None or found.origin is None:
        package, part = "fmpy", "build"
        raise MissingPartError(package, part)
    return Path(found.origin).parent.joinpath(*parts)
