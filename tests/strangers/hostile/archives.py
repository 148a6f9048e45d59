"""FMUs whose archives break a rule of the gate, each with what must be said of it, grouped by rule."""

import struct
import zlib
from collections.abc import Callable, Sequence

from adaptimp_fmu.toolchain import host_platform
from tests.strangers.fmus import Y, description
from tests.strangers.hostile.zips import DEFLATED, DEVICE, FIFO, FOLDER, LINK, UTF_8, Row, both, deflated, zipped

HOST = host_platform()
LIBRARY = f"binaries/{HOST.name}/Stranger{HOST.extension}"
XML = description("feedthrough", [Y], outputs='<Unknown index="1" dependencies=""/>').encode()
DESCRIPTION = Row("modelDescription.xml", XML)
BASE = (DESCRIPTION, Row(LIBRARY, b"no library"))
Case = tuple[Callable[[], bytes], str]


def fmu(*rows: Row, **more) -> bytes:
    """An FMU with more entries."""
    return zipped([*BASE, *rows], **more)


def case(rule: str, *rows: Row, **more) -> Case:
    """A case of an FMU with more entries."""
    return (lambda: fmu(*rows, **more)), rule


def named(name: str | bytes, rule: str) -> Case:
    """A case of an entry with a bad name."""
    return case(rule, Row(name))


def unicode_path(raw: bytes, name: str) -> bytes:
    """The extra field that gives an entry a second name."""
    content = struct.pack("<BL", 1, zlib.crc32(raw)) + name.encode()
    return struct.pack("<2H", 0x7075, len(content)) + content


def wide(*values: int) -> bytes:
    """The extra field of sizes of 64 bits."""
    return struct.pack(f"<2H{len(values)}Q", 1, 8 * len(values), *values)


def inside(depth: int, rows: Sequence[Row], name: str = "resources/inner.fmu") -> bytes:
    """An archive in an archive in ..., the innermost of some rows."""
    content = zipped(rows)
    for _ in range(depth):
        content = zipped([*BASE, Row(name, content, DEFLATED)])
    return content


def cut(content: bytes, parts: float) -> bytes:
    """The first part of an archive."""
    return content[: int(len(content) * parts)]


def zeros(n: int, size: int) -> list[Row]:
    """Entries of zeros."""
    data = deflated(bytes(size))
    crc = zlib.crc32(bytes(size))
    return [Row(f"resources/{i}", b"", DEFLATED, data=data, **both(crc=crc, size=size)) for i in range(n)]


LINKS = {
    "a symbolic link": case("'link' is a link or device", Row("link", b"/etc/passwd", central={"attributes": LINK})),
    "a device": case("'null' is a link or device", Row("null", b"", central={"attributes": DEVICE})),
    "a named pipe": case("'pipe' is a link or device", Row("pipe", b"", central={"attributes": FIFO})),
    "a junction of Windows": case(
        "'junction' is a link or device", Row("junction", b"C:", central={"attributes": 0x400, "system": 0})
    ),
}
PATHS = {
    "a parent": named("../evil", r"'\.\./evil' leads outside the archive"),
    "a parent inside": named("resources/../../evil", "leads outside the archive"),
    "a parent at the end": named("resources/..", "leads outside the archive"),
    "an absolute path": named("/tmp/evil", "'/tmp/evil' leads outside the archive"),
    "two slashes": named("//host/evil", "leads outside the archive"),
    "a dot": named(".", "leads outside the archive"),
    "a backslash": named("..\\evil", "has a character that a path in an archive must not have"),
    "a drive": named("C:evil", "has a character that a path in an archive must not have, ':'"),
    "a stream of NTFS": named("evil.txt:stream", "has a character that a path in an archive must not have, ':'"),
    "a NUL": named("evil\0.txt", "has a character that a path in an archive must not have"),
    "a line feed": named("evil\nError: forged", "has a character that a path in an archive must not have"),
    "an escape": named("\x1b[2Jevil", "has a character that a path in an archive must not have"),
    "a change of direction": named("gpj.\u202eevil", "has a character that a path in an archive must not have"),
    "no name": named("", "has no name"),
}
WINDOWS = {  # names that are harmless elsewhere
    "CON": named("CON", "is a device there"),
    "nul with a suffix": named("resources/nul.txt", "is a device there"),
    "COM1 as a folder": named("com1/a", "is a device there"),
    "LPT with a digit above": named("LPT\u00b9", "is a device there"),
    "a dot at the end": named("resources/evil.", "ends in a dot or a space"),
    "a space at the end": named("resources/evil ", "ends in a dot or a space"),
    "a space at the end of a folder": named("evil /a", "ends in a dot or a space"),
    "a wildcard": named("evil*", r"has the character '\*'"),
    "a question": named("documentation/why?.html", r"has the character '\?'"),
}
LENGTHS = {
    "a name of 300 bytes": named("x" * 300, "has a name of 300 bytes, more than 255"),
    "a name of 300 bytes in 100 characters": named("\u4e2d" * 100, "has a name of 300 bytes, more than 255"),
    "a path of 2000 bytes": named("/".join(["x" * 199] * 10), "has a path of 1999 bytes, more than 1024"),
    "1800 folders": named("a/" * 500 + "b", "lies 501 folders deep, more than 64"),
}
ENCODINGS = {
    "a name that is not UTF-8": case("name is not UTF-8", Row(b"\xff\xfe", **both(flags=UTF_8))),
    "a second name": case(
        "with a second name", Row("a.txt", **both(extra=unicode_path(b"a.txt", "modelDescription.xml")))
    ),
    "a second name that leads outside": case(
        "leads outside the archive", Row(b"\x81", **both(flags=0, extra=unicode_path(b"\x81", "../evil")))
    ),
}
TWICE = {
    "a file twice": case("'a' occurs more than once", Row("a"), Row("a", b"other")),
    "the description twice": case("occurs more than once", DESCRIPTION),
    "names that differ in case": case("'A' occurs more than once, also as 'a'", Row("a"), Row("A")),
    "names that differ in a dot": case("occurs more than once, also as 'a'", Row("a"), Row("./a")),
    "names that differ in a slash": case("occurs more than once", Row("a/b"), Row("a//b")),
    "names that differ in composition": case("occurs more than once", Row("\u00e9"), Row("e\u0301")),
    "a sharp s": case("occurs more than once", Row("stra\u00dfe"), Row("STRASSE")),
    "a file and a folder": case("'a/b' lies in 'a', which is a file", Row("a"), Row("a/b")),
    "a file and a folder of one name": case("occurs more than once", Row("a"), Row("a/", b"")),
    "a folder with contents": case("is a folder, but has 7 bytes", Row("a/")),
    "a folder by its mode with contents": case(
        "is a folder, but has 7 bytes", Row("a", central={"attributes": FOLDER})
    ),
}
METHODS = {
    "encryption": case("'a' is encrypted", Row("a", **both(flags=1))),
    "strong encryption": case("'a' is encrypted", Row("a", **both(flags=0x40))),
    "masked headers": case("'a' is encrypted", Row("a", **both(flags=0x2000))),
    "a patch": case("is a patch of another file", Row("a", **both(flags=0x20))),
    **{
        f"method {method}": case(
            f"uses compression method {method}; only store and deflate", Row("a", **both(method=method))
        )
        for method in (1, 6, 9, 12, 14, 93, 98, 99, 65535)
    },
    "version 25.5": case("needs version 25.5 of the format", Row("a", **both(needed=255))),
}
SIZES = {
    "an entry of zeros": case("a zip bomb", *zeros(1, 2 * 1024**2)),
    "400 entries of zeros": case("more than 300 times its size: a zip bomb", *zeros(400, 1024**2)),
    "2100 entries of zeros": case("would unpack to .* bytes, more than 2147483648", *zeros(2100, 1024**2)),
    "an entry of 2 GiB": case("a zip bomb", Row("a", b"", DEFLATED, **both(size=2**31 + 1))),
    "an entry of 16 EiB": case(
        "a zip bomb",
        Row("a", b"", DEFLATED, **both(size=2**32 - 1, packed=2**32 - 1, extra=wide(2**64 - 1, 2))),
    ),
    "20,001 entries": case("has 20003 entries, more than 20000", *(Row(f"{i}", b"") for i in range(20_001))),
    "a stored entry of another size": case("is stored without compression", Row("a", **both(size=8))),
}
CONTRADICTIONS = {
    "two names": case("gives entry 'a' two values for its name", Row("a", local={"name": b"b"})),
    "two sizes": case("two values for its size: 8 and 7", Row("a", local={"size": 8})),
    "two packed sizes": case("two values for its packed size", Row("a", local={"packed": 6})),
    "two CRCs": case("two values for its CRC", Row("a", local={"crc": 1})),
    "two methods": case("two values for its compression method", Row("a", local={"method": DEFLATED})),
    "two opinions on encryption": case("two values for its encryption", Row("a", local={"flags": 1})),
    "no header": case("has no header of entry 'a'", Row("a", central={"offset": 3})),
    "a header behind the end": case("has no place for entry 'a'", Row("a", central={"offset": 2**31})),
    "data behind the end": case("packed bytes of entry 'a'", Row("a", **both(size=2**20, packed=2**20))),
    "another disk": case("'a' lies in another file", Row("a", central={"disk": 1})),
}
CONTRADICTIONS["entries that overlap"] = (
    lambda: zipped(
        [
            *BASE,
            Row("a", zipped([Row("b")])[: 30 + 1 + 7]),
            Row(
                "b", local={"name": b"b"}, central={"offset": sum(30 + len(r.name) + len(r.content) for r in BASE) + 31}
            ),
        ]
    ),
    "has entries that overlap",
)
HIDDEN = {
    "an archive before the first entry": case("hides parts of another archive", around={"before": fmu()}),
    "an archive before the directory": case("hides parts of another archive", around={"between": fmu()}),
    "a header before the directory": case("hides parts of another archive", around={"between": b"PK\x03\x04" * 8}),
    "a directory in the comment": case("another archive|no directory|cut off", around={"comment": fmu()[-300:-22]}),
    "an archive behind the end": (lambda: fmu() + zipped([Row("other")]), "is not a readable zip archive"),
    "an end that is not the last": case("is not a readable zip archive", around={"comment": b"PK\x05\x06" + b"x" * 30}),
}
ENDS = {
    "no bytes": (lambda: b"", "it is empty"),
    "text": (lambda: b"no archive at all", "there is no directory at its end"),
    "half": (lambda: cut(fmu(), 0.5), "there is no directory at its end"),
    "all but the last byte": (lambda: fmu()[:-1], "there is no directory at its end|cut off"),
    "a gzip file": (lambda: b"\x1f\x8b" + bytes(100), "there is no directory at its end"),
    "fewer entries than announced": case("has no entry 3 of 3", end={"count": 3}),
    "more entries than announced": case("bytes after the 1 entries", end={"count": 1}),
    "a directory that is too long": case("does not end before", end={"size": 2**20}),
    "a directory elsewhere": case("has no entry 1 of 2", end={"start": 1}),
    "two counts": case("numbers 2 and 1 for one thing", wide={"count": 1}),
    "two starts": case("for one thing", wide={"start": 0}),
    "an end of 64 bits elsewhere": case("end of 64 bits does not lie at 5", wide={"place": 5}),
    "an end of 64 bits nowhere": case("end of 64 bits cannot lie at", wide={"place": 2**63}),
    "no sizes of 64 bits": case("lacks its sizes of 64 bits", Row("a", central={"size": 2**32 - 1})),
    "sizes of 32 and of 64 bits": case("has the sizes 7 and 9 at once", Row("a", central={"extra": wide(9, 7)})),
    "an extra field that is cut off": case(
        "an extra field 0x0001 that is cut off", Row("a", **both(extra=b"\1\0\xff\0"))
    ),
}
NESTED = {
    "a bad name in an inner FMU": (
        lambda: inside(1, [*BASE, Row("../evil")]),
        r"its archive 'resources/inner\.fmu': entry '\.\./evil' leads outside",
    ),
    "an inner package that is cut": (
        lambda: fmu(Row("resources/inner.ssp", cut(fmu(), 0.5))),
        r"its archive 'resources/inner\.ssp': is not a readable zip archive",
    ),
    "five archives in one another": (lambda: inside(5, BASE), "lies in 4 archives and is one itself; 4 are allowed"),
    "five of other kinds": (lambda: inside(5, BASE, "resources/a.bin"), "lies in 4 archives and is one itself"),
    "bombs in inner archives": (
        lambda: fmu(*(Row(f"resources/{i}.zip", zipped(zeros(600, 1024**2)), DEFLATED) for i in range(4))),
        "would unpack .* bytes, more than",
    ),
}
GROUPS = {
    "links": LINKS, "paths": PATHS, "lengths": LENGTHS, "encodings": ENCODINGS, "twice": TWICE,
    "methods": METHODS, "sizes": SIZES, "contradictions": CONTRADICTIONS, "hidden": HIDDEN, "ends": ENDS,
    "nested": NESTED,
}  # fmt: skip
CASES = {f"{group}: {name}": found for group, cases in GROUPS.items() for name, found in cases.items()}

DAMAGED = {
    "deflate that is none": (Row("resources/a", b"a" * 99, DEFLATED, data=b"\xff" * 9), "is damaged: Error -3"),
    "deflate that ends early": (
        Row("resources/a", b"a" * 999, DEFLATED, data=deflated(b"a" * 999)[:-3]),
        "its packed data end too early",
    ),
    "deflate that goes on": (
        Row("resources/a", b"a" * 99, DEFLATED, data=deflated(b"a" * 99) + b"more"),
        "its packed data go on after their end",
    ),
    "more data than announced": (Row("resources/a", b"a" * 999, DEFLATED, **both(size=9)), "more than the 9 bytes"),
    "less data than announced": (Row("resources/a", b"a" * 99, DEFLATED, **both(size=999)), "has 99 bytes, but"),
    "a wrong CRC": (Row("resources/a", **both(crc=1)), "its CRC is .* but the directory gives 00000001"),
}
