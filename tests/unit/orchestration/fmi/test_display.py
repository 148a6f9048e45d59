"""Tables of variables: arrays share a row where they can, start values in force are shown, and nothing is lost."""

import re
from dataclasses import replace

from orchestration import System
from orchestration.fmi.display import MOST_VARIABLES, Variables, variables_html


def rows(table: str) -> dict[str, list[str]]:
    """Cells by the text of the first cell of their row."""
    found = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", table)]
    return {cells[0]: cells[1:] for cells in found if cells}


def test_elements_share_a_row_unless_they_are_described_differently(fig2: System) -> None:
    variables = fig2["controller"].description.variables
    found = rows(variables_html(variables, {"K[2]": 1.0}))
    assert found["K [2]"][2:4] == ["N/m", "4000, 1"]
    assert found["M [2]"][2:4] == ["kg", "2"]
    assert found["tau_cmd [2]"][3] == ""
    assert {"p_start[1]", "p_start[2]"} <= set(found)  # masses of two links
    assert next(iter(found)) == "q [2]"  # inputs come first


def test_long_tables_say_how_much_is_left_out(fig2: System) -> None:
    one = fig2["plant"].variable("gap")
    many = Variables({f"gap_{i}": replace(one, name=f"gap_{i}") for i in range(MOST_VARIABLES + 5)})
    assert list(rows(many._repr_html_()))[-1] == "and 5 more"
    assert repr(many) == f"<{MOST_VARIABLES + 5} variables: {', '.join(f'gap_{i}' for i in range(8))}, and 57 more>"
