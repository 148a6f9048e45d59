"""What the panels of the figures show: nothing is covered, axes are common, and every mark is computed from the run.

The figures are drawn at the scenarios' calibration and with another wall and depth: no window is a typed number.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from orchestration.paper.built_fmus import fmus
from orchestration.paper.figures import style
from orchestration.paper.figures.draw import _figures, draw
from orchestration.paper.figures.plane import stretched
from orchestration.paper.figures.run import Run
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.measure import at_ticks, contact, norms
from orchestration.paper.numbers import TARGET_INERTIA, TARGET_STIFFNESS
from orchestration.paper.scenarios import SCENARIOS
from orchestration.paper.tirt import sampling_offset

FIGURES = [name for name in SCENARIOS if name.startswith("fig")]
ELSEWHERE = {"plant.wall_offset": 1.40, "trajectory.wall_offset": 1.40, "trajectory.depth": 20e-3}
PLACES = {"chosen": {}, "elsewhere": ELSEWHERE}
PANELS = {name: 8 if name == "fig6" else 4 for name in FIGURES}
EDGE = 1.0  # pixel, half of a line's width

Drawn = tuple[Mapping[str, Run], Mapping[str, Figure]]


@pytest.fixture(scope="module", params=PLACES)
def drawn(request: pytest.FixtureRequest) -> Iterator[Drawn]:
    """Runs, and all figures, laid out as they are saved."""
    files = fmus({identifier for name in FIGURES for identifier in SCENARIOS[name].models.values()})
    laboratory = Laboratory(files)
    runs = {name: Run(laboratory.run(Job(name, PLACES[request.param]))) for name in FIGURES}
    with mpl.rc_context(style.STYLE):
        figures = _figures(runs)
        for figure in figures.values():
            figure.draw_without_rendering()
        yield runs, figures


def insets_of(axis: Axes) -> list[Axes]:
    return [child for child in axis.child_axes if isinstance(child, Axes)]


def boxes_of(inset: Axes) -> list[Bbox]:
    """Where an inset covers what is behind it: its frame, its title and the labels of its ticks, in pixels."""
    labels = [
        label
        for axis, (low, high) in ((inset.xaxis, inset.get_xlim()), (inset.yaxis, inset.get_ylim()))
        for label, place in zip(axis.get_ticklabels(), axis.get_ticklocs(), strict=True)
        if low <= place <= high  # others are placed, but not drawn
    ]
    return [inset.get_window_extent(), *(text.get_window_extent() for text in (inset.title, *labels))]


def panel(figure: Figure, letter: str) -> Axes:
    (found,) = [axis for axis in figure.axes if axis.get_title(loc="left").startswith(f"({letter})")]
    return found


def points_of(axis: Axes) -> np.ndarray:
    """All points of curves in an axis, in pixels, shape (n, 2); straight lines across the axis are left out."""
    curves = [line for line in axis.lines if line.get_transform() == axis.transData]
    return np.concatenate([axis.transData.transform(line.get_xydata()) for line in curves])


def inside(points: np.ndarray, box: Bbox) -> int:
    low, high = np.array(box.min) + EDGE, np.array(box.max) - EDGE
    return int(((points > low) & (points < high)).all(axis=1).sum())


def test_there_are_all_figures(drawn: Drawn) -> None:
    assert list(drawn[1]) == ["fig1", *FIGURES, "saturation", "torques"]
    for name, count in PANELS.items():
        for letter in "abcdefgh"[:count]:
            panel(drawn[1][name], letter)


def test_no_legend_and_no_inset_covers_data(drawn: Drawn) -> None:
    legends = insets = 0
    for figure in drawn[1].values():
        for axis in figure.axes:
            if legend := axis.get_legend():
                legends += 1
                assert legend.get_window_extent().y0 >= axis.get_window_extent().y1
            for inset in insets_of(axis):
                insets += 1
                for box in boxes_of(inset):
                    assert inside(points_of(axis), box) == 0, (axis.get_title(loc="left"), figure.get_suptitle())
    assert legends > 25
    assert insets > 15


def test_texts_are_inside_of_the_figure(drawn: Drawn) -> None:
    """Labels of ticks, titles and legends that were cut off at the edge of the picture."""
    for name, figure in drawn[1].items():
        page = figure.bbox
        box = figure.get_tightbbox().transformed(figure.dpi_scale_trans)
        assert page.x0 <= box.x0, name
        assert box.x1 <= page.x1, name
        assert page.y0 <= box.y0, name
        assert box.y1 <= page.y1, name


@pytest.mark.parametrize(("names", "letters"), [(("fig2", "fig4"), "abcd"), (("fig5", "fig6", "fig7"), "abcd")])
def test_figures_that_one_compares_have_the_same_axes(drawn: Drawn, names: tuple[str, ...], letters: str) -> None:
    for letter in letters:
        limits = {(axis.get_xlim(), axis.get_ylim()) for axis in (panel(drawn[1][name], letter) for name in names)}
        assert len(limits) == 1, letter


def test_every_curve_is_shown_whole(drawn: Drawn) -> None:
    for name in ("fig2", "fig4", "fig5", "fig7"):
        for letter in "abcd":
            axis = panel(drawn[1][name], letter)
            box = axis.get_window_extent()
            points = points_of(axis)
            assert inside(points, box.padded(2 * EDGE)) == len(points), (name, letter)


def test_only_the_time_of_touching_is_shaded(drawn: Drawn) -> None:
    runs, figures = drawn
    for name in ("fig2", "fig5"):
        run = runs[name]
        touch = contact(run.result)
        assert len(run.phases) == touch.phases > 1
        (bars,) = [c for c in panel(figures[name], "d").collections if c.get_label() == "touching"]
        extents = [path.get_extents() for path in bars.get_paths()]
        np.testing.assert_allclose([(e.x0, e.x1) for e in extents], run.phases, rtol=0, atol=1e-9)
        shaded = sum(e.width for e in extents)
        assert shaded < 0.95 * (touch.last - touch.first)  # the arm bounces once


def test_wall_and_depth_are_read_off_the_run(drawn: Drawn, request: pytest.FixtureRequest) -> None:
    chosen = {path: value.number for path, value in SCENARIOS["fig5"].values.items()}
    expected = chosen | PLACES[request.node.callspec.params["drawn"]]
    for run in drawn[0].values():
        assert run.wall_offset == pytest.approx(expected["plant.wall_offset"], abs=1e-12)
        # The deepest point of the straight segment itself, at a tick.
        assert run.depth == pytest.approx(expected["trajectory.depth"], abs=1e-9)


def test_the_stretched_view_says_by_how_much(drawn: Drawn) -> None:
    (inset,) = insets_of(panel(drawn[1]["fig5"], "a"))
    one, two = inset.transData.transform([(0.0, 0.0), (1e-3, 1e-3)])
    factor = (two[0] - one[0]) / (two[1] - one[1])
    said = float(stretched(inset).split()[2])
    assert said == pytest.approx(factor, rel=0.05)  # two digits
    assert stretched(inset) == inset.get_title()
    outer = panel(drawn[1]["fig5"], "a").transData.transform([(0.0, 0.0), (1.0, 1.0)])
    assert np.ptp(outer[:, 0]) == pytest.approx(np.ptp(outer[:, 1]))  # the panel itself is to scale


def test_measured_force_is_behind_the_force(drawn: Drawn) -> None:
    axis = panel(drawn[1]["fig5"], "d")
    labels = [str(line.get_label()) for line in axis.lines]
    assert "measured" in labels[0]
    assert "measured" not in labels[1]
    assert len(panel(drawn[1]["fig2"], "d").lines) == 1  # a perfect sensor


def test_the_dashed_line_is_the_steady_force(drawn: Drawn) -> None:
    run = drawn[0]["fig2"]
    (inset,) = insets_of(panel(drawn[1]["fig2"], "d"))
    (dashed,) = [line for line in inset.lines if line.get_linestyle() == "--"]
    height = float(np.asarray(dashed.get_ydata())[0])
    assert height == pytest.approx(TARGET_STIFFNESS * run.depth)
    # K depth is what the target impedance rests at: the force settles within 15 % of it before the tip leaves.
    end = run.result.time[run.sliding][-1]
    late = run.force[run.sliding & (run.result.time > end - 0.02)][:-50]
    assert np.median(late) == pytest.approx(height, rel=0.15)


def test_the_offset_of_the_tirt_is_that_of_its_sampling(drawn: Drawn) -> None:
    """Fig. 3 (d) has a floor of about 1e-3 mm, which the third derivative of the trajectory explains."""
    run = drawn[0]["fig3"]
    distance = 1e3 * norms(at_ticks(run.result, "controller.x_t") - run.x_v)
    free = (run.ticks > 0.3) & (run.ticks < 0.7)  # s: settled, before the contact
    lag = 2 * math.sqrt(TARGET_INERTIA / TARGET_STIFFNESS)  # s: B/K of the critically damped target impedance
    expected = np.interp(run.ticks[free], run.ticks + lag, 1e3 * sampling_offset(run.ticks))
    assert expected.max() > 1e-3  # mm
    # At pi rad/s, the amplitude of the impedance is 1/(1 + (pi lag / 2)^2) = 0.995 of the one at rest.
    np.testing.assert_allclose(distance[free], expected, rtol=0.006)


def test_the_tirt_without_sampling_stays_on_the_virtual_trajectory(drawn: Drawn) -> None:
    axis = panel(drawn[1]["fig3"], "d")
    curves = {str(line.get_label()): np.asarray(line.get_xydata()) for line in axis.lines}
    low = axis.get_ylim()[0]
    before = curves["by (11)"][:, 0] < drawn[0]["fig3"].span[0]
    assert (curves["by (11)"][before, 1] < low).all()
    assert curves["sampled"][-1, 1] > 1e3 * low  # mm


def test_fig6_shows_fig5_behind_and_the_difference(drawn: Drawn) -> None:
    runs, figures = drawn
    for letter in "abcd":
        assert any(line.get_label() == "Fig. 5" for line in panel(figures["fig6"], letter).lines)
    curve = panel(figures["fig6"], "g").lines[0]
    run, other = runs["fig6"], runs["fig5"]
    expected = 1e3 * (norms(run.e) - norms(other.e))  # µm
    assert np.asarray(curve.get_ydata()).max() == expected.max()  # thinned, with its extremes
    assert np.abs(expected).max() > 0


def test_torque_limits_are_where_the_actuator_cuts(drawn: Drawn) -> None:
    limit = SCENARIOS["fig6"].values["actuator.tau_max[1]"].number
    for name, letter in (("torques", "a"), ("fig6", "e")):
        dotted = [line for line in panel(drawn[1][name], letter).lines if line.get_linestyle() == ":"]
        assert sorted(float(np.asarray(line.get_ydata())[0]) for line in dotted) == [-limit, limit]


def test_the_bound_of_saturation_is_drawn_at_saturated_ticks(drawn: Drawn) -> None:
    ticks = int(drawn[0]["fig6"].saturated.any(axis=1).sum())
    assert ticks > 1
    curves = {
        letter: {
            str(line.get_label()): np.asarray(line.get_xydata()) for line in panel(drawn[1]["saturation"], letter).lines
        }
        for letter in "bcd"
    }
    assert [len(curves[letter]["while saturated"]) for letter in "bcd"] == [ticks] * 3
    assert (curves["d"]["while saturated"] < curves["d"]["reach of (28)"].max(axis=0)).all()


def test_an_unsaturated_run_shows_no_limit(drawn: Drawn) -> None:
    runs = drawn[0]
    figures = _figures({"fig5": runs["fig5"], "fig6": runs["fig5"], "fig7": runs["fig7"]})
    assert "saturation" not in figures
    assert panel(figures["fig6"], "e").get_title(loc="left").endswith("not saturated in contact")
    for name, letter in (("torques", "a"), ("fig6", "e")):
        assert not [line for line in panel(figures[name], letter).lines if line.get_linestyle() == ":"]


@pytest.mark.parametrize("image", ["png", "svg"])
def test_the_same_runs_give_the_same_bytes(drawn: Drawn, image: str, tmp_path: Path) -> None:
    files = [draw({"fig2": drawn[0]["fig2"].result}, tmp_path / folder, image) for folder in ("one", "two")]
    assert [path.name for path in files[0]] == [f"fig1.{image}", f"fig2.{image}"]
    for one, two in zip(*files, strict=True):
        assert one.read_bytes() == two.read_bytes(), one.name


def test_texts_of_an_svg_are_texts(drawn: Drawn, tmp_path: Path) -> None:
    *_, path = draw({"fig2": drawn[0]["fig2"].result}, tmp_path, "svg")
    text = path.read_text(encoding="utf-8")
    for title in ("(a) Ideal and actual trajectories", "(d) Contact force", "touching"):
        assert re.search(f"<text[^>]*>{re.escape(title)}</text>", text), title


def test_a_run_that_ends_at_the_impact_is_drawn(drawn: Drawn, tmp_path: Path) -> None:
    """The tip has not slid yet: no window may need a sliding tip."""
    whole = drawn[0]["fig2"]
    end = int(np.flatnonzero(whole.force > 0)[0]) + 2
    short = replace(whole.result, time=whole.result.time[:end], rows=whole.result.rows[:end])
    assert len(draw({"fig2": short}, tmp_path)) == 2


# Simulation of full deuteranopia in linear RGB: Machado, Oliveira & Fernandes (2009), severity 1.0.
DEUTERANOPIA = np.array(
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
)
RGB_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
TOGETHER = [  # colours of curves that cross in one panel
    (style.BLUE, style.ORANGE, style.GREY),
    (style.BLUE, style.VERMILLION, style.LIGHT, style.GREY),
    (style.SKY, style.VERMILLION, style.BLACK),
    (style.SKY, style.ORANGE, style.BLACK),
    (style.BLUE, style.GREEN, style.BLACK),
]


def lab(colour: str) -> np.ndarray:
    """CIE L*a*b* of a colour as a person with deuteranopia sees it."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = RGB_TO_XYZ @ np.clip(DEUTERANOPIA @ linear, 0, 1) / (RGB_TO_XYZ @ np.ones(3))
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def test_colours_differ_for_who_does_not_see_green() -> None:
    """A difference of 2.3 is just noticeable; ten times as much is seen in thin curves."""
    for colours in TOGETHER:
        for one, two in combinations(colours, 2):
            assert np.linalg.norm(lab(one) - lab(two)) > 23, (one, two)
    # tab:green and tab:red, which the test must tell to be too close.
    assert np.linalg.norm(lab("tab:green") - lab("tab:red")) < 40
