"""Tests of models from pulse responses: exact for a linear component, with a bound on the error otherwise."""

import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import ContinuousModel, build
from orchestration import SimulationError, System, SystemDescriptionError
from orchestration.analysis.stability.eigensystem_realization import Pulses, realize
from orchestration.analysis.stability.operating_point import operating_point
from orchestration.analysis.stability.pulse_response import identify
from orchestration.fmi.description import read_description
from orchestration.fmi.instance import Instance
from tests.reference.problems import PROBLEMS, force_displacement
from tests.reference.problems.problem import held
from tests.reference.problems.two_masses import Numbers
from tests.unit.orchestration.small_models import H as PERIOD
from tests.unit.orchestration.small_models import system as small_system

H = 1e-2  # s


def cube() -> ContinuousModel:
    """Model without states, y = u^3."""
    model = ContinuousModel("Cube", "Cubes its input")
    u = model.input("u", 0.0, description="Input")
    model.output("y", u**3, description="Its cube", scalar=True)
    return model


def probed(system: System, name: str, h: float = H, order: int = 0):
    with operating_point(system, h, 0.0) as saved:
        return identify(next(p for p in saved if p.name == name), h, order)


def test_a_known_map_is_realized_up_to_its_coordinates() -> None:
    random = np.random.default_rng(7)
    A = np.diag([0.9, 0.5, -0.3]) + np.triu(random.standard_normal((3, 3)), 1) / 4
    B, C, D = (random.standard_normal(shape) for shape in ((3, 2), (2, 3), (2, 2)))
    scales = np.array([1e6, 1e-5])  # two outputs of very different size
    H = [D] + [C @ np.linalg.matrix_power(A, j) @ B for j in range(12)]
    H = np.array(H) * scales[:, None]
    found = realize(Pulses(H, np.zeros((2, 2, 2)), H))
    assert found.A.shape == (3, 3)
    # The error of A is eps times the condition number of the Hankel matrix, about 1e3 here.
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(found.A).real), [-0.3, 0.5, 0.9], atol=1e-11)
    np.testing.assert_allclose(found.pulses(13) / scales[:, None], H / scales[:, None], atol=1e-11)


def test_states_below_the_noise_are_not_realized() -> None:
    random = np.random.default_rng(7)
    H = np.array([[[0.0]], *([[0.5**j + 1e-6 * random.standard_normal()]] for j in range(12))])
    noise = np.full((2, 1, 1), 3e-6)
    assert realize(Pulses(H, noise, H)).A.shape == (1, 1)
    assert realize(Pulses(H, 0 * noise, H)).A.shape[0] > 1


def test_a_mass_is_two_states_with_the_responses_of_mechanics() -> None:
    model = probed(PROBLEMS["wall"].system(H, 1.0), "mass", order=2)
    assert model.outputs == ("x", "v")
    assert model.map.A.shape == (2, 2)
    m = 1.0
    expected = [[H**2 / 2, H**3 / 6, H**4 / 24], [H, H**2 / 2, H**3 / 6]]  # of F, F', F'' held over H
    # Relative noise is below 1e-14: 1e-16 of 0.1 m, over a response of at least 1e3 N * 5e-5 m/N.
    np.testing.assert_allclose(model.map.D, np.array(expected) / m, rtol=1e-9)
    np.testing.assert_allclose(np.linalg.eigvals(model.map.A), 1, atol=1e-6)


def test_a_component_with_feedthrough_matches_its_exact_map() -> None:
    n = Numbers()
    model = probed(PROBLEMS["force-displacement"].system(H, 1.0), "right")
    own = np.array([[0, 1], [-(n.k2 + n.k_c) / n.m2, 0]])
    Phi, Gamma = held(own, np.array([[0, 0], [n.k_c / n.m2, 0]]), H)
    K = np.array([[n.k_c, 0]])
    H_0 = K @ Gamma - K
    later = [K @ np.linalg.matrix_power(Phi, j) @ Gamma for j in range(1, 13)]
    # With dt_max = 1e-3 s, the FMU's own Runge-Kutta method errs by (w dt)^4 / 120 = 1e-12 of a radian per radian.
    np.testing.assert_allclose(model.map.pulses(13), [H_0, *later], rtol=1e-9, atol=1e-10)


def test_a_component_that_cannot_interpolate_has_no_derivatives_as_inputs(small: dict[str, Path]) -> None:
    looped = small_system(small, {"relay": "Relay", "plant": "Integrator"}, "plant.x -> relay.u\nrelay.y -> plant.u")
    model = probed(looped, "relay", PERIOD, order=2)
    assert model.order == 0
    np.testing.assert_allclose(model.map.D, [[2.0]], rtol=1e-12)  # y = 2 u at the tick
    assert model.map.A.shape == (0, 0)


def test_curvature_does_not_spoil_the_difference(small: dict[str, Path]) -> None:
    fmus = small | {"Cube": build(cube())}
    made = small_system(fmus, {"source": "Source", "a": "Cube", "b": "Cube"}, "source.u -> a.u\na.y -> b.u")
    model = probed(made, "a", PERIOD)
    # (u^3)' = 27 at u = 3; delta^2 = eps 27 / delta at delta = 2e-5, within a decade: 1e-8.
    assert model.map.D[0, 0] == pytest.approx(27, rel=1e-8)
    assert abs(model.map.D[0, 0] - 27) <= model.pulses.noise[0, 0, 0]


def test_an_identification_does_not_change_the_saved_state() -> None:
    system = PROBLEMS["force-displacement"].system(H, 1.0)
    with operating_point(system, H, 0.0) as saved:
        one = saved[0]
        inputs = np.full((5, 1, 1), 0.25)
        before = one.run(H, inputs)
        identify(one, H, 2)
        after = one.run(H, inputs)
    assert before is not None
    assert after is not None
    np.testing.assert_array_equal(before, after)


def test_every_saved_state_is_freed(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[str] = []
    status = Instance.status

    def counted(self: Instance, function: str, *arguments: object) -> int:
        calls.append(function)
        return status(self, function, *arguments)

    monkeypatch.setattr(Instance, "status", counted)
    with operating_point(PROBLEMS["wall"].system(H, 1.0), H, 0.0) as saved:
        identify(saved[0], H)
    assert calls.count("fmi2GetFMUstate") == 2
    assert calls[-4:] == ["fmi2SetFMUstate", "fmi2FreeFMUstate"] * 2


def test_an_operating_point_later_in_the_run() -> None:
    system = PROBLEMS["wall"].system(H, 1.0)
    with operating_point(system, H, 0.305) as saved:
        assert saved[0].time == pytest.approx(0.30)
        x, v = saved[0].u
    M = np.linalg.matrix_power([[1 - 0.5e-2, H], [-1.0, 1.0]], 30)  # q = k H^2 / m = 1e-2
    np.testing.assert_allclose([x, v], M @ [0.1, 0.0], rtol=1e-12)


def test_components_that_cannot_save_their_state_are_named(tmp_path: Path) -> None:
    system = PROBLEMS["wall"].system(H, 1.0)
    mass = system.component("mass")
    doctored = tmp_path / "stateless.fmu"
    with zipfile.ZipFile(mass.description.path) as old, zipfile.ZipFile(doctored, "w") as new:
        for entry in old.infolist():
            data = old.read(entry)
            if entry.filename == "modelDescription.xml":
                data = data.replace(b'canGetAndSetFMUstate="true"', b'canGetAndSetFMUstate="false"')
            new.writestr(entry, data)
    parts = tuple(
        replace(c, description=read_description(doctored)) if c.name == "mass" else c for c in system.components
    )
    with (
        pytest.raises(SystemDescriptionError, match=r"^mass: canGetAndSetFMUstate is false"),
        operating_point(replace(system, components=parts), H, 0.0),
    ):
        pass


def test_a_step_that_always_fails_is_an_error_with_the_reason(small: dict[str, Path]) -> None:
    looped = small_system(small, {"relay": "Relay", "plant": "Integrator"}, "plant.x -> relay.u\nrelay.y -> plant.u")
    with (
        operating_point(looped, PERIOD, 0.0) as saved,
        pytest.raises(SimulationError, match=r"plant: steps of 1e\+07"),
    ):
        identify(saved[1], 1e7)  # more than 1e7 sub-steps of dt_max


def test_the_reference_components_interpolate() -> None:
    system = force_displacement.system(H, 1.0)
    with operating_point(system, H, 0.0) as saved:
        assert all(one.interpolates for one in saved)
