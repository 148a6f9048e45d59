"""Pictures of tables: what is drawn is what the table holds, failed runs included, with units on the axes."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from SALib.sample import sobol

from orchestration import StudyError, UnknownNameError, plot_table
from orchestration.campaigns.pictures.cells import edges
from orchestration.campaigns.pictures.plot_table import KINDS, best_kind
from orchestration.campaigns.view import View, spread_by_ratio
from tests.unit.orchestration.campaigns.tables import MASSES, SEEDS, K, force, grid, samples

MAP = grid({"K_f": K, "m": MASSES}, force, lambda K_f, m: K_f * m > 1.5e6)
NOISY = grid({"K_f": K, "m": MASSES, "seed": SEEDS}, force, lambda K_f, m, seed: (K_f * m > 5e5) & (seed > m))
SEEDED = grid({"K_f": K, "seed": SEEDS}, force)
ONLY_SEEDS = grid({"seed": SEEDS, "K_f": K[:1]}, force)
VARIANTS = grid({"system": np.array(["craig", "slotine-li"], object), "K_f": K, "seed": SEEDS}, force)
POINTS = pd.DataFrame({"K_f": np.geomspace(1e3, 1e6, 100), "m": np.tile([0.5, 2.0, 1.0, 4.0], 25)})
SAMPLED = samples(POINTS, np.where(POINTS["m"] > 3, np.nan, force(**POINTS.to_dict("series"))))
SALTELLI = samples(
    (points := pd.DataFrame(
        sobol.sample({"num_vars": 2, "names": ["K_f", "m"], "bounds": [[1e3, 1e6], [0.5, 2.0]]}, 8, seed=1),
        columns=["K_f", "m"],
    )),
    force(**points.to_dict("series")),
)  # fmt: skip
ALL_FAILED = grid({"K_f": K, "m": MASSES, "seed": SEEDS}, force, lambda K_f, **_: K_f > 0)


def labels(figure: Figure) -> list[tuple[str, str]]:
    return [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes if axes.get_visible()]


def colours(figure: Figure) -> np.ndarray:
    """Numbers behind the colours of the first panel's cells; NaN where a cell has none."""
    return np.ma.filled(np.ma.asarray(figure.axes[0].collections[0].get_array(), dtype=float), np.nan)


def points_of(figure: Figure, label: str) -> list[np.ndarray]:
    """Abscissas and ordinates of a curve, by its entry in the legend, for each panel that has it."""
    return [np.asarray(line.get_data()) for axes in figure.axes for line in axes.lines if line.get_label() == label]


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for found in figure.legends for text in found.get_texts()]


def test_each_table_has_the_picture_that_suits_it() -> None:
    tables = (MAP, NOISY, SEEDED, ONLY_SEEDS, VARIANTS, SAMPLED, SALTELLI, grid({"K_f": K}, force))
    kinds = ["heat-map", "heat-map", "seeds", "seeds", "seeds", "marginals", "sensitivity", "marginals"]
    assert [best_kind(View.of(table, "peak")) for table in tables] == kinds
    constant = samples(points, np.ones(len(points)))  # has no variance to share out
    assert best_kind(View.of(constant, "peak")) == "marginals"


def test_a_heat_map_shows_medians_and_hatches_what_failed() -> None:
    figure = plot_table(NOISY, "peak")
    np.testing.assert_array_equal(colours(figure), NOISY["peak"].median("seed", skipna=True).transpose("m", "K_f"))
    assert labels(figure)[0] == ("K_f (N/m)", "m (kg)")
    assert figure.axes[1].get_ylabel() == "peak (N), median of 4 runs"
    assert (figure.axes[0].get_xscale(), figure.axes[0].get_yscale()) == ("log", "log")
    assert legend(figure) == ["some runs failed, or have no value"]
    failed = plot_table(MAP, "peak")
    (hatched,) = failed.axes[0].collections[1].get_paths()
    corner = np.asarray(hatched.vertices).max(axis=0)
    assert (corner > [K[-1], MASSES[-1]]).all()  # the cell around the last levels, which fails alone
    assert legend(failed) == ["all runs failed, or none has a value"]


def test_a_boundary_is_where_runs_keep_within_the_limit() -> None:
    figure = plot_table(MAP, "peak", limit=300.0)
    np.testing.assert_array_equal(colours(figure), (MAP["peak"] <= 300).transpose("m", "K_f"))
    assert legend(figure) == ["peak ≤ 300 N", "otherwise (crosses)", "boundary"]
    value = float(MAP["peak"].sel(K_f=K[2], m=1.0))  # a limit may be met exactly
    met = colours(plot_table(MAP, "peak", limit=value))
    np.testing.assert_array_equal(met, (MAP["peak"] <= value).transpose("m", "K_f"))
    success = plot_table(NOISY, "peak", kind="boundary")
    share = (NOISY["status"] == "complete").mean("seed").transpose("m", "K_f")
    np.testing.assert_array_equal(colours(success), share)
    assert success.axes[1].get_ylabel() == "share of the runs that are good (the run succeeds)"


def test_marginals_are_quantiles_over_all_else() -> None:
    figure = plot_table(NOISY, "peak", kind="marginals")
    assert labels(figure) == [("K_f (N/m)", "peak (N)"), ("m (kg)", "")]
    levels, medians = points_of(figure, "median")[1]
    np.testing.assert_array_equal(levels, MASSES)
    np.testing.assert_array_equal(medians, NOISY["peak"].median(["K_f", "seed"], skipna=True))
    failed = int(NOISY["peak"].isnull().sum())
    assert f"{failed} of 48 runs without a value" in legend(figure)


def test_samples_are_put_into_groups_of_neighbours() -> None:
    figure = plot_table(SAMPLED, "peak")
    part = SAMPLED.iloc[:10]
    first = points_of(figure, "median of neighbours")[0][:, 0]
    assert first.tolist() == [part["K_f"].median(), part["peak"].median()]
    assert figure.axes[0].get_xscale() == "log"
    dots = plot_table(SAMPLED, "peak", kind="boundary")
    assert [np.size(line.get_xdata()) for line in dots.axes[0].lines] == [75, 25]


def test_the_spread_over_seeds_is_drawn_for_each_variant() -> None:
    figure = plot_table(VARIANTS, "peak")
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert list(lines) == ["craig: median", "slotine-li: median"]
    np.testing.assert_array_equal(lines["craig: median"].get_ydata(), VARIANTS["peak"][0].median("seed"))
    assert lines["craig: median"].get_linestyle() != lines["slotine-li: median"].get_linestyle()
    only = plot_table(ONLY_SEEDS, "peak")
    np.testing.assert_array_equal(only.axes[0].lines[0].get_xdata(), np.sort(ONLY_SEEDS["peak"].values.ravel()))


def test_indices_are_drawn_with_the_strongest_on_top() -> None:
    figure = plot_table(SALTELLI, "peak")
    names = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert names == ["m", "K_f"]
    assert "Sobol indices of Saltelli's points, 48 points" in figure.axes[0].get_xlabel()


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "sensitivity"])
def test_a_table_of_failed_runs_has_a_picture_too(kind: str, tmp_path: Path) -> None:
    plot_table(ALL_FAILED, "peak", tmp_path / "failed.png", kind=kind)
    assert (tmp_path / "failed.png").stat().st_size > 1000


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_same_table_gives_the_same_bytes(suffix: str, tmp_path: Path) -> None:
    files = [tmp_path / name / f"peak.{suffix}" for name in ("a", "b")]
    for file in files:
        plot_table(NOISY, "peak", file)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_a_legend_stays_within_its_figure(tmp_path: Path) -> None:
    figure = plot_table(VARIANTS, "peak", tmp_path / "variants.png")
    box = figure.legends[0].get_window_extent()
    assert 0 <= box.x0 < box.x1 <= figure.bbox.width
    assert box.y0 >= figure.axes[0].get_window_extent().y1  # above the panel, so it hides nothing


def test_scales_follow_the_values() -> None:
    assert spread_by_ratio(np.geomspace(1, 5, 4))
    assert spread_by_ratio(np.array([50.0, 100.0, 200.0]))
    assert spread_by_ratio(np.array([1.0, 10.0]))
    assert not spread_by_ratio(np.array([1.0, 2.0]))
    assert not spread_by_ratio(np.linspace(1, 100, 20))
    assert not spread_by_ratio(np.array([0.0, 1.0, 10.0]))
    rng = np.random.default_rng(1)
    assert spread_by_ratio(np.exp(rng.uniform(0, 9, 50)))
    assert not spread_by_ratio(rng.uniform(1, 1e4, 50))


def test_cells_end_between_their_levels() -> None:
    np.testing.assert_array_equal(edges(np.array([1.0, 2.0, 4.0]), logarithmic=False), [0.5, 1.5, 3, 5])
    np.testing.assert_allclose(edges(np.array([1.0, 100.0]), logarithmic=True), [0.1, 10, 1000], rtol=1e-14)
    np.testing.assert_array_equal(edges(np.array([0.1, 10.0]), logarithmic=False), [0, 5.05, 14.95])  # none is negative


RATES = grid({"K_f": K, "m": MASSES}, lambda **f: force(**f) - 900).rename(peak="growth_rate")


def test_predicted_stability_is_drawn_over_a_boundary() -> None:
    figure = plot_table(MAP, "peak", stability=RATES)
    rings = next(line for line in figure.axes[0].lines if line.get_marker() == "o")
    drawn = set(zip(*(np.asarray(some).tolist() for some in rings.get_data()), strict=True))
    assert drawn == {(k, m) for k in K for m in MASSES if np.sqrt(k * m) > 900}
    assert legend(figure)[-1].startswith("predicted border of stability")


REFUSED: dict[str, tuple[Any, dict[str, Any]]] = {
    "There is no picture of the kind 'heatmap'; did you mean heat-map?": (MAP, {"kind": "heatmap"}),
    "A map needs two factors that vary besides seeds, and the table has K_f": (SEEDED, {"kind": "heat-map"}),
    "No seed varies in the table": (MAP, {"kind": "seeds"}),
    "make them by the stability of the same study, without seeds": (MAP, {"stability": RATES.isel(m=slice(2))}),
    "The growth rates are not those of a grid": (SAMPLED, {"stability": RATES}),
    "The limit is 'low'; give a plain number, in N.": (MAP, {"limit": "low"}),
    "a picture cannot have the suffix .gif; choose .png, .svg, .pdf.": (MAP, {"path": "peak.gif"}),
    "a picture needs a suffix; choose": (MAP, {"path": "peak"}),
    "the picture cannot be written": (MAP, {"path": "/proc/none/peak.png"}),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_cannot_be_drawn_is_refused(message: str) -> None:
    table, options = REFUSED[message]
    with pytest.raises(StudyError) as caught:
        plot_table(table, "peak", **options)
    assert message in str(caught.value)


def test_a_wrong_measure_is_told_with_near_names() -> None:
    with pytest.raises(UnknownNameError, match=r"no measure 'peek'; did you mean peak\?"):
        plot_table(SAMPLED, "peek")
