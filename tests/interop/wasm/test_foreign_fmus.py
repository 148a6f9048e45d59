"""FMUs of other tools in a module: right where they need no operating system, else refused with what they call."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import System, scenario, simulate
from orchestration.containers.wasm.module import write_wasm
from orchestration.errors import ContainerError
from tests.interop.foreign.builders import MAPPING, without_compiler
from tests.interop.wasm.node import assert_bitwise, kept, module_of, needs_node, node
from tests.strangers.contained.fmus import controller, small
from tests.strangers.contained.test_runs import STEP, coupled

pytestmark = [
    needs_node,
    pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning"),
    pytest.mark.filterwarnings("ignore::orchestration.FormalityWarning"),
]


@pytest.fixture
def pair(tmp_path: Path) -> System:
    """A system of three components of two FMUs that define equal names."""
    return coupled(small(tmp_path, "First"), small(tmp_path, "Second", gain=-2.0))


@pytest.mark.skipif(without_compiler() is not None, reason=str(without_compiler()))
def test_a_hand_written_controller_in_fig5(tmp_path: Path) -> None:
    """Its angles are degrees and its torques N.mm, so most of its connections convert units.

    It calls sin and cos of the C library, which is another one in the module than on this machine. So values may
    differ by roundings, 1e-16 of their ranges. The loop, which is stable before the contact, makes 1.1e-13 of them,
    in torques that jump. Row 0 has no such function in it.
    """
    system = scenario("fig5").replace("controller", controller(tmp_path), MAPPING)
    steps = 40_000  # the first contact is from 0.92 s on
    result = simulate(system, steps * system.run_step())
    script = """
    const run = system.create();
    run.initialize();
    keep("rows", run.run(STEPS, { columns: NAMES }));
    """
    names = str(list(result.names))
    node(module_of(system, tmp_path), script.replace("STEPS", str(steps)).replace("NAMES", names))
    rows = kept(tmp_path / "rows", 1 + len(result.names))[:, 1:]
    span = np.abs(result.rows).max(axis=0)
    assert (rows[0] == result.rows[0]).all()
    assert (np.abs(rows - result.rows) <= 1e-12 * span).all()


def test_runs_side_by_side_are_made_again_and_freed(pair: System, tmp_path: Path) -> None:
    """Instances of these FMUs have memory of their own, which goes with the run."""
    result = simulate(pair, 100 * STEP)
    script = """
    const one = system.create();
    one.set({ "a.k": 9 });
    one.initialize();
    const runs = Array.from({ length: 300 }, () => system.create());
    one.run(50);
    runs.forEach((run, i) => i && (run.initialize(), run.run(5), run.reset(), run.free()));
    const size = () => one.wasm.memory.buffer.byteLength;
    const before = size();
    for (let i = 0; i < 3000; ++i) {
      const run = system.create();
      run.initialize();
      run.free();
    }
    const after = size();
    runs[0].initialize();
    keep("rows", runs[0].run(100, { columns: NAMES }));
    console.log(JSON.stringify([before, after]));
    """
    before, after = node(module_of(pair, tmp_path), script.replace("NAMES", str(list(result.names))))
    assert before == after
    assert_bitwise(kept(tmp_path / "rows", 1 + len(result.names)), result)


def test_the_module_imports_nothing_and_exports_what_its_description_says(pair: System, tmp_path: Path) -> None:
    script = """
    const module = new WebAssembly.Module(bytes);
    const exports = WebAssembly.Module.exports(module).map((exported) => exported.name);
    console.log(JSON.stringify([WebAssembly.Module.imports(module), exports, Object.keys(description.exports)]));
    """
    imports, exports, described = node(module_of(pair, tmp_path), script)
    assert imports == []
    assert sorted(exports) == sorted(described)


def test_a_failure_is_told_with_the_message_of_the_fmu(tmp_path: Path) -> None:
    system = replace(System.of({"tank": small(tmp_path)}).set({"tank.fault": 3}), step=STEP)
    script = """
    const run = system.create();
    run.initialize();
    console.log(JSON.stringify(refusal(() => run.run(100))));
    """
    said = node(module_of(system, tmp_path), script)
    assert said.startswith("tank: ")
    assert "the tank is 3 % full" in said


@pytest.mark.parametrize(
    ("call", "named"),
    [
        ('#include <stdio.h>\n__attribute__((constructor)) static void say(void) { puts("here"); }\n', "fd_write"),
        ("int fork(void);\n__attribute__((constructor)) static void split(void) { fork(); }\n", "fork"),
    ],
)
def test_what_needs_an_operating_system_is_refused(call: str, named: str, tmp_path: Path) -> None:
    system = replace(System.of({"tank": small(tmp_path, before=call)}), step=STEP)
    with pytest.raises(ContainerError) as caught:
        write_wasm(system, tmp_path / "tank.wasm")
    message = str(caught.value)
    assert message.startswith("tank: ")
    assert named in message
    assert message.endswith("export the system as an FMU or as C.")
    assert not (tmp_path / "tank.wasm").exists()
