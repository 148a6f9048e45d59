"""Wrong files: missing, empty, damaged, folders, of another kind."""

import zipfile
from pathlib import Path

from orchestration import ArchiveError, Component, Fmu, Result, Snapshot, System, stream
from tests.faults.wrong_inputs.case import Bench, Wrong, made


def _written(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def _cut(b: Bench, name: str) -> Path:
    """An FMU of which a part was lost on its way."""
    whole = b.fmu("Plant").read_bytes()
    return _written(b.folder / name, whole[: len(whole) // 2])


def _flipped(b: Bench, name: str) -> Path:
    """An FMU with damaged bytes in its first entry, modelDescription.xml."""
    content = bytearray(b.fmu("Plant").read_bytes())
    content[100:140] = bytes(40)
    return _written(b.folder / name, bytes(content))


def _archive(b: Bench, name: str, entries: dict[str, str]) -> Path:
    path = b.folder / name
    with zipfile.ZipFile(path, "w") as archive:
        for entry, text in entries.items():
            archive.writestr(entry, text)
    return path


def _folder(b: Bench, name: str) -> Path:
    (b.folder / name).mkdir()
    return b.folder / name


def _near(b: Bench, wrong: str, name: str) -> Path:
    _written(b.folder / name, b.fmu("Plant").read_bytes())
    return b.folder / wrong


FMI3 = '<fmiModelDescription fmiVersion="3.0" modelName="A"><CoSimulation/></fmiModelDescription>'
ME = '<fmiModelDescription fmiVersion="2.0" modelName="A" guid="x"><ModelExchange/></fmiModelDescription>'

TABLE = (
    Wrong(
        "an FMU whose file name is mistyped",
        lambda b: System.of({"plant": _near(b, "Plnt.fmu", "Plant.fmu")}),
        "Plnt.fmu",
        "there is no such FMU|Plant.fmu",
        "did you mean",
        ArchiveError,
    ),
    Wrong(
        "an FMU in a folder that does not exist",
        lambda b: Component.read(b.folder / "bulit" / "Plant.fmu"),
        "Plant.fmu|no such FMU",
        "bulit",
        "there is no folder",
        ArchiveError,
    ),
    Wrong(
        "an empty file as FMU",
        lambda b: Component.read(_written(b.folder / "a.fmu", b"")),
        "a.fmu",
        "is empty",
        "again",
        ArchiveError,
    ),
    Wrong(
        "a text as FMU",
        lambda b: Component.read(_written(b.folder / "a.fmu", b"hello")),
        "a.fmu",
        "zip archive",
        "again",
        ArchiveError,
    ),
    Wrong("half an FMU", lambda b: Fmu(_cut(b, "a.fmu")), "a.fmu", "zip archive|damaged", "again", ArchiveError),
    Wrong("an FMU with damaged bytes", lambda b: Fmu(_flipped(b, "a.fmu")), "a.fmu", "damaged", "again", ArchiveError),
    Wrong("a folder as FMU", lambda b: Fmu(_folder(b, "a.fmu")), "a.fmu", "is a folder", ".fmu file", ArchiveError),
    Wrong(
        "an SSP package as FMU",
        lambda b: System.of({"loop": b.package}),
        "loop.ssp",
        "modelDescription.xml|SSP package",
        "System.read",
        ArchiveError,
    ),
    Wrong(
        "an archive without a model description",
        lambda b: Component.read(_archive(b, "a.fmu", {"readme.txt": "x"})),
        "a.fmu",
        "modelDescription.xml",
        "FMU",
        ArchiveError,
    ),
    Wrong(
        "an FMU of FMI 3.0",
        lambda b: Component.read(_archive(b, "a.fmu", {"modelDescription.xml": FMI3})),
        "a.fmu",
        "FMI 3.0|FMI 2.0",
        "is needed",
        ArchiveError,
    ),
    Wrong(
        "an FMU for model exchange",
        lambda b: Component.read(_archive(b, "a.fmu", {"modelDescription.xml": ME})),
        "a.fmu",
        "model exchange|co-simulation",
        "is needed",
        ArchiveError,
    ),
    Wrong(
        "an FMU as package",
        lambda b: System.read(b.fmu("Plant")),
        "Plant.fmu",
        "FMU|SSP package",
        "System.of",
        ArchiveError,
    ),
    Wrong(
        "a package that is missing",
        lambda b: System.read(b.package.with_name("lop.ssp")),
        "lop.ssp",
        "there is no such package|loop.ssp",
        "did you mean",
        ArchiveError,
    ),
    Wrong("a file name that is a number", made(System.read, 5), "file is 5", "int|path", "give"),
    Wrong("None as FMU", made(Component.read, None), "None", "path", "give"),
    Wrong(
        "a system written as an FMU",
        lambda b: b.loop.write(b.folder / "loop.fmu"),
        "loop.fmu",
        ".fmu|.ssp",
        "written as .ssp",
    ),
    Wrong(
        "a result that is missing",
        lambda b: Result.read(b.folder / "run1.csv"),
        "run1.csv",
        "no such file",
        "its folder has no .csv file",
    ),
    Wrong(
        "a result of an unknown format",
        lambda b: b.result.write(b.folder / "a.xlsx"),
        "a.xlsx",
        ".xlsx|.csv or .parquet",
        "results are written as",
    ),
    Wrong(
        "a result that is no table",
        lambda b: Result.read(_written(b.folder / "a.parquet", b"hello")),
        "a.parquet",
        "5 bytes|Parquet file",
        "Result.write",
    ),
    Wrong(
        "a table that is no result",
        lambda b: Result.read(_written(b.folder / "a.csv", b"x,y\n1,2\n")),
        "a.csv",
        "time|x",
        "first column",
    ),
    Wrong(
        "a result in a folder that is a file",
        lambda b: b.result.write(_written(b.folder / "a", b"") / "a.csv"),
        "a.csv",
        "cannot be written",
        "choose another place",
    ),
    Wrong(
        "a snapshot that is a text",
        lambda b: Snapshot.read(_written(b.folder / "a.npz", b"hello")),
        "a.npz",
        "is not a snapshot",
        "Snapshot.write",
    ),
    Wrong(
        "a snapshot that is missing",
        lambda b: Snapshot.read(b.folder / "a.npz"),
        "a.npz",
        "no such snapshot",
        "its folder has no .npz file",
    ),
    Wrong(
        "rows streamed as CSV",
        lambda b: stream(b.folder / "a.csv", b.loop, 1e-3),
        "a.csv",
        ".csv|.parquet",
        "simulate",
    ),
)
