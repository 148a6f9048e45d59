"""What a module of WebAssembly imports, read from its bytes (WebAssembly Core Specification, section 5.5)."""

_MAGIC = b"\0asm\1\0\0\0"
_IMPORTS = 2  # number of the section
_FUNCTION = 0


def imported_names(module: bytes) -> list[str]:
    r"""Return the names that a module imports, in their order, up to the first that is not a function.

    Parameters
    ----------
    module
        Content of a file that the linker has made.

    Raises
    ------
    ValueError
        If these are not the bytes of a module.

    Examples
    --------
    >>> from orchestration.containers.wasm.imports import imported_names
    >>> imported_names(b"\0asm\1\0\0\0" + b"\2\7\1\1a\1f\0\0")
    ['f']
    """
    if not module.startswith(_MAGIC):
        msg = "These are not the bytes of a module of WebAssembly."
        raise ValueError(msg)
    at = len(_MAGIC)
    while at < len(module):
        section, (size, at) = module[at], _number(module, at + 1)
        if section == _IMPORTS:
            return _functions(module, at)
        at += size
    return []


def _functions(module: bytes, at: int) -> list[str]:
    """Names in the section that begins at a place."""
    count, at = _number(module, at)
    names = []
    for _ in range(count):
        _, at = _text(module, at)
        name, at = _text(module, at)
        names.append(name)
        if module[at] != _FUNCTION:
            break
        _, at = _number(module, at + 1)
    return names


def _text(module: bytes, at: int) -> tuple[str, int]:
    """A text, and the place behind it."""
    length, at = _number(module, at)
    return module[at : at + length].decode(), at + length


def _number(module: bytes, at: int) -> tuple[int, int]:
    """An unsigned number of 7 bits in each byte, the lowest first, and the place behind it."""
    value = shift = 0
    while module[at] & 0x80:
        value |= (module[at] & 0x7F) << shift
        shift, at = shift + 7, at + 1
    return value | module[at] << shift, at + 1
