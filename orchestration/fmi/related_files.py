"""Reads which files an FMU carries beside its definition, such as reference runs and parameter sets (FMI-LS-REF).

Anyone may add to these files, or remove some of them, so the FMU may lack files that its manifest names.
"""

from dataclasses import dataclass
from pathlib import Path

from orchestration.fmi.document import DocumentError
from orchestration.sandbox.archive import read_entries
from orchestration.sandbox.xml import LARGEST, XmlError, parse_xml

MANIFEST = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml"


@dataclass(frozen=True)
class RelatedFile:
    """A file that the manifest of an FMU names.

    Attributes
    ----------
    source
        Address of the file, relative to the manifest.
    role
        What the file is for, such as ``parameter`` or ``experiment/smoke-test``.
    labels
        Names by which a tool can choose files, such as ``variant:fig5``.
    """

    source: str
    role: str
    type: str
    description: str
    labels: tuple[str, ...]


def related_files(path: Path) -> tuple[RelatedFile, ...]:
    """Return what the manifest of an FMU names, in its order; nothing if the FMU has no manifest.

    Raises
    ------
    DocumentError
        If the manifest is too large or damaged.
    ArchiveError
        If the archive is missing, invalid or unsafe.
    """
    content = dict(read_entries(path, [MANIFEST], LARGEST + 1)).get(MANIFEST)
    if content is None:
        return ()
    if len(content) > LARGEST:
        msg = f"{MANIFEST} has more than {LARGEST} bytes."
        raise DocumentError(msg)
    try:
        root = parse_xml(content)
    except XmlError as failed:
        msg = f"{MANIFEST} {failed}."
        raise DocumentError(msg) from failed
    return tuple(
        RelatedFile(
            one.get("source", ""),
            one.get("role", ""),
            one.get("type", ""),
            one.get("description", ""),
            tuple(label.get("name", "") for label in one.iterfind("Label")),
        )
        for one in root.iterfind("Related")
    )
