"""The panels of any runs: what they show, that nothing covers the curves, and that files can be reproduced."""

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from orchestration import Options, Result, System, simulate
from orchestration.paper.figures.overlay import missing_columns, overlay_figure
from orchestration.paper.figures.phases import CONTACT, FLIGHT, LIMITED, intervals, phases
from orchestration.paper.figures.theme import DARK_PAGE, LIGHT_PAGE, Theme
from orchestration.paper.measure import contact
from orchestration.results.picture_file import FORMATS, save


@pytest.fixture(scope="module")
def runs(fig2: System) -> dict[str, Result]:
    """Two runs whose torques are limited in one of them."""
    limit = {"actuator.tau_max[1]": 40.0, "actuator.tau_max[2]": 20.0}
    return {"free": simulate(fig2), "limited": simulate(fig2.set(limit), stop_time=1.2)}


def drawn(runs: Mapping[str, Result], theme: Theme = LIGHT_PAGE) -> Figure:
    with mpl.rc_context(theme.settings()):
        figure = overlay_figure(runs, theme, "runs")
        figure.draw_without_rendering()
    return figure


def test_intervals_end_at_the_last_instant_at_which_the_condition_holds() -> None:
    times = np.arange(6.0)
    found = intervals(times, np.array([True, False, True, True, False, True]))
    assert found.tolist() == [[0, 0], [2, 3], [5, 5]]
    assert intervals(times, np.zeros(6, bool)).shape == (0, 2)


def test_phases_are_those_of_the_run(runs: dict[str, Result]) -> None:
    free, limited = phases(runs["free"]), phases(runs["limited"])
    touch = contact(runs["free"])
    assert (free[CONTACT][0, 0], free[CONTACT][-1, 1], len(free[CONTACT])) == (touch.first, touch.last, touch.phases)
    assert np.array_equal(free[FLIGHT], np.column_stack([free[CONTACT][:-1, 1], free[CONTACT][1:, 0]]))
    assert LIMITED not in free
    # A value in row k + 1 was held from time[k] on, so the first band begins one row before.
    first = int(np.flatnonzero(runs["limited"]["actuator.saturated"].any(axis=1))[0])
    assert limited[LIMITED][0, 0] == runs["limited"].time[first - 1]


def test_panels_name_quantities_and_units(runs: dict[str, Result]) -> None:
    labels = [(axis.get_xlabel(), axis.get_ylabel()) for axis in drawn({"free": runs["free"]}).axes]
    assert labels == [
        ("$x_1$ (m)", "$x_2$ (m)"),
        ("t (s)", "torque (N m)"),
        ("t (s)", "error (mm)"),
        ("t (s)", "force (N)"),
    ]


def test_the_estimate_takes_the_place_of_the_torques_if_it_moves(runs: dict[str, Result]) -> None:
    result = runs["free"]
    moved = replace(result, rows=result.rows.copy())
    moved.rows[:, result.names.index("controller.p_hat[2]")] += result.time
    assert drawn({"a": moved}).axes[1].get_ylabel() == "mass (kg)"


def test_long_numbers_push_no_name_into_the_panel_on_the_left(runs: dict[str, Result]) -> None:
    result = runs["free"]
    moved = replace(result, rows=result.rows.copy())
    moved.rows[:, result.names.index("controller.p_hat[2]")] = -0.0014 * result.time / 2
    _, estimate, error, _ = drawn({"a": moved}).axes
    assert error.get_window_extent().x1 < estimate.yaxis.label.get_window_extent().x0


def test_no_legend_covers_a_panel(runs: dict[str, Result]) -> None:
    for chosen in ({"free": runs["free"]}, {"limited": runs["limited"]}, runs):
        figure = drawn(chosen)
        frames = [axis.get_window_extent() for axis in figure.axes]
        legends = [legend for axis in figure.axes if (legend := axis.get_legend())] + figure.legends
        assert len(legends) == 4 + (len(chosen) > 1)
        for legend in legends:
            box = legend.get_window_extent()
            assert box.x1 <= figure.bbox.x1, "the legend is cut"
            assert not any(box.y0 < frame.y1 - 1 and box.y1 > frame.y0 and box.overlaps(frame) for frame in frames)


def test_each_run_has_its_colour_and_each_component_its_dashes(runs: dict[str, Result]) -> None:
    error = [line for line in drawn(runs, DARK_PAGE).axes[2].get_lines() if len(line.get_xdata()) > 1]  # type: ignore[arg-type]
    looks = [(to_hex(line.get_color()).upper(), line.get_linestyle()) for line in error]  # type: ignore[arg-type]
    assert looks == [(colour, dashes) for colour in DARK_PAGE.curves[:2] for dashes in ("-", "--")]
    widths = [line.get_linewidth() for line in error]
    assert widths[0] > widths[2]  # so the first curve is seen under an equal one


def test_values_of_a_short_run_are_held_until_the_next_tick(fig2: System) -> None:
    result = simulate(fig2, stop_time=1e-3)
    line = drawn({"a": result}).axes[1].get_lines()[0]
    assert line.get_drawstyle() == "steps-post"
    times, torque = (np.asarray(data) for data in line.get_data())
    assert np.array_equal(times, result.time)
    assert np.array_equal(torque[:-1], result.at_ticks("actuator.tau[1]"))
    assert torque[-1] == torque[-2]


def test_a_run_without_contact_is_drawn(fig2: System) -> None:
    figure = drawn({"a": simulate(fig2, stop_time=0.1)})
    assert [text.get_text() for text in figure.axes[3].get_legend().get_texts()] == ["measured", r"$\|F_{ext}\|$"]  # type: ignore[union-attr]


@pytest.mark.parametrize("every", [7, 100])
def test_runs_without_all_ticks_and_of_one_row_are_drawn(fig2: System, every: int) -> None:
    result = simulate(fig2, stop_time=0.05, options=Options(every=every))
    assert len(drawn({"a": result, "b": result}).axes) == 4
    one = replace(result, time=result.time[:1], rows=result.rows[:1])
    assert len(drawn({"a": one}).axes) == 4


def test_values_that_are_no_numbers_leave_the_limits_finite(fig2: System) -> None:
    result = simulate(fig2, stop_time=0.05)
    rows = result.rows.copy()
    rows[100:, result.names.index("plant.x[1]")] = np.nan
    axis = drawn({"a": replace(result, rows=rows)}).axes[0]
    assert np.isfinite([axis.get_xlim(), axis.get_ylim()]).all()


def test_missing_columns_are_named(fig2: System) -> None:
    result = simulate(fig2, stop_time=1e-3, record=["plant.x", "controller.tau_cmd"])
    assert missing_columns(result) == ["controller.e", "plant.F_ext"]
    assert missing_columns(simulate(fig2, stop_time=1e-3, record=["plant.q"])) == [
        "plant.x",
        "controller.e",
        "plant.F_ext",
        "actuator.tau",
    ]


@pytest.mark.parametrize("suffix", FORMATS)
def test_files_can_be_reproduced(runs: dict[str, Result], tmp_path: Path, suffix: str) -> None:
    for name in ("a", "b"):
        with mpl.rc_context(LIGHT_PAGE.settings()):
            save(overlay_figure(runs, LIGHT_PAGE, "runs"), tmp_path / f"{name}{suffix}")
    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_texts_in_svg_are_texts(runs: dict[str, Result], tmp_path: Path) -> None:
    with mpl.rc_context(LIGHT_PAGE.settings()):
        save(overlay_figure(runs, LIGHT_PAGE, "runs"), tmp_path / "a.svg")
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert re.search(r"<text[^>]*>error \(mm\)</text>", text)
    assert "<dc:date>" not in text
