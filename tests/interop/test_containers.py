"""Evidence that a figure as one FMU gives the values of our run, bit by bit, whatever runs it and in whatever steps.

Our master runs the container as a system of one component over the whole figure, in communication steps of 1, 7 and
1000 inner steps. fmpy, ecos and libcosim run the beginning. ecos sums its times and libcosim rounds them to
nanoseconds: a container counts its inner steps itself, so that neither reaches a value.
"""

import warnings
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest

from orchestration import Fmu, Options, Result, System, scenario, simulate
from orchestration.paper.scenarios import SCENARIOS
from tests.interop.peers import run_ecospy, run_libcosim, unavailable
from tests.sharing import made_once

FIGURES = [f"fig{i}" for i in range(2, 8)]
ALGORITHMS = ("gauss-seidel", "jacobi")
FEW = 420  # inner steps of the other tools; a multiple of 7
Container = Callable[[str, str], Path]

needs_ecospy = pytest.mark.skipif(bool(unavailable("ecospy")), reason=str(unavailable("ecospy")))
needs_libcosim = pytest.mark.skipif(bool(unavailable("libcosimpy")), reason=str(unavailable("libcosimpy")))
figures = pytest.mark.parametrize("figure", FIGURES)
algorithms = pytest.mark.parametrize("algorithm", ALGORITHMS)


@pytest.fixture(scope="module")
def system_of(fmu_folder: Path) -> Callable[[str], System]:
    """Makes the system of a figure."""

    def make(figure: str) -> System:
        scenario = SCENARIOS[figure]
        return scenario.system({model: fmu_folder / f"{model}.fmu" for model in scenario.models.values()})

    return make


@pytest.fixture(scope="module")
def container(system_of: Callable[[str], System], tmp_path_factory: pytest.TempPathFactory) -> Container:
    """Finds the container of a figure, which is made once."""

    def make(figure: str, algorithm: str) -> Path:
        def write(folder: Path) -> None:
            system_of(figure).to_fmu(folder / f"{figure}.fmu", algorithm=algorithm)

        return made_once(tmp_path_factory, f"{figure} as one FMU, {algorithm}", write) / f"{figure}.fmu"

    return make


@pytest.fixture(scope="module")
def run_of(system_of: Callable[[str], System]) -> Callable[[str, str], Result]:
    """Makes our whole run of a figure, once."""
    kept: dict[tuple[str, str], Result] = {}

    def run(figure: str, algorithm: str) -> Result:
        if (figure, algorithm) not in kept:
            kept.clear()  # one is large
            kept[figure, algorithm] = simulate(system_of(figure), algorithm=algorithm)
        return kept[figure, algorithm]

    return run


def alone(path: Path, step: float, steps: int) -> Result:
    """A run of a container as a system of one component, called c."""
    return simulate(System.of({"c": path}), steps * step, step)


def assert_same_rows(found: Result, expected: Result, every: int) -> None:
    """Row k of the container is row `every` k of the system, in every bit of every column."""
    rows = expected.rows[: 1 + every * (len(found.time) - 1) : every]
    assert [name.removeprefix("c.") for name in found.names] == list(expected.names)
    assert found.rows.tobytes() == rows.tobytes()


@algorithms
@figures
@pytest.mark.parametrize("inner", [1, 7, 1000])
def test_our_master_gets_every_row(
    container: Container, run_of: Callable[[str, str], Result], figure: str, algorithm: str, inner: int
) -> None:
    expected = run_of(figure, algorithm)
    step = SCENARIOS[figure].step
    found = alone(container(figure, algorithm), inner * step, (len(expected.time) - 1) // inner)
    assert_same_rows(found, expected, inner)


def test_an_arm_in_space_gets_every_row_in_our_master_and_in_fmpy(tmp_path: Path) -> None:
    """The whole run of the PUMA 560 as one FMU: noise, saturation, contact and adaptation in six coordinates."""
    puma = scenario("puma")
    expected, step, inner = simulate(puma), puma.run_step(), 7
    path = puma.to_fmu(tmp_path / "puma.fmu")
    assert_same_rows(alone(path, inner * step, (len(expected.time) - 1) // inner), expected, inner)
    assert any(expected[f"actuator.saturated[{i}]"].any() for i in range(1, 7))
    assert np.abs(expected["plant.F_ext[3]"]).max() > 10  # N
    span = inner * step
    found = fmpy.simulate_fmu(
        str(path),
        start_time=0.0,
        stop_time=span * (FEW // inner),
        step_size=span,
        output_interval=span,
        output=list(expected.names),
    )
    for j, name in enumerate(expected.names):
        np.testing.assert_array_equal(found[name].astype(float), expected.rows[: FEW + 1 : inner, j], err_msg=name)


def test_what_is_compared_is_worth_it(run_of: Callable[[str, str], Result]) -> None:
    """Contact, noise, saturation and adaptation happen; the order of the components matters."""
    runs = [run_of("fig5", algorithm) for algorithm in ALGORITHMS]
    assert len(runs[0].time) == 200_001
    assert np.abs(runs[0]["plant.F_ext[1]"]).max() > 100  # N
    assert np.ptp(runs[0]["controller.p_hat[2]"]) > 0.1  # kg
    error = runs[0]["sensor.F_hat[1]"][1:] - runs[0]["plant.F_ext[1]"][:-1]
    assert np.count_nonzero(error) > 1000
    assert runs[0].rows.tobytes() != runs[1].rows.tobytes()


@figures
@pytest.mark.parametrize("inner", [1, 7])
def test_fmpy_gets_every_row(
    container: Container, run_of: Callable[[str, str], Result], figure: str, inner: int
) -> None:
    expected = run_of(figure, "gauss-seidel")
    step = inner * SCENARIOS[figure].step
    found = fmpy.simulate_fmu(
        str(container(figure, "gauss-seidel")),
        start_time=0.0,
        stop_time=step * (FEW // inner),
        step_size=step,
        output_interval=step,
        output=list(expected.names),
    )
    rows = expected.rows[: FEW + 1 : inner]
    for j, name in enumerate(expected.names):
        np.testing.assert_array_equal(found[name][: len(rows)].astype(float), rows[:, j], err_msg=name)


@needs_ecospy
@figures
def test_ecos_gets_every_row(
    container: Container, run_of: Callable[[str, str], Result], figure: str, tmp_path: Path
) -> None:
    """The package has one component; ecos reads row 0 before anything is set."""
    expected, step = run_of(figure, "gauss-seidel"), SCENARIOS[figure].step
    package = System.of({"c": container(figure, "gauss-seidel")}).write(tmp_path / "one.ssp")
    values = run_ecospy(package, 7 * step, FEW // 7, [f"c.{name}" for name in expected.names])
    assert values.tobytes() == expected.rows[: FEW + 1 : 7].tobytes()


@needs_libcosim
@figures
def test_libcosim_gets_every_row(
    container: Container, run_of: Callable[[str, str], Result], figure: str, tmp_path: Path
) -> None:
    expected, step = run_of(figure, "gauss-seidel"), SCENARIOS[figure].step
    names = [name for name in expected.names if not name.startswith("actuator.saturated")]  # Booleans make it slow
    package = System.of({"c": container(figure, "gauss-seidel")}).write(tmp_path / "one.ssp")
    values = run_libcosim(package, round(7 * step * 1e9), FEW // 7, [f"c.{name}" for name in names])
    rows = np.column_stack([expected[name] for name in names])[7 : FEW + 1 : 7]
    assert np.ascontiguousarray(values).tobytes() == rows.tobytes()


@pytest.mark.parametrize("figure", ["fig5", "fig7"])
def test_a_state_saved_in_the_middle_leads_to_the_same_end(
    container: Container, run_of: Callable[[str, str], Result], figure: str
) -> None:
    """Within one instance, and serialized into another one that was never initialized."""
    expected, path, step = run_of(figure, "gauss-seidel"), container(figure, "gauss-seidel"), SCENARIOS[figure].step
    middle, end = 300, 900  # inner steps, in contact or not

    def outputs(fmu: Fmu) -> np.ndarray:
        shown = fmu.outputs()
        return np.array([np.ravel(shown[name.partition("[")[0]])[index(name)] for name in expected.names], dtype=float)

    with Fmu(path) as one, Fmu(path) as other:
        one.step(middle * step)
        saved = one.save()
        assert outputs(one).tobytes() == expected.rows[middle].tobytes()
        one.step((end - middle) * step)
        assert outputs(one).tobytes() == expected.rows[end].tobytes()
        one.restore(saved)
        assert outputs(one).tobytes() == expected.rows[middle].tobytes()
        assert isinstance(saved, bytes)
        other.restore(saved)
        for fmu in (one, other):
            for _ in range(end - middle):
                fmu.step(step)
            assert outputs(fmu).tobytes() == expected.rows[end].tobytes()


def index(name: str) -> int:
    """Place of an element in its vector, 0 of a scalar."""
    return int(name.partition("[")[2].rstrip("]") or 1) - 1


def test_an_isolated_container_is_the_same(container: Container, run_of: Callable[[str, str], Result]) -> None:
    step = SCENARIOS["fig2"].step
    system = System.of({"c": container("fig2", "gauss-seidel")})
    found = simulate(system, FEW * step, step, options=Options(isolate=True))
    assert_same_rows(found, run_of("fig2", "gauss-seidel"), 1)


def test_parameters_are_set_as_those_of_the_system(container: Container, system_of: Callable[[str], System]) -> None:
    values = {"controller.K[1]": 3000.0, "plant.m[2]": 1.25, "sensor.seed": 7.0}
    step = SCENARIOS["fig5"].step
    expected = simulate(system_of("fig5").set(values), FEW * step)
    of_one = System.of({"c": container("fig5", "gauss-seidel")}).set({f"c.{name}": v for name, v in values.items()})
    assert_same_rows(simulate(of_one, FEW * step, step), expected, 1)


def test_a_container_is_a_component_beside_others(system_of: Callable[[str], System], tmp_path: Path) -> None:
    """The arm with its actuator and its sensor as one FMU, the controller and the trajectory as they are."""
    fig5 = system_of("fig5")
    inside = ("sensor", "actuator", "plant")
    parts = System.of({name: fig5[name] for name in inside}, "arm")
    kept = [c for c in fig5.connections if c.source in inside and c.target in inside]
    arm = parts.connect(*kept).with_sample_time(fig5.run_step()).to_fmu(tmp_path / "arm.fmu")
    outside = System.of({"trajectory": fig5["trajectory"], "controller": fig5["controller"], "arm": arm}, "split")
    links = []
    for c in fig5.connections:
        if c.source in inside and c.target in inside:
            continue
        source = f"arm.{c.source}.{c.output}" if c.source in inside else f"{c.source}.{c.output}"
        target = f"arm.{c.target}.{c.input}" if c.target in inside else f"{c.target}.{c.input}"
        links.append(f"{source} -> {target}")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        step = fig5.run_step()
        found = simulate(outside.connect(*links), FEW * step, step)
    expected = simulate(fig5.ordered(["trajectory", "controller", "sensor", "actuator", "plant"]), FEW * step)
    for name in expected.names:
        component = name.partition(".")[0]
        shown = found[f"arm.{name}" if component in inside else name]
        assert shown.tobytes() == expected[name].tobytes(), name
