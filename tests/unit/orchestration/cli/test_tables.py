"""Tables of the command line: aligned where there is room, and whole where there is not."""

import pytest

from orchestration.cli.signals import HEAD
from orchestration.cli.tables import definitions, side_by_side, table

ROWS = [
    ("controller.tau_cmd[1]", "N.m", "-12.4345", "-5.12733", "-5.12733"),
    ("controller.e[1]", "m", "-1.91435e-07", "1.77471e-11", "-1.72161e-07"),
    ("actuator.saturated[1]", "", "0", "0", "0"),
]
WIDE = """\
signal                 unit           min          max         final
---------------------  ----  ------------  -----------  ------------
controller.tau_cmd[1]  N.m       -12.4345     -5.12733      -5.12733
controller.e[1]        m     -1.91435e-07  1.77471e-11  -1.72161e-07
actuator.saturated[1]                   0            0             0"""
NARROW = """\
controller.tau_cmd[1]  N.m
  min     -12.4345  max    -5.12733  final     -5.12733
controller.e[1]  m
  min -1.91435e-07  max 1.77471e-11  final -1.72161e-07
actuator.saturated[1]
  min            0  max           0  final            0"""


def signals(width: int) -> str:
    """The table of signals in a number of columns."""
    return table(HEAD, ROWS, width, numbers=HEAD[2:], together=2)


def test_a_wide_table_is_aligned() -> None:
    assert signals(120) == signals(68) == WIDE


def test_a_narrow_one_has_a_paragraph_for_each_row() -> None:
    assert signals(67) == signals(60) == NARROW


@pytest.mark.parametrize("width", [20, 30, 40, 60, 80, 120])
def test_nothing_is_cut(width: int) -> None:
    text = signals(width)
    assert max(map(len, text.splitlines())) <= max(width, len(ROWS[0][0]))
    words = text.split()
    assert all(cell in words for row in ROWS for cell in row if cell)


def test_the_last_column_is_folded_if_it_is_text() -> None:
    rows = [("mu", "", "Coefficient of friction along the wall"), ("K_f", "N/m", "Stiffness")]
    assert table(("name", "unit", "description"), rows, 38) == (
        "name  unit  description\n"
        "----  ----  --------------------------\n"
        "mu          Coefficient of friction\n"
        "            along the wall\n"
        "K_f   N/m   Stiffness"
    )
    assert table(("name", "unit", "description"), rows, 30) == (
        "mu\n  Coefficient of friction\n    along the wall\nK_f\n  unit N/m  Stiffness"
    )


def test_definitions_stand_beside_or_below_their_names() -> None:
    rows = [("fig2", "Conventional impedance control"), ("ideal", "A perfect sensor")]
    beside = "  fig2   Conventional impedance control\n  ideal  A perfect sensor"
    assert definitions(rows, 80, "  ") == beside
    assert definitions(rows, 30, "  ") == (
        "  fig2\n    Conventional impedance\n    control\n  ideal\n    A perfect sensor"
    )


def test_lines_stand_beside_or_above_their_text() -> None:
    rows = [(["plant.a = 1 m", "plant.b = 2 m"], "as the plane of motion is horizontal"), (["c = 3"], "any")]
    assert side_by_side(rows, 40) == (
        "plant.a = 1 m  as the plane of motion is\nplant.b = 2 m  horizontal\n\nc = 3          any"
    )
    assert side_by_side(rows, 30) == (
        "plant.a = 1 m\nplant.b = 2 m\n    as the plane of motion is\n    horizontal\n\nc = 3\n    any"
    )
