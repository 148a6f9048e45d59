"""Parses the XML files of strangers: modelDescription.xml, and all files of an SSP package.

A parser needs up to forty times the memory of a file that consists of small elements, and an entity in a document
type can stand for a billion characters. So the size of what a file would become is bounded before the file is parsed,
document types are refused, and nothing is fetched.
"""

import codecs
import re
from typing import Any

LARGEST = 32 * 1024**2  # bytes of a file; a description of a hundred thousand variables has 25 MB
MAX_TAGS = 1_000_000  # start tags, end tags and comments; a hundred thousand variables need 0.4 million
MAX_ATTRIBUTES = 2_000_000  # at most; counted as signs of equality
MAX_DEPTH = 128  # elements in elements; a system in a system needs two
MAX_ATTRIBUTE = 1024**2  # characters of an attribute; an output that depends on 100,000 inputs needs 0.7 million
MAX_NAME = 1000  # characters of a name or a reference
LONGEST_MESSAGE = 160
_DECLARATION = re.compile(rb"<\?xml\s[^>]{0,200}?encoding\s*=\s*[\"']([A-Za-z0-9._:-]{1,40})[\"'][^>]{0,100}\?>")
_IN_PROLOG = {b"<?": b"?>", b"<!--": b"-->"}
_DOCTYPE = b"<!DOCTYPE"
_BOMS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_WITHOUT_BOM = {b"<\0": "utf-16-le", b"\0<": "utf-16-be"}
_MOST_FOR_LINES = 2000  # elements; the violations of 16,000 take half a minute
_SPACE = re.compile(rb"\s*")
_TOO_DEEP = f"has elements that are nested more than {MAX_DEPTH} deep"
_DEEPER = "boolean(/*" + "/*" * MAX_DEPTH + ")"
_NAMES = ("name", "unit", "source", "target", "prefix", "startElement", "endElement", "startConnector", "endConnector")
_IS_NAME = " or ".join(
    f"local-name() = '{name}'" for name in (*_NAMES, "type", "modelIdentifier", "declaredType", "guid")
)
_TOO_LONG = f"//@*[string-length() > {MAX_NAME} and (string-length() > {MAX_ATTRIBUTE} or {_IS_NAME})]"


class XmlError(ValueError):
    """XML that is not well-formed, or breaks a limit; the message is the end of a sentence about the file."""


def parse_xml(content: bytes) -> Any:
    """Parse a file and return its root element, of lxml, without comments and processing instructions.

    Raises
    ------
    XmlError
        If the XML is not well-formed, has a document type, or is larger or deeper than the limits.
    """
    from lxml import etree

    if len(content) > LARGEST:
        msg = f"has more than {LARGEST} bytes"
        raise XmlError(msg)
    content = _with_ascii(content)
    _require_bounded(content)
    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
        collect_ids=False,
    )
    try:
        root = etree.fromstring(content, parser)
    except (etree.XMLSyntaxError, ValueError) as failed:
        reason = str(failed.args[0] if failed.args else failed)
        if "Excessive depth" in reason:
            raise XmlError(_TOO_DEEP) from failed
        msg = f"is not well-formed XML: {printed(reason)}"
        raise XmlError(msg) from failed
    if root.xpath(_DEEPER):
        raise XmlError(_TOO_DEEP)
    for found in root.xpath(_TOO_LONG):
        most = MAX_ATTRIBUTE if len(found) > MAX_ATTRIBUTE else MAX_NAME
        msg = f"has an attribute {printed(found.attrname)} of {len(found)} characters, more than {most}"
        raise XmlError(msg)
    return root


def violation(root: Any, schema: Any) -> str | None:
    """Return what the first violation of a schema of lxml is, with its line where it is known; None if there is none.

    The validator needs a time for each violation that grows with the number of elements before it. So large trees are
    written and read again by a parser that validates as it reads, which knows no lines.
    """
    from lxml import etree

    if root.xpath("count(descendant::*)") <= _MOST_FOR_LINES:
        if schema.validate(root):
            return None
        first, n = schema.error_log[0], len(schema.error_log)
        place, message = f" in line {first.line}", first.message
    else:
        try:
            parser = etree.XMLParser(schema=schema, resolve_entities=False, no_network=True)
            etree.fromstring(etree.tostring(root, with_tail=False), parser)
        except etree.XMLSyntaxError as failed:
            place, message, n = "", failed.args[0], 1
        else:
            return None
    return f"{place}: {printed(message)}{f' ({n} violations)' if n > 1 else ''}"


def printed(message: object, most: int = LONGEST_MESSAGE) -> str:
    """Return the message of a parser, which may quote the file, as one short line of printable characters."""
    text = " ".join(str(message)[: 4 * most].split()).rstrip(".")
    text = "".join(c if c.isprintable() else "?" for c in text)
    return text if len(text) <= most else f"{text[: most - 3]}..."


def _with_ascii(content: bytes) -> bytes:
    """The file in an encoding whose bytes below 128 are ASCII, so that its signs can be counted before it is parsed."""
    wide = "utf-16" if content.startswith(_BOMS) else _WITHOUT_BOM.get(content[:2])
    if wide is not None:
        try:
            text = content.decode(wide)
        except UnicodeDecodeError as failed:
            msg = f"is not well-formed XML: its encoding should be UTF-16, but {failed.reason}"
            raise XmlError(msg) from failed
        return re.sub(r"^<\?xml[^>]{0,400}\?>", "", text).encode(errors="replace")
    body = content.removeprefix(codecs.BOM_UTF8)
    if not body.lstrip(b" \t\r\n").startswith(b"<"):
        msg = "is not well-formed XML: it does not begin with an element"
        raise XmlError(msg)
    declared = _DECLARATION.match(body)
    encoding = declared[1].decode() if declared else "utf-8"
    if not _keeps_ascii(encoding):
        msg = f"has the encoding {encoding}, which is not supported; use UTF-8"
        raise XmlError(msg)
    return body


def _keeps_ascii(encoding: str) -> bool:
    """Whether the signs of XML have the same bytes in an encoding as in ASCII."""
    try:
        return codecs.lookup(encoding).name != "utf-7" and "<=>".encode(encoding) == b"<=>"
    except (LookupError, UnicodeError):
        return False


def _require_bounded(content: bytes) -> None:
    """Refuse a file whose tree would take too much memory, or that has a document type."""
    for what, sign, most in (("tags", b"<", MAX_TAGS), ("attributes", b"=", MAX_ATTRIBUTES)):
        if content.count(sign) > most:
            msg = f"has more than {most} {what}"
            raise XmlError(msg)
    if _after_prolog(content) == _DOCTYPE:
        msg = "declares a document type; entities are not allowed"
        raise XmlError(msg)


def _after_prolog(content: bytes) -> bytes:
    """The first bytes after the declaration, comments and processing instructions at the beginning."""
    place = 0
    while space := _SPACE.match(content, place):
        place = space.end()
        begin = next((sign for sign in _IN_PROLOG if content.startswith(sign, place)), None)
        if begin is None:
            break
        found = content.find(_IN_PROLOG[begin], place + len(begin))
        if found < 0:
            break
        place = found + len(_IN_PROLOG[begin])
    return content[place : place + len(_DOCTYPE)]
