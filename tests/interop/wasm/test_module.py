"""The files of a module: what they hold, and that the same system gives the same bytes."""

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import scenario
from orchestration.containers.c.program import c_sources
from orchestration.containers.plan import Plan
from orchestration.containers.wasm import module as wasm
from orchestration.containers.wasm.module import write_wasm
from orchestration.errors import ContainerError, SystemDescriptionError
from tests.faults.cli import runner
from tests.interop.wasm.node import module_of, needs_node, node

LARGEST = 150_000
"""Bytes that the module of Fig. 5 may have at the most."""


@pytest.fixture(scope="module")
def fig5(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the module of Fig. 5."""
    return module_of("fig5", tmp_path_factory.mktemp("fig5"))


@pytest.fixture(scope="module")
def description(fig5: Path) -> dict:
    """The description of the module of Fig. 5."""
    return json.loads((fig5 / "system.json").read_text(encoding="utf-8"))


@needs_node
def test_the_module_imports_nothing_and_exports_what_its_description_says(fig5: Path, description: dict) -> None:
    script = """
    const module = new WebAssembly.Module(bytes);
    const names = WebAssembly.Module.exports(module).map((exported) => exported.name);
    console.log(JSON.stringify([WebAssembly.Module.imports(module), names]));
    """
    imports, exports = node(fig5, script)
    assert imports == []
    assert sorted(exports) == sorted(description["exports"])


def test_the_module_is_small(fig5: Path) -> None:
    assert (fig5 / "system.wasm").stat().st_size < LARGEST


def test_the_same_system_gives_the_same_bytes(fig5: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    system = scenario("fig5")
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))  # empty, so that it is compiled anew
    again = module_of(system, tmp_path)
    assert [path.read_bytes() for path in sorted(again.glob("system.*"))] == [
        path.read_bytes() for path in sorted(fig5.glob("system.*"))
    ]


def test_other_start_values_and_orders_are_other_modules(fig5: Path, tmp_path: Path) -> None:
    system = scenario("fig5")
    kinds = [(system.set({"plant.m[2]": 1.5}), "gauss-seidel"), (system, "jacobi")]
    modules = [(fig5 / "system.wasm").read_bytes()]
    for i, (changed, algorithm) in enumerate(kinds):
        modules.append(write_wasm(changed, tmp_path / f"{i}.wasm", algorithm=algorithm).read_bytes())
    assert len(set(modules)) == 3


def test_the_description_says_what_the_module_is_made_of(fig5: Path, description: dict) -> None:
    system = scenario("fig5")
    module = (fig5 / "system.wasm").read_bytes()
    assert description["module"] == {
        "file": "system.wasm",
        "bytes": len(module),
        "sha256": hashlib.sha256(module).hexdigest(),
    }
    assert [description[k] for k in ("system", "algorithm", "step", "startTime", "stopTime")] == [
        system.name,
        "gauss-seidel",
        system.step,
        0.0,
        system.stop_time,
    ]
    assert [c["name"] for c in description["components"]] == list(system)
    for component in description["components"]:
        path = system[component["name"]].path
        assert component["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
        assert component["guid"] == system[component["name"]].description.guid


def test_the_description_lists_all_variables_with_their_start_values(description: dict) -> None:
    system = scenario("fig5")
    variables = {v["name"]: v for v in description["variables"]}
    assert [v["index"] for v in description["variables"]] == list(range(len(variables)))
    for component in system.components:
        for variable in component.description.variables.values():
            path = f"{component.name}.{variable.name}"
            if variable.causality in ("parameter", "output") or path in system.unconnected_inputs():
                found = variables.pop(path)
                assert (found["unit"], found["type"]) == (variable.unit, variable.type)
                assert found["start"] == (None if variable.causality == "output" else component[variable.name])
    assert not variables


def test_a_variable_has_all_that_its_fmu_declares(description: dict) -> None:
    found = next(v for v in description["variables"] if v["name"] == "controller.K[1]")
    assert found.pop("index") > 0
    assert found.pop("description")
    assert found == {
        "name": "controller.K[1]",
        "role": "parameter",
        "type": "Real",
        "unit": "N/m",
        "variability": "tunable",
        "start": 4000.0,
        "min": 1e-12,
        "max": None,
    }


@pytest.mark.parametrize("name", ["fig5", "fig5.js", "fig5.wat"])
def test_another_suffix_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(ContainerError, match=r"the name of a module of WebAssembly ends in \.wasm; write fig5\.wasm\."):
        write_wasm(scenario("fig5"), tmp_path / name)


def test_a_system_without_a_step_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SystemDescriptionError, match="step"):
        write_wasm(replace(scenario("fig5"), step=None), tmp_path / "fig5.wasm")
    assert not list(tmp_path.iterdir())


def test_the_command_line_writes_the_same_files(
    fig5: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    said = runner(monkeypatch, capsys)("export", "fig5", "--as", "wasm", "-o", tmp_path / "system.wasm")
    assert said.code == 0
    assert "system.wasm: 5 components" in said.out + said.err
    assert [path.read_bytes() for path in sorted(tmp_path.iterdir())] == [
        path.read_bytes() for path in sorted(fig5.glob("system.*"))
    ]


def test_no_file_is_written_if_one_cannot_be(tmp_path: Path) -> None:
    (tmp_path / "fig5.wasm").write_bytes(b"of an earlier module")
    (tmp_path / "fig5.mjs").mkdir()
    with pytest.raises(ContainerError, match="Is a directory"):
        write_wasm(scenario("fig5"), tmp_path / "fig5.wasm")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fig5.mjs", "fig5.wasm"]
    assert (tmp_path / "fig5.wasm").read_bytes() == b"of an earlier module"


def test_the_files_of_an_earlier_module_are_replaced_but_no_others(fig5: Path, tmp_path: Path) -> None:
    (tmp_path / "system.json").write_text("{}")
    with pytest.raises(ContainerError) as caught:
        module_of("fig5", tmp_path)
    assert "system.json exists and is not of an earlier module" in str(caught.value)
    assert (tmp_path / "system.json").read_text() == "{}"
    (tmp_path / "system.wasm").write_bytes(b"earlier")
    module_of("fig5", tmp_path)
    assert [path.read_bytes() for path in sorted(tmp_path.iterdir())] == [
        path.read_bytes() for path in sorted(fig5.glob("system.*"))
    ]


def test_an_fmu_that_calls_a_library_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A plant whose sources call a function that no file of the module defines."""

    def with_calls(plan: Plan) -> dict[str, str]:
        kept = '__attribute__((export_name("called")))'
        call = f"double erf(double); double called(double x); {kept} double called(double x) {{ return erf(x); }}\n"
        sources = c_sources(plan)
        return sources | {"fmus/Plant.c": sources["fmus/Plant.c"] + call}

    monkeypatch.setattr(wasm, "c_sources", with_calls)
    with pytest.raises(ContainerError) as caught:
        write_wasm(scenario("fig2"), tmp_path / "fig2.wasm")
    assert str(caught.value) == (
        "plant: Plant.fmu calls erf, which a module of WebAssembly lacks; export the system as an FMU or as C."
    )
    assert not list(tmp_path.iterdir())
