"""The paper's runs in space: sizes of poses, the view of a path, numbers that follow from the robot, scaled limits."""

from pathlib import Path

import casadi as ca
import matplotlib as mpl
import numpy as np
import pytest

from fmus.robots.puma560 import PATH, PUMA
from orchestration import Result, simulate
from orchestration.paper import spatial_numbers as space
from orchestration.paper.built_fmus import fmus
from orchestration.paper.cases import PLANAR_CASE, PUMA_CASE, case_of
from orchestration.paper.claims.criteria import BOUNDED_ERROR, M2_IN_CONTACT, SLIGHTLY_LARGER_FORCE
from orchestration.paper.figures.overlay import missing_columns, overlay_figure
from orchestration.paper.figures.spatial import draw_in_space
from orchestration.paper.figures.theme import LIGHT_PAGE
from orchestration.paper.figures.view import View, wall_of
from orchestration.paper.page.panels import paper_panels
from orchestration.paper.run_numbers import IN_SPACE, columns_needed, columns_to_read, run_numbers, sentences
from orchestration.paper.spatial_scenarios import SPATIAL
from orchestration.paper.spatial_theory import kinetic_energy
from orchestration.paper.task_shape import forces, lengths, norms, scales, shape_of
from orchestration.results.some_columns import read_some_columns

RANDOM = np.random.default_rng(18)
L = space.LENGTH


@pytest.fixture(scope="module")
def result() -> Result:
    """The first half of the run ``puma`` and its contact."""
    scenario = SPATIAL["puma"]
    return simulate(scenario.system(fmus(scenario.models.values())), stop_time=1.1)


def test_an_angle_counts_its_length_and_a_moment_its_force() -> None:
    vectors = RANDOM.standard_normal((5, 6))
    S = np.diag([1.0, 1.0, 1.0, L, L, L])
    assert np.array_equal(scales(6), np.diag(S))
    np.testing.assert_allclose(lengths(vectors), np.linalg.norm(vectors @ S, axis=1), rtol=1e-15)
    np.testing.assert_allclose(forces(vectors), np.linalg.norm(vectors @ np.linalg.inv(S), axis=1), rtol=1e-15)


def test_planar_sizes_have_the_bits_of_numpy() -> None:
    vectors = RANDOM.standard_normal((100, 2))
    expected = np.array([np.linalg.norm(v) for v in vectors])
    for size in (norms, lengths, forces):
        assert size(vectors).tobytes() == expected.tobytes()


def test_a_run_tells_its_task(result: Result) -> None:
    shape = shape_of(result)
    assert (shape.size, shape.joints, shape.positions) == (6, 6, 3)
    assert shape == PUMA_CASE.shape
    assert result.unit(shape.estimate) == "kg"
    assert result[shape.estimate][0] == space.BELIEVED_PAYLOAD


def test_the_estimate_of_seven_joints_is_that_of_the_payload(tmp_path: Path) -> None:
    """Parameter 79 is the payload's mass of six joints, and the mass of the last link of seven ones."""
    p_hat, joints = [f"controller.p_hat[{k}]" for k in range(1, 102)], range(1, 8)
    names = (*p_hat, *(f"controller.e[{i}]" for i in range(1, 7)), *(f"controller.tau_cmd[{i}]" for i in joints))
    rows = np.zeros((3, len(names)))
    rows[:, [names.index("controller.p_hat[79]"), names.index("controller.p_hat[92]")]] = 5.0, 0.8
    made = Result(np.arange(3) * 1e-4, names, rows, units=dict.fromkeys(p_hat, "kg"))
    assert sentences(run_numbers(made)) == ["estimate of the payload's mass at the end: 0.8 kg"]
    made.write_parquet(tmp_path / "seven.parquet")
    assert run_numbers(read_some_columns(tmp_path / "seven.parquet", columns_to_read())) == run_numbers(made)


def test_numbers_are_those_of_the_robot_that_the_fmus_have() -> None:
    """The scenarios state plain numbers, for they must be readable where CasADi is not installed."""
    assert space.payload_parameters() == pytest.approx(tuple(PUMA.payload.parameters), rel=1e-15)
    assert space.TABLE_NORMAL == PATH.wall_normal
    assert PUMA.payload.mass == space.TRUE_PAYLOAD
    assert space.JOINTS == PUMA.n
    assert sum(PUMA.uncertain[: space.FIRST_OF_PAYLOAD - 1]) == 0
    assert PUMA.parameters[space.FIRST_OF_PAYLOAD - 1].text == "payload: mass"


def test_the_tip_starts_on_the_ellipse_and_moves_with_it() -> None:
    """Ten digits of the joints are 1e-10 rad, and so 1e-10 m of an arm that is a metre long."""
    place, J = (np.array(value) for value in PUMA._place(space.Q_START))
    x, y, z = space.ELLIPSE_CENTER
    assert place.ravel() == pytest.approx([x, y, z + space.ELLIPSE[0], 0, 0, 0], abs=2e-10)
    speed = space.ELLIPSE[1] * np.pi  # once around in 2 s
    assert J @ space.DQ_START == pytest.approx([0, -speed, 0, 0, 0, 0], abs=1e-9)


def test_the_numbers_follow_their_rules() -> None:
    values = {path: value.number for path, value in SPATIAL["puma"].values.items()}
    planar = {path: value.number for path, value in PLANAR_CASE.scenario("fig7").values.items()}
    for i in range(1, 7):
        for name in ("K", "B", "K_d"):
            own, paper = (v[f"controller.{name}[{k}]"] / v[f"controller.M[{k}]"] for v, k in ((values, i), (planar, 1)))
            assert own == pytest.approx(paper, rel=1e-12), name
        assert values[f"controller.Psi[{i}]"] == planar["controller.Psi[1]"]
    gains = [values[f"controller.Gamma[{i}]"] for i in PUMA_CASE.true]
    assert np.array(gains[1:4]) == pytest.approx(gains[0] * space.PAYLOAD_LENGTH**2)
    assert np.array(gains[4:]) == pytest.approx(gains[0] * space.PAYLOAD_LENGTH**4)


def test_torque_limits_are_within_those_of_the_motors() -> None:
    largest = np.array(space.TORQUE_LIMITS) / 0.75
    assert (largest < space.EFFORT).all()


def test_every_assumed_number_has_its_reason() -> None:
    for scenario in SPATIAL.values():
        for path, value in scenario.values.items():
            assert value.origin, path
            assert not value.assumed or len(value.origin) > len("assumed: ") + 10, path


def test_kinetic_energy_is_that_of_rates_that_move_the_tip_with_s() -> None:
    q = np.array([0.1, -1.3, 3.0, 0.2, 1.4, -0.3]) + 0.1 * RANDOM.standard_normal((4, 6))
    s = RANDOM.standard_normal((4, 6))
    p = ca.DM([*PUMA.chain.p, *space.payload_parameters()])
    model = PUMA._model
    for found, joints, rates in zip(kinetic_energy(q, s), q, s, strict=True):
        J = np.array(ca.evalf(model.jacobian(ca.SX(ca.DM(joints)))))
        H = np.array(ca.evalf(model.inertia(ca.SX(ca.DM(joints)), ca.SX(p))))
        dq = np.linalg.solve(J, rates)
        assert found == pytest.approx(dq @ H @ dq, rel=1e-10)


def test_limits_that_are_lengths_or_forces_are_scaled() -> None:
    assert BOUNDED_ERROR.scaled(0.25).limit == BOUNDED_ERROR.limit / 4
    assert SLIGHTLY_LARGER_FORCE.scaled(0.25).limit == SLIGHTLY_LARGER_FORCE.limit / 4
    assert "0.25 of the limit" in str(BOUNDED_ERROR.scaled(0.25))
    assert M2_IN_CONTACT.scaled(0.25) is M2_IN_CONTACT
    assert BOUNDED_ERROR.scaled(1.0) is BOUNDED_ERROR


def test_scenarios_belong_to_their_case() -> None:
    assert case_of("puma-craig") is PUMA_CASE
    assert case_of("fig5-first") is PLANAR_CASE
    assert set(PUMA_CASE.runs.values()) == set(SPATIAL)


def test_numbers_of_a_run_join_no_metres_and_radians(result: Result) -> None:
    numbers = run_numbers(result)
    assert tuple(numbers) == IN_SPACE
    assert {name: number.unit for name, number in numbers.items() if "angle" in name or "position" in name} == {
        name: "rad" if "angle" in name else "m" for name in IN_SPACE if "angle" in name or "position" in name
    }
    e = result.at_ticks("controller.e")
    largest = max(numbers[f"max_position_{where}"].value or 0.0 for where in ("free", "contact"))
    assert largest == pytest.approx(np.linalg.norm(e[:, :3], axis=1).max(), rel=1e-12)
    said = "\n".join(sentences(numbers))
    assert "estimate of the payload's mass at the end: 1.0" in said
    assert said.count("of the orientation") == 2
    assert set(columns_needed(IN_SPACE)) <= {*result.names, "controller.e", "plant.F_ext", "actuator.saturated"}


def test_a_path_is_seen_along_the_axis_along_which_it_moves_least(result: Result) -> None:
    wall = wall_of(result)
    assert wall is not None
    assert wall[1] == pytest.approx(space.TABLE_OFFSET, abs=1e-12)
    view = View.of(result["plant.x"], wall)
    assert view.axes == (1, 2)
    corners = view.wall(np.array([-0.1, -0.1]), np.array([0.4, 0.3]))
    expected = np.array([(-0.1, -0.1), (0.4, -0.1), (0.4, -0.044), (-0.1, -0.044)])
    np.testing.assert_allclose(corners, expected, atol=1e-12)
    assert view.wall(np.array([-0.1, 0.0]), np.array([0.4, 0.3])) == []


def test_a_wall_across_the_line_of_sight_is_not_drawn(result: Result) -> None:
    slanted = np.array([0.6, 0.0, -0.8]), 0.04
    assert View.of(result["plant.x"], slanted).wall(np.zeros(2), np.ones(2)) == []


def test_four_panels_show_six_coordinates_and_no_legend_covers_another(result: Result) -> None:
    assert missing_columns(result) == []
    with mpl.rc_context(LIGHT_PAGE.settings()):
        figure = overlay_figure({"puma": result}, LIGHT_PAGE, "puma")
        figure.draw_without_rendering()
    _, estimate, error, force = figure.axes
    assert "payload" in estimate.get_title(loc="left")
    legends = error.get_legend(), force.get_legend()
    assert legends[0] is not None
    assert legends[1] is not None
    labels = [text.get_text() for text in legends[0].get_texts()]
    assert labels == ["$e_1$", "$e_2$", "$e_3$", "$L e_4$", "$L e_5$", "$L e_6$"]
    left, right = legends[0].get_window_extent(), legends[1].get_window_extent()
    assert left.x1 < right.x0
    rows = np.array(error.get_lines()[5].get_ydata(), float)
    assert rows.max() == pytest.approx(1e3 * L * result["controller.e[6]"].max(), rel=1e-9)


def test_several_runs_show_the_size_of_their_errors(result: Result) -> None:
    with mpl.rc_context(LIGHT_PAGE.settings()):
        figure = overlay_figure({"one": result, "two": result}, LIGHT_PAGE, "both")
    error = figure.axes[2]
    assert r"\|S e\|" in error.get_title(loc="left")
    curves = [np.array(line.get_ydata(), float) for line in error.get_lines()]
    size = 1e3 * lengths(result.at_ticks("controller.e"))
    assert max(curve.max() for curve in curves if curve.size > 9) == pytest.approx(size.max(), rel=1e-9)


def test_a_page_shows_errors_of_positions_and_of_angles(result: Result) -> None:
    panels = {panel.title: panel for panel in paper_panels([result])}
    assert [len(panels[title].curves) for title in ("Tracking error e = x - x_t", "Tracking error of the angles")] == [
        3,
        3,
    ]
    assert len(panels["Torques of the actuators"].curves) == 6
    assert "Estimated mass of the payload" in panels


def test_figures_are_drawn(result: Result, tmp_path: Path) -> None:
    names = ("fig2", "fig3", "fig4", "fig5", "fig6", "fig7")
    files = draw_in_space(dict.fromkeys(names, result), dict.fromkeys(names, "a run"), tmp_path)
    assert [file.name for file in files] == [f"puma-{name}.png" for name in (*names, "torques")]
    assert all(file.stat().st_size > 20_000 for file in files)
