"""What a program is made of: order of the variables, names in C, passes of the initialization, and refusals."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import Algorithm, Connection, ContainerError, System, SystemDescriptionError
from orchestration.containers.c.program import c_sources
from orchestration.containers.c_text import c_comment, c_number, c_string, identifier, md
from orchestration.containers.plan import FIXED, INPUT, OUTPUT, TUNABLE, plan_of
from tests.unit.orchestration.small_models import H, chain, mixed, system


def test_parameters_then_free_inputs_then_outputs(small: dict[str, Path]) -> None:
    plan = plan_of(mixed(small).set({"relay.offset": 0.25}))
    paths = [variable.path for variable in plan.variables]
    assert paths == [
        *("source.sample_time", "relay.sample_time", "relay.offset", "switch.sample_time"),
        *("plant.dt_max", "plant.x_start", "plant.through"),
        *("source.u", "source.n", "source.even", "relay.y", "relay.m", "relay.odd", "switch.y", "plant.x", "plant.y"),
    ]
    by_path = {variable.path: variable for variable in plan.variables}
    assert (by_path["relay.offset"].start, by_path["relay.offset"].role) == (0.25, FIXED)
    assert by_path["source.sample_time"].range.startswith("at least ")
    assert (by_path["relay.offset"].minimum, by_path["relay.offset"].range) == (-math.inf, "")
    assert by_path["plant.x"].role == OUTPUT


def test_an_input_without_a_source_is_an_input(fig2: System) -> None:
    fewer = replace(fig2, connections=tuple(c for c in fig2.connections if c.target != "sensor"))
    plan = plan_of(fewer)
    assert [v.path for v in plan.with_role(INPUT)] == ["sensor.F_ext[1]", "sensor.F_ext[2]"]
    assert {"controller.K[1]", "sensor.noise_std"} <= {v.path for v in plan.with_role(TUNABLE)}


def test_an_fmu_is_contained_once(small: dict[str, Path]) -> None:
    plan = plan_of(chain(small, 3))
    assert [fmu.name for fmu in plan.fmus] == ["Source", "Relay"]
    assert [member.field for member in plan.members] == ["source", "relay1", "relay2", "relay3"]


def test_two_fmus_of_one_name_get_two_names(small: dict[str, Path], fig2: System) -> None:
    another = small["Source"].with_name("copy") / "Relay.fmu"
    another.parent.mkdir(exist_ok=True)
    another.write_bytes(small["Source"].read_bytes())
    both = System.of({"a": small["Source"], "b": another, "c": small["Relay"], "d": fig2["plant"].path})
    plan = plan_of(replace(both, name="Plant", step=H / 1250))
    assert plan.identifier == "Plant"
    assert [fmu.name for fmu in plan.fmus] == ["Source", "Relay", "Plant_1"]


def test_a_component_computes_as_often_as_the_dependencies_need(fig2: System, small: dict[str, Path]) -> None:
    passes = plan_of(fig2).initialization
    assert [one.component for one in passes] == ["trajectory", "plant", "sensor", "controller", "actuator", "plant"]
    assert [str(c) for c in passes[-1].connections] == [f"plant.ddq[{i}] -> controller.ddq[{i}]" for i in (1, 2)]
    backwards = chain(small, 3).ordered(["relay3", "relay2", "relay1", "source"])
    assert [one.component for one in plan_of(backwards).initialization] == ["source", "relay1", "relay2", "relay3"]


def test_links_that_are_tested_already_are_not_tested_again(small: dict[str, Path]) -> None:
    two = system(small, {"source": "Source", "plant": "Integrator"})
    tested = c_sources(plan_of(two.connect("source.u -> plant.u")))
    scaled = c_sources(plan_of(two.connect(Connection("source", "u", "plant", "u", factor=1e300))))
    assert "#define INPUTS_ARE_FINITE" in tested["fmus/Integrator.c"]
    assert "#define INPUTS_ARE_FINITE" not in scaled["fmus/Integrator.c"]


def test_a_cycle_is_refused_with_its_connections(small: dict[str, Path]) -> None:
    tested = system(
        small,
        {"source": "Source", "plant": "Integrator", "relay": "Relay"},
        "plant.y -> relay.u\nrelay.y -> plant.u\nsource.n -> relay.n",
    )
    with pytest.raises(ContainerError) as caught:
        plan_of(tested)
    assert str(caught.value) == (
        "System small: outputs depend on each other during initialization in the cycle plant.y -> relay.u, relay.y ->"
        " plant.u; a program solves no algebraic loop: break the cycle, or run the system as it is."
    )


@pytest.mark.parametrize(
    "algorithm", ["iterative", "newton", "adaptive", Algorithm("mine", order=1), Algorithm("gauss-seidel", "parallel")]
)
def test_other_algorithms_are_refused(small: dict[str, Path], algorithm: str | Algorithm) -> None:
    with pytest.raises(ContainerError, match=r"^System small: a program cannot step with .*; choose gauss-seidel or"):
        plan_of(mixed(small), algorithm)


def test_a_step_is_needed_and_must_divide_every_period(small: dict[str, Path]) -> None:
    with pytest.raises(SystemDescriptionError, match="System small has no communication step"):
        plan_of(replace(mixed(small), step=None))
    with pytest.raises(SystemDescriptionError, match=r"source: sample time 0\.125 s is not a multiple of the step"):
        plan_of(replace(mixed(small), step=2 * H / 3))


@pytest.mark.parametrize("place", ["a file", "a folder of others", "a header of others"])
def test_a_place_with_other_things_is_refused(small: dict[str, Path], tmp_path: Path, place: str) -> None:
    other = tmp_path / "x"
    if place == "a file":
        other.write_text("mine", encoding="utf-8")
    else:
        other.mkdir()
        name = "letter.txt" if place == "a folder of others" else "step.h"
        (other / name).write_text("/* mine */", encoding="utf-8")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(ContainerError, match=r"is a file; a folder|has files that are not of a C program"):
        mixed(small).to_c(other)
    assert sorted(tmp_path.rglob("*")) == before


def test_an_earlier_program_is_replaced(small: dict[str, Path], tmp_path: Path) -> None:
    mixed(small).to_c(tmp_path / "x")
    mixed(small).to_c(tmp_path / "x", algorithm="jacobi")
    assert "jacobi" in (tmp_path / "x" / "README.md").read_text(encoding="utf-8")


def test_text_stays_text() -> None:
    assert c_string('a"\\??/\n') == '"a\\"\\\\\\?\\?/\\012"'
    assert c_string("°\udc80") == '"\\302\\260\\200"'
    assert c_comment("*/ #include <x> /* \\\n ??/") == "* / #include <x> / * ?? ? ?/"
    assert md("a|b `c` <d>\n*e*") == "a?b ?c? ?d??\\*e\\*"
    assert [c_number(x) for x in (0.1, -math.inf, 1e22, -0.0)] == ["0.1", "-DBL_MAX", "1e+22", "-0.0"]
    assert identifier("a-b", {"a_b", "a_b_1"}) == "a_b_2"
    assert identifier("Größe", default="system") == "Gr_e"
    assert [identifier(name, {"plant"}) for name in ("Plant", "INT32_MAX", "Con", "DC")] == [
        *("Plant_1", "x_INT32_MAX", "Con_1", "DC"),
    ]


def test_an_fmu_may_be_called_as_the_program_calls_its_own(small: dict[str, Path], tmp_path: Path) -> None:
    odd = {"NULL": small["Source"], "parameters": small["Relay"], "STEP_SIZE": small["Integrator"]}
    folder = replace(System.of(odd, "period"), step=H).to_c(tmp_path / "x")
    header = (folder / "step.h").read_text(encoding="utf-8")
    assert "component_NULL;   /* NULL */" in header
    assert "component_STEP_SIZE;   /* STEP_SIZE */" in header
