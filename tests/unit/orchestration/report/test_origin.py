"""Evidence that a page draws the system that was run, with the delays of its algorithm, and accounts for its energy."""

import re
from pathlib import Path

import numpy as np
import pytest

from orchestration import PowerBond, Result, System, ledger, simulate
from orchestration.report.diagram import diagram
from orchestration.report.origin import Link, origin_of
from orchestration.report.tables import NO_BONDS, Told, numbers_section


@pytest.fixture(scope="module")
def looped(fig2: System) -> Result:
    return simulate(fig2, stop_time=0.01)


def links(result: Result) -> dict[tuple[str, str], Link]:
    origin = origin_of(result)
    assert origin is not None
    return {(link.source, link.target): link for link in origin.links}


def test_delays_are_those_of_the_order(looped: Result) -> None:
    found = links(looped)
    assert found["plant", "controller"].signals == ["q", "dq", "ddq"]
    assert {pair: link.delayed for pair, link in found.items()} == {
        ("plant", "sensor"): True,
        ("plant", "controller"): True,
        ("sensor", "controller"): False,
        ("trajectory", "controller"): False,
        ("controller", "actuator"): False,
        ("actuator", "plant"): False,
    }


def test_jacobi_delays_every_connection(fig2: System) -> None:
    found = links(simulate(fig2, stop_time=0.01, algorithm="jacobi"))
    assert {link.delayed for link in found.values()} == {True}


def test_a_corrected_connection_has_no_known_delay(fig2: System) -> None:
    found = links(simulate(fig2, stop_time=0.01, algorithm="iterative"))
    assert {link.delayed for link in found.values()} == {None}


def test_a_file_without_metadata_has_no_origin() -> None:
    assert origin_of(Result(np.zeros(1), ("a.y",), np.zeros((1, 1)))) is None


def test_the_drawing_has_a_box_and_a_numbered_arrow_for_each(looped: Result) -> None:
    origin = origin_of(looped)
    assert origin is not None
    html = diagram(origin)
    assert html.count("<rect") == 5
    assert html.count('marker-end="url(#arrow)"') == 6
    assert html.count("stroke-dasharray") == 2
    heights = [float(y) for y in re.findall(r'<rect x="[\d.]+" y="([\d.]+)"', html)]
    assert heights == sorted(heights)


def test_a_system_without_bonds_has_no_ledger(fig2: System, looped: Result) -> None:
    html = numbers_section({"fig2": looped}, {"fig2": Told(fig2)}).html
    assert NO_BONDS in html


def test_the_ledger_of_a_bond_is_on_the_page(fig2: System) -> None:
    members = {name: fig2[name] for name in ("trajectory", "sensor", "controller", "plant")}
    system = System.of(members).connect().connect("controller.tau_cmd -> plant.tau")
    result = simulate(system, stop_time=0.05, step=1e-4)
    html = numbers_section({"run": result}, {"run": Told(system)}).html
    exact = ledger(result, PowerBond("controller.tau_cmd[1]", "plant.dq[1]"), system)
    assert f"{exact.given[-1]:.6g}" in html
    assert f"{exact.residual[-1]:.6g}" in html


def test_a_verdict_that_was_not_made_is_said(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    Result(np.array([0.0, 1.0]), ("a.y",), np.array([[1.0], [np.nan]])).write(path)
    html = numbers_section({"a": Result.read(path)}, {"a": Told()}).html
    assert "the file has no verdict" in html
    assert "which a file of rows does not have" in html
