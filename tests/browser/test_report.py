"""Evidence that a report opens from its file, shows the numbers of the run, and does what its buttons say."""

import json
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from orchestration import Result, compare
from orchestration.results.comparison import verdict_of
from tests.browser.conftest import AXE, HOSTILE, NO_TOOLS, Opened, opened

LARGEST = 2.5e6  # bytes of a page
SHOWN = 5e-6  # relative error of a number with six digits
NUMBER = re.compile(r"-?[\d.]+(?:e[+-]?\d+)?")
WATCH_SHIFTS = """
window.shifts = 0;
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) window.shifts += entry.value;
}).observe({ type: "layout-shift", buffered: true });
"""


@pytest.fixture
def fig5(browser: Browser, pages: Path) -> Iterator[Opened]:
    found = opened(browser, pages / "fig5.html")
    found.ready()
    yield found
    assert found.complaints == []
    found.page.context.close()


def scrub(page: Page, share: float) -> None:
    """Move the slider of time to a share of the run."""
    page.locator("[data-part=time]").evaluate(
        "(slider, share) => { slider.value = share; slider.dispatchEvent(new Event('input')); }", share
    )


def curve(page: Page, panel: str, label: str) -> Locator:
    """The part of the legend of a curve."""
    found = page.locator(".panel", has=page.get_by_role("heading", name=panel, exact=True))
    return found.locator("li", has=page.get_by_role("button", name=label, exact=True))


def value_of(page: Page, panel: str, label: str) -> float:
    """The number that a curve has at the cursor."""
    text = curve(page, panel, label).locator("output").inner_text()
    (number,) = NUMBER.findall(text.split(" ")[0])
    return float(number)


def stored(page: Page, run: int = 0) -> dict[str, dict[str, float]]:
    """The packed columns of a run."""
    return json.loads(page.locator("#runs").text_content() or "")["runs"][run]["columns"]


@pytest.mark.parametrize("name", ["fig5", "both", "stranger"])
def test_a_page_opens_without_a_network_or_a_complaint(
    browser: Browser, pages: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = pages / f"{name}.html"
    found = opened(browser, file)
    with capsys.disabled():
        sys.stdout.write(f"\n{name}.html: {file.stat().st_size / 1e6:.2f} MB, ready after {found.ready():.0f} ms\n")
    assert file.stat().st_size < LARGEST
    assert found.requests == [file.as_uri()]
    assert found.complaints == []
    found.page.context.close()


def test_the_page_may_load_nothing(fig5: Opened) -> None:
    """The policy of the page holds even for a script that tries."""
    refused = fig5.page.evaluate("fetch('http://127.0.0.1:9/').then(() => 'loaded', () => 'refused')")
    assert refused == "refused"
    assert "Content Security Policy" in " ".join(fig5.complaints)
    fig5.complaints.clear()


def test_all_rows_are_stored_as_precisely_as_the_page_says(fig5: Opened, results: Mapping[str, Result]) -> None:
    result, packed = results["fig5"], stored(fig5.page)
    names = ["plant.x[1]", "controller.e[2]", "sensor.F_hat[1]"]
    found = fig5.page.evaluate(
        """async (names) => {
          const { json, runOf } = await import("data.js");
          const run = await runOf(json("runs").runs[0]);
          await run.load(names);
          return [run.time, ...names.map((name) => run.columns[name])].map((values) => [...values]);
        }""",
        names,
    )
    assert np.array_equal(found[0], result.time)
    for name, values in zip(names, found[1:], strict=True):
        # Half a step of the codes, and the rounding of low + step * code.
        allowed = packed[name]["step"] / 2 * (1 + 1e-9) + 4 * np.finfo(float).eps * np.abs(result[name]).max()
        assert np.abs(np.array(values) - result[name]).max() <= allowed
    assert (np.array(found[3])[result["sensor.F_hat[1]"] == 0] == 0).all()  # zero stays zero


@pytest.mark.parametrize("row", [0, 93_000, 200_000])
def test_values_at_the_cursor_are_those_of_the_row(fig5: Opened, results: Mapping[str, Result], row: int) -> None:
    result, packed = results["fig5"], stored(fig5.page)
    scrub(fig5.page, row / 200_000)
    for panel, label, name, factor, late in (
        ("Tracking error e = x - x_t (mm)", "e1", "controller.e[1]", 1e3, 1),
        ("Torques of the actuators (N.m)", "joint 2", "actuator.tau[2]", 1.0, 1),
        ("Estimated mass of link 2 (kg)", "estimate of m2", "controller.p_hat[2]", 1.0, 1),
        ("Contact force, norm (N)", "on the wall", "plant.F_ext (norm)", 1.0, 0),
    ):
        place = min(row + late, 200_000)  # what a sampled component computes at a row holds in the next one
        exact = np.hypot(*result["plant.F_ext"][place]) if "norm" in name else result[name][place]
        allowed = factor * packed[name]["step"] / 2 + SHOWN * abs(factor * exact)
        assert abs(value_of(fig5.page, panel, label) - factor * exact) <= allowed * (1 + 1e-9)
    q = np.degrees(result["plant.q"][row])
    for joint in (1, 2):
        turned = fig5.page.locator(f"[data-part=joint-{joint}]").get_attribute("transform") or ""
        assert abs(float(NUMBER.findall(turned)[0]) - q[joint - 1]) <= np.degrees(packed[f"plant.q[{joint}]"]["step"])


def test_play_pause_and_keys_move_the_one_time(fig5: Opened) -> None:
    page = fig5.page
    shown, play = page.locator("[data-part=shown]"), page.locator("[data-part=play]")
    expect(shown).to_have_text("t = 0.0000 s")  # nothing moves before it is asked to
    tip = page.locator("[data-part=tip]")
    before = tip.get_attribute("transform")
    play.focus()
    page.keyboard.press("Space")
    expect(play).to_have_text("Pause")
    expect(tip).not_to_have_attribute("transform", before or "")
    page.keyboard.press("Space")
    expect(play).to_have_text("Play")
    assert shown.inner_text() != "t = 0.0000 s"
    scrub(page, 0.5)
    page.locator("[data-part=time]").focus()
    page.keyboard.press("ArrowRight")
    expect(shown).to_have_text("t = 1.0002 s")
    page.get_by_label("Speed").select_option("1")
    play.click()
    expect(shown).to_have_text("t = 2.0000 s")
    expect(play).to_have_text("Play")


def test_zooming_comes_down_to_every_row_for_all_panels(fig5: Opened) -> None:
    page = fig5.page
    thinned = page.locator("#thinned")
    expect(thinned).to_have_text(re.compile("of every 256 rows; zoom in"))
    scrub(page, 0.46)
    for _ in range(7):
        page.get_by_role("button", name="Zoom in").click()
    expect(thinned).to_have_text("The curves show every row.")
    ranges = page.evaluate("Bokeh.documents.map((d) => d.roots()[0].x_range).map((r) => [r.start, r.end])")
    assert len(ranges) == 4
    assert all(np.allclose(found, (0.92 * (1 - 2**-7), 0.92 + 1.08 / 128)) for found in ranges)
    page.get_by_role("button", name="Later").click()
    page.get_by_role("button", name="Whole run").click()
    expect(thinned).to_have_text(re.compile("of every 256 rows"))
    assert page.evaluate("Bokeh.documents.map((d) => d.roots()[0].x_range.end)") == [2, 2, 2, 2]


def test_dragging_zooms_and_pointing_moves_the_cursor(fig5: Opened) -> None:
    page = fig5.page
    plot = page.locator(".plot").nth(2)
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 150, box["y"] + 80)
    expect(page.locator("[data-part=shown]")).not_to_have_text("t = 0.0000 s")
    page.mouse.down()
    page.mouse.move(box["x"] + 200, box["y"] + 80, steps=5)
    page.mouse.up()
    expect(page.locator("#thinned")).not_to_have_text(re.compile("256"))
    ranges = page.evaluate("Bokeh.documents.map((d) => d.roots()[0].x_range).map((r) => [r.start, r.end])")
    assert all(found == ranges[0] for found in ranges)
    assert 0 < ranges[0][0] < ranges[0][1] < 2


def test_a_legend_toggles_its_curve(fig5: Opened) -> None:
    page = fig5.page
    button = curve(page, "Contact force, norm (N)", "measured").get_by_role("button")
    largest = "Math.max(...Bokeh.documents.map((d) => d.roots()[0].y_range.end))"
    before = page.evaluate(largest)
    button.click()
    expect(button).to_have_attribute("aria-pressed", "false")
    hidden = "Bokeh.documents.flatMap((d) => d.roots()[0].renderers).filter((r) => !r.visible).length"
    assert page.evaluate(hidden) == 1
    assert page.evaluate(largest) < before or before > 800  # the torques may have the largest scale
    button.click()
    assert page.evaluate(hidden) == 0


def test_columns_can_be_chosen_up_to_seven(fig5: Opened) -> None:
    page = fig5.page
    page.get_by_text("More columns").click()
    boxes = page.locator("#choice input")
    for place in range(7):
        boxes.nth(place).check()
    assert boxes.nth(7).is_disabled()
    chosen = page.locator(".panel", has=page.get_by_role("heading", name=re.compile("^Chosen columns")))
    expect(chosen).to_have_count(4)  # m, m/s, m/s2 of the trajectory, and N of the sensor
    boxes.nth(0).uncheck()
    expect(boxes.nth(7)).to_be_enabled()


def test_the_theme_follows_the_system_and_a_button(browser: Browser, pages: Path) -> None:
    found = opened(browser, pages / "fig5.html", scheme="dark")
    found.ready()
    page = found.page
    ink = "Bokeh.documents.map((d) => d.roots()[0].below[0].major_label_text_color)"
    background = "getComputedStyle(document.body).backgroundColor"
    assert page.evaluate(ink) == ["#e6e6e6"] * 4
    assert page.evaluate(background) == "rgb(20, 23, 26)"
    curve(page, "Tracking error e = x - x_t (mm)", "e2").get_by_role("button").click()
    scrub(page, 0.5)
    page.get_by_role("button", name="Zoom in").click()
    page.get_by_role("button", name="Dark").click()
    light = "#1b1f23"  # in which the panels are drawn anew
    drawn = f"{ink}.filter((found) => found === '{light}').length === 4"
    page.evaluate(f"new Promise((done) => (function look() {{ {drawn} ? done() : requestAnimationFrame(look); }})())")
    assert page.evaluate(ink) == [light] * 4
    assert page.evaluate(background) == "rgb(255, 255, 255)"
    for label, pressed in (("e1", "true"), ("e2", "false")):
        button = curve(page, "Tracking error e = x - x_t (mm)", label).get_by_role("button")
        expect(button).to_have_attribute("aria-pressed", pressed)
    assert page.evaluate("Bokeh.documents.map((d) => d.roots()[0].x_range.end)") == [1.5] * 4
    expect(page.locator(".mark").first).not_to_have_css("transform", "none")
    assert found.complaints == []
    page.context.close()


@pytest.mark.parametrize("name", ["fig5", "both", "stranger"])
def test_nothing_shifts_or_overflows_on_a_phone(browser: Browser, pages: Path, name: str) -> None:
    context = browser.new_context(viewport={"width": 360, "height": 740}, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.add_init_script(WATCH_SHIFTS)
    page.goto((pages / f"{name}.html").as_uri())
    page.wait_for_selector("html[data-ready]", state="attached")
    for _ in range(6):
        page.mouse.wheel(0, 600)
        page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert page.evaluate("window.shifts") == 0
    assert page.evaluate("document.documentElement.scrollWidth") == 360
    context.close()


@pytest.mark.parametrize(("name", "scheme"), [("fig5", "light"), ("both", "dark"), ("stranger", "light")])
def test_axe_finds_nothing_serious(browser: Browser, pages: Path, name: str, scheme: str) -> None:
    if not AXE.exists():
        pytest.skip(NO_TOOLS)
    found = opened(browser, pages / f"{name}.html", scheme=scheme)
    found.ready()
    found.page.locator("details").evaluate_all("(folded) => folded.forEach((each) => (each.open = true))")
    found.page.evaluate(AXE.read_text(encoding="utf-8"))
    violations = found.page.evaluate("axe.run().then((done) => done.violations)")
    serious = [
        (violation["id"], violation["help"], [node["html"][:200] for node in violation["nodes"][:3]])
        for violation in violations
        if violation["impact"] in ("serious", "critical")
    ]
    assert serious == []
    found.page.context.close()


def test_names_of_strangers_stay_texts(browser: Browser, pages: Path) -> None:
    found = opened(browser, pages / "stranger.html")
    found.ready()
    page = found.page
    assert page.locator("img").count() == 0
    expect(page.get_by_role("heading", level=1)).to_contain_text(HOSTILE)
    assert page.locator("#arm").count() == 0
    scrub(page, 0.4)
    assert value_of(page, "Columns (m)", "tank.level") == pytest.approx(0.16)
    output = curve(page, f"Columns ({HOSTILE})", f"tank.{HOSTILE}").locator("output")
    expect(output).to_have_text(f"-Infinity {HOSTILE}")
    assert found.complaints == []
    page.context.close()


def test_two_runs_are_overlaid_and_subtracted(browser: Browser, pages: Path, results: Mapping[str, Result]) -> None:
    one, two = results["fig5"], results["fig2"]
    found = opened(browser, pages / "both.html")
    found.ready()
    page = found.page
    verdict = verdict_of(compare(one, two), (len(one.time), len(two.time)))
    expect(page.locator("#differences > p").first).to_have_text(verdict)
    scrub(page, 0.48)
    panel = "Tracking error e = x - x_t (mm)"
    row = {label: round(0.96 / float(result.metadata["step"])) for label, result in results.items()}
    error = {label: 1e3 * result["controller.e[1]"][row[label] + 1] for label, result in results.items()}
    assert value_of(page, panel, "fig2: e1") == pytest.approx(error["fig2"], rel=1e-3, abs=2e-5)
    # The row of fig2 that has the value is 10 of fig5's rows later, and so is that of the difference.
    gap = 1e3 * (two["controller.e[1]"][row["fig2"]] - one["controller.e[1]"][row["fig5"]])
    assert value_of(page, f"Difference: {panel}", "e1") == pytest.approx(gap, rel=1e-3, abs=1e-4)
    assert page.locator("#arm .run").count() == 2
    assert found.complaints == []
    page.context.close()
