"""Where the description of a system lies: in a package, an unpacked folder or an .ssd file, and in which variant.

A package may have several files ``*.ssd`` beside each other, which describe variants of one system.
``SystemStructure.ssd`` is the default (SSP 1.0, section 4.1).
"""

from pathlib import Path

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion
from orchestration.sandbox.missing import require_file

DEFAULT = "SystemStructure.ssd"
SUFFIX = ".ssd"


def is_unpacked(path: Path) -> bool:
    """Whether a path is that of a folder or of an .ssd file, which need no unpacking."""
    return path.is_dir() or path.suffix.lower() == SUFFIX


def unpacked_place(path: Path) -> tuple[Path, str]:
    """Return the folder of a system that is a folder or an .ssd file, and the name of the .ssd file in the folder.

    Raises
    ------
    ArchiveError
        If there is no such file.
    """
    if path.is_dir():
        return path.resolve(), DEFAULT
    require_file(path, "system")
    return path.resolve().parent, path.name


def variants_in(folder: Path) -> list[str]:
    """Return the names of the variants in a folder, without the suffix, the default one first."""
    found = sorted(file.stem for file in folder.iterdir() if file.suffix.lower() == SUFFIX and file.is_file())
    default = Path(DEFAULT).stem
    return sorted(found, key=lambda name: name != default)


def chosen(path: Path, folder: Path, main: str, variant: str | None) -> str:
    """Return the name of the .ssd file of a variant, which may be given with its suffix or without.

    Parameters
    ----------
    path
        What the user gave, for messages.
    folder
        Folder with the .ssd files.
    main
        File that is taken without a variant.
    variant
        Name of the variant; None if the user wants none.

    Raises
    ------
    SystemDescriptionError
        If there is no such variant, or there are several and none is the default. The message has their list.
    """
    known = variants_in(folder)
    if variant is None:
        if known and not (folder / main).exists():
            msg = f"{path} has no {main}; choose one of its variants, {', '.join(known)}."
            raise SystemDescriptionError(msg)
        return main
    wanted = variant[: -len(SUFFIX)] if variant.lower().endswith(SUFFIX) else variant
    files = {file.stem: file.name for file in folder.iterdir() if file.suffix.lower() == SUFFIX and file.is_file()}
    if wanted not in files:
        msg = f"{path} has no variant {variant}; {suggestion(wanted, known)}"
        raise SystemDescriptionError(msg)
    return files[wanted]
