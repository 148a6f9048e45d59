"""Evidence that pages carry their modules, and that no text of a stranger becomes a part of their markup."""

import json
import re
from base64 import b64decode
from html import unescape
from pathlib import Path

import pytest
from markupsafe import Markup

from orchestration import OrchestrationError
from orchestration.report.markup import for_run, table
from orchestration.report.page import Page, Section, script_json

EVIL = "</script><b>\u202e&"


def page(**changes: object) -> Page:
    about: dict[str, object] = {"title": EVIL, "lead": EVIL, "sections": [Section("one", EVIL, "<p>ours</p>")]}
    return Page(**{**about, "data": {"runs": {"name": EVIL}}, **changes})  # type: ignore[arg-type]


def test_texts_are_escaped_everywhere() -> None:
    html = page().html()
    assert "<b>" not in html
    assert "\u202e" not in html  # a character that turns what follows
    assert "<p>ours</p>" in html
    assert html.count("&lt;/script&gt;&lt;b&gt;") >= 4


def test_json_in_a_page_keeps_its_meaning_and_cannot_end_its_script() -> None:
    text = script_json({EVIL: [EVIL]})
    assert not set("<>&") & set(text)
    assert json.loads(text) == {EVIL: [EVIL]}


def test_modules_import_each_other_by_name(tmp_path: Path) -> None:
    own = tmp_path / "mine.js"
    own.write_text(
        'import { json } from "../../../report/script/data.js";\nexport function start() {}\n', encoding="utf-8"
    )
    html = page(modules=[own], starts=["mine.js"]).html()
    found = re.search(r'<script type="importmap">(.*?)</script>', html)
    assert found is not None
    imports = json.loads(found[1])["imports"]
    assert {"mine.js", "data.js", "page.js", "plots.js"} <= imports.keys()
    assert b64decode(imports["mine.js"].partition(",")[2]).startswith(b'import { json } from "data.js";')
    assert 'import { start as start1 } from "mine.js";' in unescape(html)


def test_two_modules_of_one_name_are_refused(tmp_path: Path) -> None:
    (tmp_path / "data.js").write_text("", encoding="utf-8")
    with pytest.raises(OrchestrationError, match=r"data\.js: two modules of the page have this name"):
        page(modules=[tmp_path / "data.js"]).html()


def test_the_same_page_gives_the_same_bytes() -> None:
    assert page(blocks={"b": b"123"}).html() == page(blocks={"b": b"123"}).html()


def test_a_table_escapes_its_cells_and_keeps_markup() -> None:
    found = table(("a", "b"), [(EVIL, Markup("<i>ours</i>")), ("x", 1.25)])
    assert "<b>" not in found
    assert "<i>ours</i>" in found
    assert '<td class="number" data-label="b">1.25</td>' in found


def test_parts_of_many_runs_are_folded() -> None:
    assert for_run("x", Markup("<p>"), 1) == "<p>"
    assert '<details class="run" open><summary>&lt;x</summary>' in for_run("<x", Markup("<p>"), 2)
    assert " open" not in for_run("x", Markup("<p>"), 3)
