"""Writes what the wheel carries besides its modules: FMUs for all platforms, scenarios, and the manifest of both.

    python -m orchestration.paper.carry FOLDER

The same sources and the same toolchain give the same bytes.
"""

import hashlib
import json
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from adaptimp_fmu import PLATFORMS
from adaptimp_fmu.files.whole_file import write_whole
from fmus.carried import MANIFEST, definitions_hash
from fmus.catalog import MODELS, VARIANTS
from orchestration.paper.built_fmus import built_model
from orchestration.paper.scenarios import SCENARIOS
from orchestration.paper.scenarios import VARIANTS as COMPARED


def carry(folder: Path) -> None:
    """Write the files and the manifest into a folder.

    Raises
    ------
    OrchestrationError
        If an FMU cannot be built.
    """
    models = [declare() for declare in (MODELS | VARIANTS).values()]
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # each waits for a compiler
        built = list(pool.map(lambda model: built_model(model, folder, PLATFORMS.values()), models))
    fmus = {path.stem: path for path in built}
    for scenario in (SCENARIOS | COMPARED).values():
        scenario.system(fmus).write(folder / f"{scenario.name}.ssp")
    files = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.iterdir())}
    known = {
        "definitions": definitions_hash(),
        "fmus": {model.name: model.description for model in models},
        "files": files,
    }
    write_whole(folder / MANIFEST, f"{json.dumps(known, indent=2)}\n".encode())


if __name__ == "__main__":
    carry(Path(sys.argv[1]))
