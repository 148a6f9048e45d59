"""The moving picture of an arm: where its joints are, what each picture shows, and which runs it refuses."""

from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image

from orchestration import Result, System, simulate
from orchestration.errors import OrchestrationError
from orchestration.paper.figures import moving
from orchestration.paper.figures.moving import joint_positions, moving_picture
from orchestration.paper.figures.theme import LIGHT_PAGE
from orchestration.results.picture_file import MOVING

BELOW = 130  # pixels, of 396: all legends are above
EPS = np.finfo(float).eps


@pytest.fixture(scope="module")
def run(fig2: System) -> Result:
    """A run until the tip slides along the wall, of which few pictures are made."""
    return simulate(fig2, stop_time=1.05)


@pytest.fixture(scope="module")
def file(run: Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("moving") / "fig2.webp"
    write(run, path)
    return path


def write(run: Result, path: Path) -> None:
    with mpl.rc_context(LIGHT_PAGE.settings()), pytest.MonkeyPatch.context() as patch:
        patch.setattr(moving, "PICTURES", 8)
        moving_picture("fig2", run, LIGHT_PAGE, path)


def test_joints_are_found_without_the_lengths_of_the_links(run: Result) -> None:
    """Both links are 1 m long. Rounding of lstsq is about eps by the condition of the equations, which is below 10."""
    joints = joint_positions("fig2", run)
    assert joints.shape == (len(run.time), 3, 2)
    assert np.allclose(np.linalg.norm(np.diff(joints, axis=1), axis=2), 1.0, rtol=0, atol=1e3 * EPS)
    assert np.allclose(joints[:, -1], run["plant.x"], rtol=0, atol=1e3 * EPS)


def test_pictures_move_and_repeat_for_ever(file: Path) -> None:
    with Image.open(file) as picture:
        assert getattr(picture, "n_frames", 1) == 8
        assert picture.info["loop"] == 0
        picture.seek(2)
        first = np.asarray(picture.convert("RGB"), dtype=int)
        picture.seek(5)
        last = np.asarray(picture.convert("RGB"), dtype=int)
    changed = np.abs(first - last).max(axis=2) > 60
    assert changed[:, : changed.shape[1] // 2].sum() > 300, "the arm stands"
    assert changed[:, changed.shape[1] // 2 :].sum() > 100, "the cursors stand"


def test_the_force_is_drawn_while_the_tip_touches_only(file: Path) -> None:
    """The arrow is the only large red part of the left half; below the legend there is none in free motion."""

    def reds(number: int) -> int:
        with Image.open(file) as picture:
            picture.seek(number)
            pixels = np.asarray(picture.convert("RGB"), dtype=int)
        red, green, blue = np.moveaxis(pixels[BELOW:, : pixels.shape[1] // 2], 2, 0)
        return int(np.sum((red > 170) & (green < 140) & (blue < 90)))

    assert reds(0) == 0
    assert reds(7) > 50


def test_the_same_run_gives_the_same_bytes(run: Result, file: Path, tmp_path: Path) -> None:
    write(run, tmp_path / "again.webp")
    assert (tmp_path / "again.webp").read_bytes() == file.read_bytes()


def test_both_formats_can_be_read(run: Result, tmp_path: Path) -> None:
    for suffix in MOVING:
        write(run, tmp_path / f"x{suffix}")
        with Image.open(tmp_path / f"x{suffix}") as picture:
            assert picture.format == suffix[1:].upper()


def test_an_arm_that_is_not_planar_is_refused(run: Result, tmp_path: Path) -> None:
    bent = replace(run, rows=run.rows.copy())
    bent.rows[:, bent.names.index("plant.x[1]")] *= 1.01
    with pytest.raises(OrchestrationError, match=r"no lengths of links lead from plant.q to plant.x, .* planar arms"):
        write(bent, tmp_path / "x.webp")
    assert not list(tmp_path.iterdir())


def test_missing_columns_are_named(fig2: System) -> None:
    tip = simulate(fig2, stop_time=0.01, record=["plant.x"])
    with pytest.raises(OrchestrationError, match=r"needs plant.q, plant.F_ext; record all columns of the plant"):
        joint_positions("fig2", tip)


def test_a_pose_and_a_run_that_diverged_are_refused(run: Result) -> None:
    pose = replace(run, names=tuple("plant.x[3]" if name == "plant.gap" else name for name in run.names))
    with pytest.raises(OrchestrationError, match=r"an arm in the plane, and plant.x has 3 elements; choose"):
        joint_positions("fig2", pose)
    lost = replace(run, rows=run.rows.copy())
    lost.rows[-1, lost.names.index("plant.q[1]")] = np.nan
    with pytest.raises(OrchestrationError, match=r"an arm in the plane, and a row is not finite; choose"):
        joint_positions("fig2", lost)
