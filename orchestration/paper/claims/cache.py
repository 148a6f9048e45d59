"""Keeps measured claims for a later run with the same inputs, for measuring takes most of a minute.

The key is a hash of everything that decides the claims: the scenarios' SSP packages (FMUs and numbers), the
source of all packages, and the versions of the numerical libraries. Machine code lies in a folder named
by its sources (`orchestration.fmi.machine_code`), so numbers under a hash come from the sources of that hash.
"""

import hashlib
import importlib.metadata
import importlib.resources
import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

from adaptimp_fmu.files.cache_folder import cache_folder, writable_cache
from adaptimp_fmu.files.sealed_file import read_sealed, write_sealed
from orchestration.paper.claims.claim import Claim

PACKAGES = ("adaptimp_fmu", "fmus", "orchestration")
LIBRARIES = ("casadi", "numba", "numpy", "fmpy")


def claims_of(
    digests: Mapping[str, str], measure: Callable[[], list[Claim]], *, fresh: bool
) -> tuple[list[Claim], bool]:
    """The claims that an earlier run with the same inputs has measured, or new ones.

    Parameters
    ----------
    digests
        SHA-256 of each scenario's package.
    fresh
        Whether to measure in any case.

    Returns
    -------
    tuple
        The claims, and whether an earlier run has measured them.
    """
    name = f"{_key(digests)}.json"
    kept = None if fresh else read_sealed(cache_folder() / "claims" / name)
    if kept is not None:
        return [Claim(**{**record, "margins": tuple(record["margins"])}) for record in json.loads(kept)], True
    claims = measure()
    write_sealed(writable_cache("claims") / name, json.dumps([asdict(claim) for claim in claims]).encode())
    return claims, False


def _key(digests: Mapping[str, str]) -> str:
    key = hashlib.sha256(json.dumps(dict(digests), sort_keys=True).encode())
    for library in LIBRARIES:
        with suppress(importlib.metadata.PackageNotFoundError):
            key.update(f"{library} {importlib.metadata.version(library)}\n".encode())
    for package in PACKAGES:
        root = Path(str(importlib.resources.files(package)))
        for path in sorted(root.rglob("*.py")):
            key.update(path.relative_to(root).as_posix().encode())
            key.update(path.read_bytes())
    return key.hexdigest()[:32]
