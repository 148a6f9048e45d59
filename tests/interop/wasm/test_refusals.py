"""Sentences of the host and of the module for what cannot be done."""

from pathlib import Path

import pytest

from orchestration import SimulationError, scenario, simulate
from tests.interop.wasm.node import module_of, needs_node, node

pytestmark = needs_node


@pytest.fixture(scope="module")
def fig5(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the module of Fig. 5."""
    return module_of("fig5", tmp_path_factory.mktemp("fig5"))


REFUSED = {
    'fresh.set({ "plant.mass": 1 })': "fig5 has no variable plant.mass; its description lists all names.",
    'fresh.get("K[1]")': "fig5 has no variable K[1]; its description lists all names.",
    'fresh.set({ "plant.m[1]": -1 })': "plant: m[1] = -1 must be at least 1e-12 kg.",
    'fresh.set({ "plant.m[1]": NaN })': "plant: m[1] = nan is not finite.",
    'fresh.set({ "plant.m[1]": -Infinity })': "plant: m[1] = -inf is not finite.",
    'fresh.set({ "plant.m[1]": "1" })': 'plant.m[1]: "1" is not a number or a Boolean.',
    'fresh.set({ "plant.m[1]": undefined })': "plant.m[1]: undefined is not a number or a Boolean.",
    'fresh.set({ "sensor.seed": 1.5 })': "sensor: seed = 1.5 is not an Integer.",
    'fresh.set({ "plant.x[1]": 1 })': "plant.x[1]: An output cannot be set; set a parameter or an input.",
    'running.set({ "plant.m[1]": 1 })': ("plant: m[1] is a fixed parameter; it can be set until initialization ends."),
    "running.initialize()": "fig5: The system was not reset before its initialization.",
    "fresh.run(1)": "fig5: The system cannot step before its initialization, or after a failure.",
    "fresh.initialize(NaN)": "fig5: The start time is not finite.",
    "running.run(-1)": "n = -1 is not a whole number of 0 to 2^32 - 1.",
    "running.run(1.5)": "n = 1.5 is not a whole number of 0 to 2^32 - 1.",
    "running.run(2 ** 32)": "n = 4294967296 is not a whole number of 0 to 2^32 - 1.",
    'running.run("3")': "n = 3 is not a whole number of 0 to 2^32 - 1.",
    "running.run(10, { columns: [], every: 0 })": "every = 0 is not a whole number of 1 to 2^32 - 1.",
    'running.run(10, { columns: ["plant.X"] })': "fig5 has no variable plant.X; its description lists all names.",
    'running.run(4e9, { columns: ["plant.x[1]"] })': (
        "4000000001 rows of 2 columns take 61036 MiB, more than there is; make fewer steps at once, or record fewer"
        " of them."
    ),
    "freed.get('plant.x[1]')": "This run of fig5 was freed.",
    "freed.free()": "This run of fig5 was freed.",
}


@pytest.fixture(scope="module")
def said(fig5: Path) -> dict[str, str]:
    """What each call is refused with."""
    calls = ", ".join(f"() => {call}" for call in REFUSED)
    script = """
    const [fresh, running, freed] = [system.create(), system.create(), system.create()];
    running.initialize();
    running.run(3);
    freed.free();
    console.log(JSON.stringify([CALLS].map(refusal)));
    """
    return dict(zip(REFUSED, node(fig5, script.replace("CALLS", calls)), strict=True))


@pytest.mark.parametrize("call", REFUSED)
def test_what_is_refused(call: str, said: dict[str, str]) -> None:
    assert said[call] == REFUSED[call]


def test_what_was_refused_changes_nothing(fig5: Path) -> None:
    script = """
    const [one, two] = [system.create(), system.create()];
    [one, two].forEach((run) => run.initialize());
    refusal(() => two.set({ "plant.m[1]": 1 }));
    refusal(() => two.run(-1));
    refusal(() => two.set({ "controller.K[1]": NaN }));
    const rows = [one, two].map((run) => run.run(500, { columns: outputs }));
    console.log(JSON.stringify(rows.map((columns) => outputs.map((name) => columns[name][500]))));
    """
    one, two = node(fig5, script)
    assert one == two


def test_an_invalid_system_is_refused_at_initialization(fig5: Path) -> None:
    script = """
    const run = system.create();
    run.set({ "plant.wall_normal[2]": 0.5 });
    console.log(JSON.stringify(refusal(() => run.initialize())));
    """
    said = node(fig5, script)
    assert said.startswith("plant: ")
    assert "wall_normal" in said


def test_a_run_that_diverges_names_the_component_and_leaves_the_rows_until_then(tmp_path: Path) -> None:
    stiff = scenario("fig2").set({"controller.K": 1e8})  # N/m, far too much for a step of 0.1 ms
    with pytest.raises(SimulationError) as caught:
        simulate(stiff, algorithm="jacobi")
    rows = caught.value.result
    assert rows is not None
    script = """
    const run = system.create();
    run.initialize();
    try {
      run.run(20000, { columns: ["plant.x[1]"] });
    } catch (error) {
      const again = refusal(() => run.run(1));
      run.reset();
      run.initialize();
      const time = [...error.rows.time];
      console.log(JSON.stringify([error.message, time, [...error.rows["plant.x[1]"]], again, run.time]));
    }
    """
    message, time, x, again, after = node(module_of(stiff, tmp_path, "jacobi"), script)
    component, _, sentence = message.partition(": ")
    assert str(caught.value).startswith(f"{component}: ")
    assert sentence in str(caught.value)
    assert time == rows.time.tolist()
    assert x == rows["plant.x[1]"].tolist()
    assert again != "no error"
    assert after == 0


def test_a_description_of_another_module_is_refused(fig5: Path) -> None:
    script = """
    const wrong = async (changed) => load(bytes, { ...description, ...changed }).then(() => "", (e) => e.message);
    console.log(JSON.stringify([await wrong({ identity: "of another" }), await wrong({ abi: 99 })]));
    """
    other, newer = node(fig5, script)
    assert other.startswith("fig5: the description belongs to another module")
    assert newer == "fig5: the description has version 99 of the interface, the host version 1."
