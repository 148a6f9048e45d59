"""The shared libraries of other platforms, read from their headers: checklist 7 and 8 without running them."""

import re
import struct
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

from tests.conformance import elf
from tests.conformance.binary import FUNCTIONS
from tests.conformance.platforms import macho, pe

Content = Callable[[str, str], bytes]
AARCH64 = 183  # e_machine of ELF
DARWIN = {"darwin64": macho.X86_64, "aarch64-darwin": macho.ARM64}
# zig's linker lists the addresses of the library's own header, which others never look up.
DARWIN_HEADER = {"__mh_dylib_header", "___dso_handle"}
# The functions of <math.h>, those that compilers make of them included.
MATHEMATICS = {
    *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "ceil", "copysign", "cos", "cosh", "erf"),
    *("erfc", "exp", "exp2", "expm1", "fabs", "fdim", "floor", "fma", "fmax", "fmin", "fmod", "frexp", "hypot"),
    *("ilogb", "ldexp", "lgamma", "llrint", "llround", "log", "log10", "log1p", "log2", "logb", "lrint", "lround"),
    *("modf", "nan", "nearbyint", "nextafter", "pow", "remainder", "remquo", "rint", "round", "scalbln", "scalbn"),
    *("sin", "sincos", "__sincos_stret", "sinh", "sqrt", "tan", "tanh", "tgamma", "trunc", "_fdclass", "_dclass"),
}
MEMORY = {"bcmp", "calloc", "free", "malloc", "memcmp", "memcpy", "memmove", "memset", "bzero", "__bzero"}
TEXT = {"snprintf", "strcmp", "strcpy", "strlen", "strncmp", "strncpy", "strspn", "vsnprintf"}
# The C runtime of Windows 10 by its parts: of those that exist no files, network, processes or environment. The
# last is for what MinGW's start-up prints when it fails.
WINDOWS_RUNTIME = {f"api-ms-win-crt-{part}-l1-1-0.dll" for part in ("heap", "math", "runtime", "string", "stdio")}
KERNEL = {
    *(f"{action}CriticalSection" for action in ("Delete", "Enter", "Initialize", "Leave")),
    *("GetLastError", "Sleep", "TlsGetValue", "VirtualProtect", "VirtualQuery"),
}

darwin = pytest.mark.parametrize("platform", DARWIN)


def without_underscore(names: Iterable[str]) -> set[str]:
    """C names of a Mac's symbols."""
    return {name.removeprefix("_") for name in names}


@darwin
def test_08_darwin_is_a_library_for_macos_11(content: Content, identifier: str, platform: str) -> None:
    library = macho.read(content(identifier, platform))
    assert library.processor == DARWIN[platform]
    assert library.kind == macho.DYLIB
    assert (library.platform, library.minimum) == (macho.MACOS, (11, 0))


@darwin
def test_08_darwin_exports_the_34_functions(content: Content, identifier: str, platform: str) -> None:
    library = macho.read(content(identifier, platform))
    assert without_underscore(library.exported - DARWIN_HEADER) == set(FUNCTIONS)


@darwin
def test_08_darwin_needs_the_system_only(content: Content, identifier: str, platform: str) -> None:
    library = macho.read(content(identifier, platform))
    assert library.needed == ("/usr/lib/libSystem.B.dylib",)
    assert library.install_name == f"@rpath/{identifier}.dylib"
    assert library.search_paths == ()
    assert without_underscore(library.imported - {"dyld_stub_binder"}) <= MEMORY | TEXT


def test_08_apple_processors_find_it_signed(content: Content, identifier: str) -> None:
    """On ARM, macOS ends a process that maps a page without a matching signature, ad hoc at least."""
    signature = macho.read(content(identifier, "aarch64-darwin")).signature
    assert signature == macho.Signature(f"{identifier}.dylib", ad_hoc=True, pages_match=True)


def test_08_a_changed_page_does_not_match_its_signature(content: Content) -> None:
    data = bytearray(content("Plant", "aarch64-darwin"))
    data[0x2000] ^= 1
    signature = macho.read(bytes(data)).signature
    assert signature is not None
    assert not signature.pages_match


def test_08_windows_exports_the_34_functions(content: Content, identifier: str) -> None:
    library = pe.read(content(identifier, "win64"))
    assert (library.processor, library.is_dll, library.name) == (pe.X86_64, True, f"{identifier}.dll")
    assert sorted(library.exported) == sorted(FUNCTIONS)


def test_08_windows_needs_the_system_only(content: Content, identifier: str) -> None:
    imported = pe.read(content(identifier, "win64")).imported
    assert set(imported) <= WINDOWS_RUNTIME | {"kernel32.dll"}
    assert set(imported["kernel32.dll"]) <= KERNEL


def test_07_windows_has_no_date_and_no_path(content: Content, identifier: str) -> None:
    """The header's date is a hash, and no debug entry names a symbol file."""
    assert pe.read(content(identifier, "win64")).debug == (pe.REPRODUCIBLE,)


def test_08_linux_on_arm_exports_the_34_functions(content: Content, identifier: str, tmp_path: Path) -> None:
    library = arm_library(content, identifier, tmp_path)
    assert library.exported == set(FUNCTIONS)


def test_08_linux_on_arm_needs_libc_of_glibc_2_17(content: Content, identifier: str, tmp_path: Path) -> None:
    library = arm_library(content, identifier, tmp_path)
    assert set(library.needed) <= {"libc.so.6"}
    assert library.search_paths == ()
    assert library.versions == {"GLIBC_2.17"}
    assert library.imported <= MEMORY | TEXT


@pytest.mark.parametrize("platform", ["linux64", "win64", "darwin64", "aarch64-linux", "aarch64-darwin"])
def test_08_mathematics_is_its_own(content: Content, identifier: str, platform: str, tmp_path: Path) -> None:
    """A function of the C library would give each system results of its own."""
    assert names_imported(content(identifier, platform), platform, tmp_path) & MATHEMATICS == set()


def names_imported(data: bytes, platform: str, folder: Path) -> set[str]:
    """C names of all functions that a library needs."""
    if platform == "win64":
        return {name for names in pe.read(data).imported.values() for name in names}
    if platform in DARWIN:
        return without_underscore(macho.read(data).imported)
    file = folder / "library.so"
    file.write_bytes(data)
    return set(elf.read(file).imported)


def arm_library(content: Content, identifier: str, folder: Path) -> elf.Library:
    """The dynamic section of aarch64-linux's library, once its processor is checked."""
    file = folder / f"{identifier}.so"
    file.write_bytes(content(identifier, "aarch64-linux"))
    assert struct.unpack_from("<H", file.read_bytes(), 18) == (AARCH64,)
    return elf.read(file)


@pytest.mark.parametrize("platform", ["win64", "darwin64", "aarch64-linux", "aarch64-darwin"])
def test_07_no_trace_of_where_it_was_built(content: Content, identifier: str, platform: str) -> None:
    data = content(identifier, platform)
    assert not re.findall(rb"/(?:tmp|home|root|work|var|private)/[\w./-]*|adaptimp-\w{8}|[A-Z]:\\\\?[\w.\\ -]+", data)
