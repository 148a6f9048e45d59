"""Writes what the wheel carries besides its modules: FMUs for all platforms, programs, scenarios, and the manifest.

    python -m orchestration.paper.carry FOLDER

The wheel carries the FMUs of `MODELS`, and of `VARIANTS` those that a scenario of ``adaptimp list`` runs. The others
are built when somebody names one, which needs the part ``build``. The same sources and the same toolchain give the
same bytes.
"""

import hashlib
import io
import json
import os
import sys
import tarfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from adaptimp_fmu import PLATFORMS
from adaptimp_fmu.files.temporary_folder import temporary_folder
from adaptimp_fmu.files.whole_file import write_whole
from fmus.carried import MANIFEST, definitions_hash
from fmus.carried import SCENARIOS as ARCHIVE
from fmus.catalog import MODELS, VARIANTS
from orchestration.paper.built_fmus import built_model
from orchestration.paper.page.live_data import programs
from orchestration.paper.scenarios import ALL_SCENARIOS, SCENARIOS
from orchestration.paper.scenarios import VARIANTS as COMPARED

_PRESET = 9  # of xz: its memory of 64 MB holds all packages


def carry(folder: Path) -> None:
    """Write the files and the manifest into a folder.

    Raises
    ------
    OrchestrationError
        If an FMU cannot be built.
    """
    models = {name: declare() for name, declare in (MODELS | VARIANTS).items()}
    carried = [models[name] for name in carried_names()]
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # each waits for a compiler
        built = list(pool.map(lambda model: built_model(model, folder, PLATFORMS.values()), carried))
    fmus = {path.stem: path for path in built}
    for program in programs().values():
        write_whole(folder / f"{program.record['description']['identity']}.wasm", program.module)
    with temporary_folder() as place:
        packages = [s.system(fmus).write(place / f"{s.name}.ssp") for s in (SCENARIOS | COMPARED).values()]
        write_whole(folder / ARCHIVE, archived(packages))
    files = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.iterdir())}
    known = {
        "definitions": definitions_hash(),
        "fmus": {name: model.description for name, model in models.items()},
        "files": files,
    }
    write_whole(folder / MANIFEST, f"{json.dumps(known, indent=2)}\n".encode())


def carried_names() -> list[str]:
    """Return the identifiers of the FMUs that the wheel carries, in the order of the catalog."""
    run = {identifier for scenario in ALL_SCENARIOS.values() for identifier in scenario.models.values()}
    return [name for name in MODELS | VARIANTS if name in MODELS or name in run]


def archived(packages: Sequence[Path]) -> bytes:
    """Return files as a ``tar.xz`` archive whose bytes depend on names and contents alone.

    The packages hold the same FMUs, which the compression finds: 1.4 MB in the place of 8.4 MB.
    """
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:xz", format=tarfile.USTAR_FORMAT, preset=_PRESET) as archive:
        for path in sorted(packages):
            about = tarfile.TarInfo(path.name)
            about.size = path.stat().st_size
            with path.open("rb") as file:
                archive.addfile(about, file)
    return buffer.getvalue()


if __name__ == "__main__":
    carry(Path(sys.argv[1]))
