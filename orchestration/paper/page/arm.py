"""The section of a page that shows the arm in motion: a drawing whose parts ``script/arm.js`` moves."""

import importlib.resources
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from orchestration.paper.numbers import ARM, WALL_NORMAL
from orchestration.report.markup import render
from orchestration.report.page import Section
from orchestration.results.result import Result

TIP, JOINTS, FORCE, GAP = "plant.x", "plant.q", "plant.F_ext", "plant.gap"
TORQUE, VIRTUAL, TARGET = "actuator.tau", "trajectory.x_v", "controller.x_t"
MOVED = (TIP, JOINTS, FORCE, TORQUE, VIRTUAL, TARGET)
"""Arrays that the drawing shows; all but the first may be missing."""
SCRIPT = "arm.js"
SCALE, ROOM = 100, 0.45  # units of the drawing for a metre; m around what moves
LENS = 46 + 6  # units: radius of the magnifier and room around it


def columns() -> list[str]:
    """Names of the columns that the drawing shows."""
    return [f"{name}[{i}]" for name in MOVED for i in (1, 2)]


def has_arm(result: Result) -> bool:
    """Whether a run has a planar arm that can be drawn: the place of its tip."""
    return TIP in result and result[TIP].shape[1:] == (2,) and len(result.time) > 0


def arm_of(result: Result) -> dict[str, Any]:
    """What ``extra.arm`` of a run holds: lengths of the links, m, and the wall too if the run has a gap to it."""
    start = json.loads(result.metadata.get("start", "{}")).get("plant", {})
    lengths = [float(start.get(f"l[{i}]", length)) for i, length in enumerate(ARM.link_lengths, 1)]
    if GAP not in result:
        return {"lengths": lengths}
    normal = np.array([float(start.get(f"wall_normal[{i}]", part)) for i, part in enumerate(WALL_NORMAL, 1)])
    offset = float(result[TIP][0] @ normal - result[GAP][0])
    return {"lengths": lengths, "normal": normal.tolist(), "offset": offset}


def arm_section(results: Mapping[str, Result]) -> Section:
    """The drawing of the arm in the runs that have one."""
    html = render(
        "orchestration.paper.page",
        "arm.html.j2",
        **_extent(list(results.values())),
        runs=list(results),
        label="The arm, its wall and its way at the time of the cursor",
        force=f"{_most(results, FORCE):.4g}",
        torque=f"{_most(results, TORQUE):.4g}",
        notes=[note for label, result in results.items() if (note := _missing(label, result))],
    )
    return Section("motion", "The arm in motion", html)


def script() -> Path:
    """The module that moves the drawing."""
    return Path(str(importlib.resources.files("orchestration.paper.page"))) / "script" / SCRIPT


def _most(results: Mapping[str, Result], name: str) -> float:
    """The largest absolute value of an element in any run; 0 without the array."""
    found = [float(np.nanmax(np.abs(result[name]))) for result in results.values() if name in result]
    return max(found, default=0.0)


def _missing(label: str, result: Result) -> str:
    missing = [name for name in MOVED if name not in result]
    return f"{label} has no {', '.join(missing)}, so these are not drawn." if missing else ""


def _extent(results: Sequence[Result]) -> dict[str, Any]:
    """The view of the drawing, and the place of the magnifier in its upper right corner."""
    points = np.concatenate(
        [np.zeros((1, 2)), *(result[n] for result in results for n in (TIP, VIRTUAL) if n in result)]
    )
    points = points[np.isfinite(points).all(axis=1)]
    reach = np.clip(np.abs(points).max(axis=0), 1.0, sum(ARM.link_lengths)) + ROOM
    (width, height) = np.round(SCALE * reach).astype(int).tolist()
    return {"view": f"{-width} {-height} {2 * width} {2 * height}", "lens": (width - LENS, -height + LENS)}
