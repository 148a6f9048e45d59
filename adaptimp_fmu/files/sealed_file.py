"""Files of a cache whose content is checked before it is trusted.

A sealed file ends with the SHA-256 hash of what stands before. A file that was emptied, cut off or altered, and a file
that another user wrote, count as missing, so that they are made anew.
"""

import hashlib
from pathlib import Path

from adaptimp_fmu.files.cache_folder import is_trusted
from adaptimp_fmu.files.whole_file import whole_file

SEAL_BYTES = hashlib.sha256().digest_size


def write_sealed(path: Path, content: bytes) -> None:
    """Write a sealed file, whole or not at all.

    Raises
    ------
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.sealed_file import read_sealed, write_sealed
    >>> write_sealed(Path("kept"), b"machine code")
    >>> read_sealed(Path("kept"))
    b'machine code'
    """
    with whole_file(path) as file:
        file.write(content)
        file.write(hashlib.sha256(content).digest())


def read_sealed(path: Path) -> bytes | None:
    """Return what `write_sealed` wrote; None if there is no such file, or it cannot be trusted.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.sealed_file import read_sealed, write_sealed
    >>> write_sealed(Path("damaged"), b"machine code")
    >>> whole = Path("damaged").read_bytes()
    >>> Path("damaged").write_bytes(whole[:-1])
    43
    >>> read_sealed(Path("damaged")) is None
    True
    """
    try:
        sealed = path.read_bytes() if is_trusted(path) else b""
    except OSError:  # a file that cannot be read is as good as none
        return None
    content, seal = sealed[:-SEAL_BYTES], sealed[-SEAL_BYTES:]
    return content if len(seal) == SEAL_BYTES and hashlib.sha256(content).digest() == seal else None
