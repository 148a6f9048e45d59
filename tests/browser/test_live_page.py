"""The live part of the page in Chromium, from a file: sliders, controllers, links, downloads, bits, claims."""

import re
import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from orchestration import Result, scenario, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.page.live import live_parts
from orchestration.paper.page.live_data import native_hashes
from orchestration.paper.page.live_settings import FIGURES
from orchestration.paper.page.report import report_page
from orchestration.results.row_hash import row_hash
from tests.browser.conftest import AXE, NO_TOOLS
from tests.faults.cli import Command, runner

PATIENCE = 60_000.0  # ms: many times the longest answer on a busy machine
ANSWERED = "data-milliseconds"
SERIOUS = ("serious", "critical")
SHIFTS = """
window.shifted = 0;
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) if (!entry.hadRecentInput) window.shifted += entry.value;
}).observe({ type: "layout-shift", buffered: true });
"""


class Opened(NamedTuple):
    """A page that is open, its address, and what it has asked for and complained of since."""

    page: Page
    address: str
    asked: list[str]
    said: list[str]

    def go(self, link: str) -> None:
        """Follow a link to a state, and wait for the answer."""
        self.page.evaluate("location.hash = ''")  # the same link twice would be no change
        self.forget()
        self.page.evaluate("(link) => { location.hash = link; }", link)
        self.answered()

    def forget(self) -> None:
        """Forget the last answers."""
        for part in ("status", "claims"):
            self.page.evaluate(f"document.getElementById('live-{part}').removeAttribute('{ANSWERED}')")

    def answered(self, part: str = "status") -> float:
        """Wait for an answer; how long the worker took, ms."""
        expect(self.page.locator(f"#live-{part}")).to_have_attribute(ANSWERED, re.compile(r"\d"), timeout=PATIENCE)
        return float(self.page.get_attribute(f"#live-{part}", ANSWERED) or "nan")

    def at(self, part: str) -> Locator:
        """An element of the live part."""
        return self.page.locator(f"#live-{part}")

    def number(self, name: str) -> str:
        """One of the numbers of the run."""
        return self.at("numbers").locator("div", has_text=name).locator("dd").inner_text()


@pytest.fixture(scope="module")
def native() -> Mapping[str, Result]:
    """The runs of the page that the master has made."""
    return {name: simulate(scenario(name)) for name in FIGURES}


@pytest.fixture(scope="module")
def address(native: Mapping[str, Result], tmp_path_factory: pytest.TempPathFactory) -> str:
    """A page with a recorded run and the live part, as a file."""
    page = live_parts(native_hashes(native)).added_to(report_page({"fig2": native["fig2"]}))
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(page.html(), encoding="utf-8")
    print(f"\nsize of the page: {path.stat().st_size / 1e6:.2f} MB")  # noqa: T201 - a figure for the reader of the log
    assert path.stat().st_size < 2.5e6
    return path.as_uri()


@pytest.fixture(scope="module")
def live(browser: Browser, address: str) -> Iterator[Opened]:
    """The page, open at the figure that is computed fastest."""
    with browser.new_context(accept_downloads=True, reduced_motion="reduce") as context:
        page = context.new_page()
        opened = Opened(page, address, [], [])
        page.on("request", lambda request: opened.asked.append(request.url))
        page.on("console", lambda message: opened.said.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: opened.said.append(str(error)))
        page.goto(f"{address}#try=fig2")
        page.wait_for_selector("html[data-ready]", state="attached", timeout=PATIENCE)
        opened.answered()
        yield opened


def test_the_rows_of_every_figure_have_the_bits_of_the_master(live: Opened, native: Mapping[str, Result]) -> None:
    for name in ("fig2", "fig5"):
        live.go(f"try={name}")
        live.at("prove").click()
        expect(live.at("hash")).to_have_text(row_hash(native[name]), timeout=PATIENCE)
        expect(live.at("native")).to_contain_text("the bits are the same")


def test_answers_come_at_once(live: Opened) -> None:
    """Prints the times, since other programs on the machine take part in them; the limit is far from the usual one."""
    for what, link in (
        ("fig5, 200000 steps", "try=fig5&seed={}"),
        ("fig5 at 10 kHz, 20000 steps", "try=fig5&sample_time=0.0001&seed={}"),
    ):
        times, claims = [], []
        for seed in (2, 3, 4):
            live.go(link.format(seed))
            times.append(live.answered())
            claims.append(live.answered("claims"))
        print(f"\n{what}: rows in {min(times):.0f} ms, claims in {min(claims):.0f} ms")  # noqa: T201 - as above
        assert min(times) < PATIENCE / 10


def test_a_slider_changes_the_run_by_keyboard(live: Opened) -> None:
    live.go("try=fig2")
    before = live.number("Peak force")
    live.forget()
    live.at("K_f-slider").focus()
    live.page.keyboard.press("End")
    live.answered()
    assert live.at("K_f").input_value() == "400000"
    assert live.number("Peak force") != before
    result = simulate(scenario("fig2").set({"plant.K_f": 4e5}))
    assert live.number("Peak force") == f"{result.measure('max(norm(plant.F_ext))'):.4g} N"
    expect(live.page.locator(".legend")).not_to_have_count(0)
    live.at("reset").click()
    expect(live.at("K_f")).to_have_value("100000")


def test_the_newest_request_wins(live: Opened) -> None:
    """Twenty moves of a slider, of which the page need not answer all; the last one is answered."""
    live.go("try=fig5")
    live.page.evaluate(
        "() => { window.answers = 0; new MutationObserver(() => window.answers++)"
        ".observe(document.getElementById('live-status'), { attributeFilter: ['data-milliseconds'] }); }"
    )
    slider = "document.getElementById('live-m2-slider')"
    for mass in range(120, 140):
        live.page.evaluate(
            f"() => {{ {slider}.value = Math.log10({mass / 100}); {slider}.dispatchEvent(new Event('input')); }}"
        )
    expect(live.at("m2")).to_have_value("1.39")
    expect(live.at("status")).to_contain_text(f"m2 = {live.at('m2').input_value()} kg", timeout=PATIENCE)
    assert 1 <= live.page.evaluate("window.answers") < 20


def test_controllers_switch_and_take_their_settings_along(live: Opened) -> None:
    live.go("try=fig2&sample_time=0.0001")
    expect(live.at("K_d-row")).to_be_hidden()
    live.forget()
    live.at("controller").select_option("SlotineLiAdaptiveImpedance")
    live.answered()
    live.page.locator("details.live-group").nth(1).locator("summary").first.click()
    expect(live.at("K_d-row")).to_be_visible()
    expect(live.at("command")).to_contain_text("--controller SlotineLiAdaptiveImpedance")
    live.forget()
    live.at("figure").select_option("fig4")
    live.answered()
    expect(live.at("controller")).to_have_value("HoganImpedance")


def test_a_link_restores_the_state(live: Opened, browser: Browser) -> None:
    """Form, numbers and arm are those of the link, not those of the run that the page has recorded."""
    live.go("try=fig7&sample_time=0.0001&tau_max_1=300&seed=4&wall_offset=1.42")
    link, said = live.at("link").input_value(), live.at("numbers").inner_text()
    with browser.new_context() as context:
        other = Opened(context.new_page(), live.address, [], [])
        other.page.goto(link)
        other.page.wait_for_selector("html[data-ready]", state="attached", timeout=PATIENCE)
        other.answered()
        assert other.at("numbers").inner_text() == said
        assert (other.at("figure").input_value(), other.at("seed").input_value()) == ("fig7", "4")
        expect(other.page.locator("#arm [data-part=wall]").first).to_have_attribute(
            "transform", re.compile(r"\(-?142 0\)")
        )


def test_downloads_and_the_command_give_the_same_bits(
    live: Opened, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    live.go("try=fig5&controller=HoganImpedance&sample_time=0.0001&m2=1.7&depth=0.012")
    monkeypatch.chdir(tmp_path)
    for button, name in (("csv", "page.csv"), ("ssd", "page.ssd")):
        with live.page.expect_download(timeout=PATIENCE) as saved:
            live.at(button).click()
        saved.value.save_as(name)
    live.at("prove").click()
    expect(live.at("native")).to_contain_text("the hash of its rows", timeout=PATIENCE)
    adaptimp: Command = runner(monkeypatch, capsys)
    _, *words = shlex.split(live.at("command").inner_text())
    outcome = adaptimp(*words, "-o", "native.csv")
    said = f"SHA-256 of the rows: {live.at('hash').inner_text()}\n"
    assert said in outcome.out
    assert Path("page.csv").read_bytes() == Path("native.csv").read_bytes()
    Path("resources").mkdir()
    for identifier, path in fmus([*FIGURES["fig2"].models.values()]).items():
        Path("resources", f"{identifier}.fmu").write_bytes(path.read_bytes())
    assert said in adaptimp("run", "page.ssd", "--hash").out


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("-1", "controller: K[1] = -1 must be at least 1e-12 N/m."),
        ("stiff", "“stiff” is not a number; write one such as 16000."),
        ("", "“” is not a number; write one such as 16000."),
    ],
)
def test_bad_input_is_told_beside_the_field(live: Opened, text: str, message: str) -> None:
    live.go("try=fig2")
    live.at("K").fill(text)
    expect(live.at("K-error")).to_have_text(message, timeout=PATIENCE)
    expect(live.at("K")).to_have_attribute("aria-invalid", "true")
    live.forget()
    live.at("K").fill("3000")
    live.answered()
    expect(live.at("K-error")).to_have_text("")
    assert live.at("K").get_attribute("aria-invalid") is None


def test_claims_follow_the_numbers(live: Opened) -> None:
    """A stiffer wall is no reason to doubt C1; a wall out of reach leaves nothing to judge."""
    live.go("try=fig2&sample_time=0.0001")
    live.answered("claims")
    verdict = live.at("claim-C1").locator("td").first
    assert verdict.inner_text() == "holds"
    live.go("try=fig2&sample_time=0.0001&wall_offset=1.6")
    live.answered("claims")
    assert verdict.inner_text() == "cannot be judged: the tip never touches the wall"


def test_a_pinned_run_stays_beside_the_live_one(live: Opened) -> None:
    live.go("try=fig2&m2=1.5")
    live.at("pin").click()
    live.go("try=fig2&m2=2")
    legend = live.page.locator(".legend").first
    for mass in ("1.5 kg (pinned)", "2 kg"):
        expect(legend.locator("li", has_text=f"m2 = {mass}")).not_to_have_count(0)
    live.at("unpin").click()
    expect(legend.locator("li", has_text="(pinned)")).to_have_count(0)


@pytest.mark.skipif(not AXE.exists(), reason=NO_TOOLS)
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_page_can_be_used_by_all_on_a_phone(browser: Browser, address: str, theme: str, tmp_path: Path) -> None:
    """Nothing moves or stands out at 360 pixels, and axe finds nothing serious."""
    with browser.new_context(viewport={"width": 360, "height": 740}, color_scheme=theme) as context:  # type: ignore[arg-type]
        context.add_init_script(SHIFTS)
        opened = Opened(context.new_page(), address, [], [])
        opened.page.goto(f"{address}#try=fig2&sample_time=0.0001")
        opened.page.wait_for_selector("html[data-ready]", state="attached", timeout=PATIENCE)
        opened.answered("claims")
        for details in opened.page.locator("details.live-group").all():
            details.evaluate("(element) => { element.open = true; }")
        wide = opened.page.evaluate("document.documentElement.scrollWidth")
        shifted = opened.page.evaluate("window.shifted")
        opened.page.evaluate(AXE.read_text(encoding="utf-8"))
        found = opened.page.evaluate("axe.run('#try, #live-judged, #live-copies')")
        opened.page.screenshot(path=tmp_path / f"phone-{theme}.png", full_page=True)
    serious = [(v["id"], v["nodes"][0]["html"]) for v in found["violations"] if v["impact"] in SERIOUS]
    assert serious == []
    assert wide <= 360
    assert shifted < 0.1  # what the web's measure of stability calls good


def test_nothing_leaves_the_page_and_nothing_fails(live: Opened) -> None:
    """Stands last: what the page has asked for and said in all tests before."""
    local = re.compile(r"(file|blob|data):")
    assert [url for url in live.asked if not local.match(url)] == []
    assert live.said == []
