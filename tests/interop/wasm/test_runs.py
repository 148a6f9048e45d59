"""Several runs of one module: side by side, interleaved, with changes in the middle, and their memory."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import System, TimeSeries, prepare, scenario, simulate
from orchestration.containers.wasm.module import write_wasm
from tests.interop.wasm.node import assert_bitwise, kept, module_of, needs_node, node

pytestmark = needs_node
STOP = 0.2  # s
JOINED = """
// Recordings one after another; the first row of each but the first is the last row of the one before.
const joined = (pieces) => {
  const column = (name) => pieces.flatMap((rows, i) => [...rows[name].slice(i ? 1 : 0)]);
  return Object.fromEntries(Object.keys(pieces[0]).map((name) => [name, Float64Array.from(column(name))]));
};
"""


@pytest.fixture(scope="module")
def fig5(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the module of Fig. 5."""
    return module_of("fig5", tmp_path_factory.mktemp("fig5"))


def test_interleaved_runs_are_those_of_the_master(fig5: Path) -> None:
    """Three runs with other start values, in pieces of other lengths; one of them ends before the others."""
    system = scenario("fig5")
    masses = (1.0, 2.5, 4.0)  # kg
    results = [simulate(system.set({"plant.m[2]": mass}), STOP) for mass in masses]
    script = """
    const runs = MASSES.map((mass) => {
      const run = system.create();
      run.set({ "plant.m[2]": mass });
      run.initialize();
      return { run, left: STEPS, pieces: [] };
    });
    while (runs.some((r) => r.left))
      runs.forEach((r, i) => {
        const n = Math.min(r.left, 17 + 40 * i);
        if (!n) return;
        r.pieces.push(r.run.run(n, { columns: outputs }));
        r.left -= n;
        if (!r.left && i === 1) r.run.free();
      });
    runs.forEach(({ pieces }, i) => keep(`rows${i}`, joined(pieces)));
    """
    steps = len(results[0].time) - 1
    node(fig5, JOINED + script.replace("MASSES", str(list(masses))).replace("STEPS", str(steps)))
    for i, result in enumerate(results):
        assert_bitwise(kept(fig5 / f"rows{i}", 1 + len(result.names)), result)
    assert not np.array_equal(results[0].rows, results[1].rows)


def test_tunable_parameters_in_the_middle(fig5: Path) -> None:
    with prepare(scenario("fig5"), stop_time=STOP) as ours:
        ours.run(until=STOP / 2)
        ours.set({"controller.K[1]": 2000.0, "controller.K[2]": 3000.0})  # N/m
        ours.run()
        result = ours.result()
    script = """
    const run = system.create();
    run.initialize();
    const first = run.run(HALF, { columns: outputs });
    run.set({ "controller.K[1]": 2000, "controller.K[2]": 3000 });
    const shown = run.get("controller.K[1]");
    keep("rows", joined([first, run.run(HALF, { columns: outputs })]));
    console.log(shown);
    """
    assert node(fig5, JOINED + script.replace("HALF", str((len(result.time) - 1) // 2))) == 2000
    assert_bitwise(kept(fig5 / "rows", 1 + len(result.names)), result)


def test_booleans_and_integers_are_numbers(fig5: Path) -> None:
    script = """
    const run = system.create();
    const shown = () => ["sensor.contact_gated", "sensor.seed"].map((name) => run.get(name));
    const before = shown();
    run.set({ "sensor.contact_gated": false, "sensor.seed": 7 });
    const off = shown();
    run.set({ "sensor.contact_gated": true });
    console.log(JSON.stringify([before, off, shown()]));
    """
    before, off, on = node(fig5, script)
    assert before == [float(scenario("fig5")["sensor"][name]) for name in ("contact_gated", "seed")]
    assert [off, on] == [[0, 7], [1, 7]]


@pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning")
def test_inputs_without_a_source_are_set_between_steps(tmp_path: Path) -> None:
    """A torque that changes after each of 20 steps, as a held series changes it in the master."""
    plant = replace(System.of({"plant": scenario("fig2")["plant"]}), step=1e-4, stop_time=2e-3)
    torques = [(-1.0) ** k * k for k in range(20)]  # N.m
    times = np.arange(20) * 1e-4  # s
    held = TimeSeries(times, np.array(torques), interpolation="held", outside="hold")
    result = simulate(plant, inputs={"plant.tau[1]": held})
    script = """
    const run = system.create();
    run.initialize();
    const pieces = TORQUES.map((torque) => (run.set({ "plant.tau[1]": torque }), run.run(1, { columns: outputs })));
    keep("rows", joined(pieces));
    run.set({ "plant.tau[1]": NaN });
    console.log(JSON.stringify([refusal(() => run.run(1)), description.variables.filter((v) => v.role === "input")]));
    """
    said, inputs = node(module_of(plant, tmp_path), JOINED + script.replace("TORQUES", str(torques)))
    assert_bitwise(kept(tmp_path / "rows", 1 + len(result.names)), result)
    assert said == "plant: Input tau[1] is nan; it must be finite."
    assert [variable["name"] for variable in inputs] == ["plant.tau[1]", "plant.tau[2]"]


def test_row_0_can_be_read_one_by_one(fig5: Path) -> None:
    script = """
    const run = system.create();
    run.initialize();
    const read = outputs.map((name) => run.get(name));
    const rows = run.run(0, { columns: outputs });
    console.log(JSON.stringify([read, outputs.map((name) => rows[name][0]), rows.time.length]));
    """
    read, row, length = node(fig5, script)
    assert read == row
    assert length == 1


def test_a_reset_run_is_a_new_one(fig5: Path) -> None:
    script = """
    const rows = (run) => (run.initialize(), run.run(300, { columns: outputs }));
    const run = system.create();
    const fresh = rows(system.create());
    run.set({ "plant.m[2]": 3, "sensor.noise_std": 0 });
    const other = rows(run);
    run.reset();
    const again = rows(run);
    const same = (a, b) => outputs.every((n) => Buffer.from(a[n].buffer).equals(Buffer.from(b[n].buffer)));
    console.log(JSON.stringify([same(fresh, again), same(fresh, other)]));
    """
    assert node(fig5, script) == [True, False]


def test_every_start_time_counts_from_there(tmp_path: Path) -> None:
    """The system's own is the default; another one can be given."""
    later = replace(scenario("fig5"), start_time=2.0)
    script = """
    const starts = [undefined, 0.3].map((start) => {
      const run = system.create();
      run.initialize(start);
      return run.run(STEPS, { columns: outputs });
    });
    starts.forEach((rows, i) => keep(`rows${i}`, rows));
    """
    results = [simulate(replace(later, start_time=start), start + 0.05) for start in (2.0, 0.3)]
    node(module_of(later, tmp_path), script.replace("STEPS", str(len(results[0].time) - 1)))
    for i, result in enumerate(results):
        assert_bitwise(kept(tmp_path / f"rows{i}", 1 + len(result.names)), result)


def test_memory_that_was_freed_is_used_again(fig5: Path) -> None:
    """A thousand runs with their rows, freed in another order than made, need the memory of ten."""
    script = """
    const size = () => system.create().wasm.memory.buffer.byteLength;
    const batch = (n) => {
      const runs = Array.from({ length: 10 }, () => system.create());
      runs.forEach((run) => run.initialize());
      runs.forEach((run, i) => run.run(10 * i + n, { columns: outputs }));
      [3, 9, 0, 1, 2, 8, 7, 4, 6, 5].forEach((i) => runs[i].free());
    };
    for (let n = 0; n < 5; ++n) batch(200);
    const before = size();
    for (let n = 0; n < 100; ++n) batch(100 + n);
    console.log(JSON.stringify([before, size()]));
    """
    before, after = node(fig5, script)
    assert before == after


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [3, 2, 1, 0], [1, 3, 0, 2], [0, 2, 3, 1]])
def test_neighbours_that_were_freed_become_one_block(order: list[int], fig5: Path) -> None:
    script = """
    const { wasm } = system.create();
    const blocks = [0, 1, 2, 3].map(() => wasm.allocate(1e6));
    const behind = wasm.allocate(1e6);
    ORDER.forEach((i) => wasm.release(blocks[i]));
    console.log(JSON.stringify([blocks[0], wasm.allocate(4e6), behind > blocks[3]]));
    """
    first, again, in_a_row = node(fig5, script.replace("ORDER", str(order)))
    assert in_a_row
    assert again == first


def test_rows_stay_when_the_memory_grows(fig5: Path) -> None:
    script = """
    const run = system.create();
    run.initialize();
    const rows = run.run(100, { columns: ["plant.x[1]"] });
    const last = rows["plant.x[1]"][100];
    run.run(20000, { columns: outputs });
    console.log(JSON.stringify([rows["plant.x[1]"].length, rows["plant.x[1]"][100] === last]));
    """
    assert node(fig5, script) == [101, True]


def test_runs_may_have_other_steps(tmp_path: Path) -> None:
    """A module with a variable step has the bits of the master at each step, and keeps its own until told."""
    system = scenario("fig5")
    write_wasm(system, tmp_path / "system.wasm", variable_step=True)
    script = """
    const periods = ["trajectory", "sensor", "controller", "actuator"].map((name) => `${name}.sample_time`);
    const run = system.create();
    run.setStep(1e-4);
    run.set({ ...Object.fromEntries(periods.map((name) => [name, 1e-4])), "sensor.noise_period": 0 });
    const said = [refusal(() => run.setStep(0))];
    run.initialize();
    said.push(refusal(() => run.setStep(1e-5)));
    keep("rows", run.run(STEPS, { columns: outputs }));
    run.reset();
    run.initialize();
    run.run(10);
    said.push(run.time);
    console.log(JSON.stringify(said));
    """
    coarse = system.set({"sensor.noise_period": 0.0}).with_sample_time(1e-4)
    result = simulate(coarse, STOP)
    said = node(tmp_path, script.replace("STEPS", str(len(result.time) - 1)))
    assert_bitwise(kept(tmp_path / "rows", 1 + len(result.names)), result)
    refused = "a step is positive, and is set before the initialization."
    assert said == [f"step = 0 s: {refused}", f"step = 0.00001 s: {refused}", 10 * system.run_step()]


def test_a_module_with_a_fixed_step_says_so(fig5: Path) -> None:
    said = node(fig5, "console.log(JSON.stringify(refusal(() => system.create().setStep(1e-4))));")
    assert said == "fig5 has a fixed step of 0.00001 s."
