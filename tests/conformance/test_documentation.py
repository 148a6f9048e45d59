"""Tests of the parts of an FMU for people: documentation/index.html, its license, and model.png."""

import importlib
import re
import struct
import sys
import types
import zipfile
import zlib
from collections import Counter
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from lxml import etree

from adaptimp_fmu import Icon, Model, SampledModel, Stroke, build, present
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.icon import SIZE, png
from fmus.catalog import MODELS
from tests.conformance.binary import Binary
from tests.conformance.container import of_models
from tests.conformance.units import REALS, declared

ROOT = Path(__file__).parents[2]
VOID = {"img", "meta"}
FOREIGN = {"svg", "math"}  # languages of their own, which the test as XML covers
TEXT = {"#text", "a", "code"}
# What may stand in each element: the part of HTML's content model that these pages use.
CONTENT: dict[str, set[str]] = {
    "#document": {"html"},
    "html": {"head", "body"},
    "head": {"meta", "title", "style"},
    "body": {"header", "nav", "main"},
    "header": {"img", "div"},
    "nav": {"ul"},
    "main": {"h2", "h3", "p", "pre", "ul", "div", "figure"},
    "div": {"h1", "p", "table", "math", "span"},
    "figure": {"svg", "figcaption"},
    "table": {"thead", "tbody"},
    "thead": {"tr"},
    "tbody": {"tr"},
    "tr": {"th", "td"},
    "ul": {"li"},
    **{tag: TEXT for tag in ("p", "li")},
    **{tag: {*TEXT, "span"} for tag in ("td", "th")},
    **{tag: {"#text"} for tag in ("title", "style", "h1", "h2", "h3", "pre", "a", "code", "span", "figcaption")},
}
ATTRIBUTES: dict[str, set[str]] = {
    "html": {"lang"},
    "meta": {"charset", "name", "content"},
    "img": {"src", "alt"},
    "h2": {"id"},
    "table": {"class"},
    "td": {"class"},
    "th": {"scope"},
    "p": {"class"},
    "div": {"class", "role", "tabindex", "aria-label"},
    "figure": {"class", "role", "tabindex", "aria-label"},
    "span": {"class"},
    "nav": {"aria-label"},
    "pre": {"tabindex"},
    "a": {"href"},
}


class Page(HTMLParser):
    """A strict reader: what is not in `CONTENT`, not closed in order, or not escaped is an error."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=False)
        self.open = ["#document"]
        self.foreign: list[str] = []
        self.seen: list[tuple[str, dict[str, str]]] = []
        self.texts: dict[str, list[str]] = {}
        self.rows: list[int] = []
        self.declaration = ""
        self.feed(text)
        self.close()
        assert self.open == ["#document"], f"never closed: {self.open[1:]}"

    def handle_decl(self, decl: str) -> None:
        """Before everything else."""
        assert not self.seen
        self.declaration = decl

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Known, allowed here, with known attributes that have values."""
        if self.foreign or tag in FOREIGN:
            self._foreign_tag(tag, dict(attrs))
            return
        attributes = dict(attrs)
        assert len(attributes) == len(attrs)
        assert None not in attributes.values()
        assert attributes.keys() <= ATTRIBUTES.get(tag, set()), f"{tag}: {attributes}"
        assert tag in CONTENT[self.open[-1]], f"<{tag}> in <{self.open[-1]}>"
        self.seen.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)
            self.texts.setdefault(tag, []).append("")

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Void elements only."""
        if self.foreign:
            return
        assert tag in VOID, f"<{tag}/> is no void element"
        self.handle_starttag(tag, attrs)

    def handle_endtag(self, tag: str) -> None:
        """The innermost open element's."""
        if self.foreign:
            assert self.foreign.pop() == tag
            return
        assert self.open.pop() == tag
        self.rows += [sum(t in ("th", "td") for t in self._since("tr"))] if tag == "tr" else []

    def handle_data(self, data: str) -> None:
        """Only where text may be, and escaped."""
        if self.foreign:
            return
        assert "#text" in CONTENT[self.open[-1]] or not data.strip(), f"{data!r} in <{self.open[-1]}>"
        assert self.open[-1] == "style" or not set(data) & set("<>&"), data
        if self.open[-1] in self.texts:
            self.texts[self.open[-1]][-1] += data

    def handle_entityref(self, name: str) -> None:
        """A named character."""
        if self.foreign:
            return
        self.texts[self.open[-1]][-1] += {"lt": "<", "gt": ">", "amp": "&", "quot": '"'}[name]

    def handle_charref(self, name: str) -> None:
        """A numbered character: quotes, and any in a formula."""
        if self.foreign:
            return
        assert name in ("34", "39")
        self.texts[self.open[-1]][-1] += chr(int(name))

    def handle_comment(self, data: str) -> None:
        """None are expected."""
        pytest.fail(f"a comment: {data}")

    def _foreign_tag(self, tag: str, attributes: dict[str, str | None]) -> None:
        """An element of a drawing or of a formula; a drawing says what it shows."""
        if not self.foreign:
            assert tag in CONTENT[self.open[-1]], f"<{tag}> in <{self.open[-1]}>"
            self.seen.append((tag, {name: value or "" for name, value in attributes.items() if name == "aria-label"}))
        self.foreign.append(tag)

    def _since(self, opening: str) -> list[str]:
        tags = [tag for tag, _ in self.seen]
        return tags[len(tags) - tags[::-1].index(opening) :]


def entry(fmu: Path, name: str) -> bytes:
    with zipfile.ZipFile(fmu) as archive:
        return archive.read(name)


@pytest.fixture
def page(fmu: Path) -> Page:
    """The documentation, strictly parsed."""
    return Page(entry(fmu, "documentation/index.html").decode("utf-8"))


def test_page_is_valid_html(page: Page, identifier: str) -> None:
    assert page.declaration == "DOCTYPE html"
    tags = [tag for tag, _ in page.seen]
    assert tags[:3] == ["html", "head", "meta"]
    assert page.seen[0][1]["lang"]
    assert page.seen[2][1] == {"charset": "utf-8"}
    assert tags.count("title") == tags.count("h1") == tags.count("body") == 1
    assert page.texts["title"] == [identifier.removeprefix(REALS)]
    identifiers = [attributes["id"] for _, attributes in page.seen if "id" in attributes]
    assert len(set(identifiers)) == len(identifiers) > 0
    assert all(attributes.get("alt") for tag, attributes in page.seen if tag == "img")
    assert all(attributes.get("aria-label") for tag, attributes in page.seen if tag == "svg")
    labels = [attributes["aria-label"] for tag, attributes in page.seen if attributes.get("role") == "region"]
    assert len(set(labels)) == len(labels) > 0, "each region has a name of its own"


def test_page_is_well_formed_xml_too(fmu: Path) -> None:
    """So that parsers of both kinds read the same."""
    etree.fromstring(entry(fmu, "documentation/index.html"), etree.XMLParser(recover=False))


@pytest.mark.parametrize(
    "fault",
    [
        ("</p>", ""),
        ("<li>", "<td>"),
        ("&lt;", "<"),
        ('<pre tabindex="0">', '<pre tabindex="0"><table>'),
        ('lang="en"', "lang"),
        ("</table>", "</table></table>"),
    ],
)
def test_reader_refuses_invalid_html(fmu_folder: Path, fault: tuple[str, str]) -> None:
    text = entry(fmu_folder / "ForceSensor.fmu", "documentation/index.html").decode()
    assert fault[0] in text
    with pytest.raises((AssertionError, KeyError)):
        Page(text.replace(*fault, 1))


def test_links_lead_to_entries_of_the_archive(page: Page, fmu: Path) -> None:
    with zipfile.ZipFile(fmu) as archive:
        entries = set(archive.namelist())
    targets = [value for _, attributes in page.seen for name, value in attributes.items() if name in ("src", "href")]
    identifiers = {attributes["id"] for _, attributes in page.seen if "id" in attributes}
    assert targets
    for target in targets:
        if target.startswith("#"):
            assert target[1:] in identifiers
            continue
        parts = urlsplit(target)
        assert (parts.scheme, parts.netloc) == ("", ""), "the page needs no network"
        resolved = target.removeprefix("../") if target.startswith("../") else f"documentation/{target}"
        assert resolved in entries


@of_models
def test_page_holds_the_equations_word_for_word(page: Page, identifier: str) -> None:
    model = declared(identifier)
    titles = list(model.documentation)
    assert titles[0].startswith("fmus.")
    for title in titles:
        docstring = importlib.import_module(title).__doc__ or ""
        assert title in page.texts["h3"]
        assert docstring.strip() in page.texts["pre"], title


def in_grids(fmu: Path) -> set[str]:
    """Variables of the page that stand in tables of several columns, where row and column say what they are."""
    root = etree.fromstring(entry(fmu, "documentation/index.html"))
    return {name for code in root.iterfind(".//{*}table[@class='grid']//{*}code") if (name := code.text)}


def test_page_lists_every_variable_with_its_start(page: Page, binary: Binary, fmu: Path) -> None:
    assert {name for name in page.texts["code"] if name in binary.variables} == set(binary.variables)
    cells, laid = {cell.strip() for cell in page.texts["td"]}, in_grids(fmu)
    for name in binary.names("parameter"):
        assert name in laid or binary.variables[name].description in cells, name
        assert str(binary.variables[name].start) in cells, name


@of_models
def test_page_has_a_row_for_each_variable(page: Page, binary: Binary, fmu: Path) -> None:
    tables = {"input": 5, "output": 4, "parameter": 8}  # columns
    cells, laid = Counter(page.texts["code"]), in_grids(fmu)
    for causality, columns in tables.items():
        names = [name for name in binary.names(causality) if name not in laid]
        assert page.rows.count(columns) >= len(names) + (1 if names else 0)
        assert all(cells[name] >= 1 for name in names)


@of_models
def test_page_states_semantics_and_limits(page: Page, identifier: str) -> None:
    model = declared(identifier)
    points = " ".join(page.texts["li"])
    assert ("Sampled" in points) == isinstance(model, SampledModel)
    assert "1e7" in points
    for event in getattr(model, "events", ()):
        assert event.name in points
    for check in (*model.static_checks, *model.checks):
        assert check.sentence in points or re.sub(r"\[\d+\]", "[i]", check.sentence) in points


@of_models
def test_page_has_a_heading_for_each_topic(page: Page, identifier: str) -> None:
    levels = [int(tag[1]) for tag, _ in page.seen if tag in ("h1", "h2", "h3")]
    assert levels[0] == 1
    assert all(later - earlier <= 1 for earlier, later in pairwise(levels)), "no level is left out"
    guide = declared(identifier).guide
    tried = ["Try it"] if guide.examples else []
    topics = ["What it is", "Connect it", *tried, "Parameters", "Equations", "Time and steps", "Limits and errors"]
    assert page.texts["h2"][: len(topics)] == topics
    assert {group.title for group in guide.formulas} <= set(page.texts["h3"])
    assert "Other parameters" not in page.texts["h3"], "every parameter of the project has a topic"


@of_models
def test_page_typesets_formulas_and_draws_the_loop(page: Page, identifier: str) -> None:
    guide = declared(identifier).guide
    tags = [tag for tag, _ in page.seen]
    assert tags.count("math") == sum(len(group.items) for group in guide.formulas) > 0
    assert tags.count("svg") == len(guide.drawings) + len(guide.place) >= 2
    assert any("marked" in attributes["aria-label"] for tag, attributes in page.seen if tag == "svg")


def test_page_says_who_connects_to_whom(fmu_folder: Path) -> None:
    text = entry(fmu_folder / "Actuator.fmu", "documentation/index.html").decode()
    rows = [[cell.xpath("string()") for cell in row] for row in etree.fromstring(text).iterfind(".//{*}tr")]
    assert ["tau_cmd[1] to tau_cmd[2]", "2", "N.m", "controller", "Commanded torque of joint"] in rows
    assert ["tau[1] to tau[2]", "2", "N.m", "plant", "Torque of joint"] in rows


def test_page_of_a_plain_model_leaves_out_what_nobody_states(tmp_path: Path) -> None:
    model = SampledModel("Gain", "Multiplies")
    k = model.parameter("k", 2.0, description="Gain")
    model.output("y", k * model.input("u", 1.0, description="Input"), description="Output")
    page = Page(entry(build(model, tmp_path, cache=tmp_path / "cache"), "documentation/index.html").decode())
    headings = ["Connect it", "Parameters", "Time and steps", "Limits and errors", "All inputs and outputs"]
    assert page.texts["h2"] == [*headings, "Rebuild the binary", "Author and license"]
    assert {"u", "y", "k", "sample_time"} <= set(page.texts["code"])


def test_page_escapes_what_a_model_says(tmp_path: Path) -> None:
    model = SampledModel("Gain", 'a < b & "c" <script>')
    model.output("y", 2 * model.input("u", 1.0, description="<td>"), description="&amp;")
    text = entry(build(model, tmp_path, cache=tmp_path / "cache"), "documentation/index.html").decode()
    page = Page(text)
    assert any(paragraph.startswith('a < b & "c" <script>') for paragraph in page.texts["p"])
    assert {"<td>", "&amp;"} <= set(page.texts["td"])


def test_guid_does_not_cover_what_people_see(tmp_path: Path) -> None:
    """docs/decisions/002: a reworded page or a redrawn icon leaves binary and saved states valid."""
    model = MODELS["Actuator"]()
    before = build(model, tmp_path / "before", cache=tmp_path / "cache")
    model.documentation, model.icon = {"fmus.actuator": "Other words."}, Icon()
    after = build(model, tmp_path / "after", cache=tmp_path / "cache")
    for name in ("documentation/index.html", "model.png"):
        assert entry(before, name) != entry(after, name)
    assert entry(before, "modelDescription.xml") == entry(after, "modelDescription.xml")


@of_models
def test_license_is_the_projects(fmu: Path, page: Page) -> None:
    assert entry(fmu, "documentation/licenses/license.txt") == (ROOT / "LICENSE").read_bytes()
    assert "License of the model: MIT, in ." in [" ".join(text.split()) for text in page.texts["p"]]


def test_missing_docstring_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "silent", types.ModuleType("silent"))
    with pytest.raises(DefinitionError, match="silent has no docstring"):
        present(Model("Gain", "Multiplies"), Icon(), "silent")


def chunks(content: bytes) -> dict[bytes, bytes]:
    """Chunks of a PNG file by name, their checksums verified."""
    assert content[:8] == b"\x89PNG\r\n\x1a\n"
    found, at = {}, 8
    while at < len(content):
        (length,) = struct.unpack(">I", content[at : at + 4])
        name, body = content[at + 4 : at + 8], content[at + 8 : at + 8 + length]
        (checksum,) = struct.unpack(">I", content[at + 8 + length : at + 12 + length])
        assert checksum == zlib.crc32(name + body)
        found[name], at = body, at + 12 + length
    return found


def test_icon_is_a_png(fmu: Path) -> None:
    found = chunks(entry(fmu, "model.png"))
    assert list(found) == [b"IHDR", b"IDAT", b"IEND"]
    assert struct.unpack(">II5B", found[b"IHDR"]) == (SIZE, SIZE, 8, 6, 0, 0, 0)
    assert len(zlib.decompress(found[b"IDAT"])) == SIZE * (1 + 4 * SIZE)


def test_icons_differ() -> None:
    assert len({png(declare().icon) for declare in MODELS.values()}) == len(MODELS)


def test_icon_shows_its_strokes() -> None:
    """A white dot at the bottom left of a red block: opaque inside, transparent in the corners."""
    image = zlib.decompress(chunks(png(Icon((200, 0, 0), [Stroke([(0.25, 0.25)], 0.2)])))[b"IDAT"])

    def pixel(x: float, y: float) -> tuple[int, ...]:
        start = int((1 - y) * SIZE) * (1 + 4 * SIZE) + 1 + 4 * int(x * SIZE)
        return tuple(image[start : start + 4])

    assert pixel(0.25, 0.25) == (255, 255, 255, 255)
    assert pixel(0.75, 0.75) == pixel(0.25, 0.75) == (200, 0, 0, 255)
    assert pixel(0.001, 0.999)[3] == 0
