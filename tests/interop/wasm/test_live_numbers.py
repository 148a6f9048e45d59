"""What the live page computes, in node: rows, files, commands and claims as the command line and Python have them."""

import json
import shlex
import shutil
from collections.abc import Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any, cast

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pytest

from orchestration.containers.wasm.module import host
from orchestration.paper.built_fmus import fmus
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims import judged, motion
from orchestration.paper.evidence import Evidence
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.measure import summarize
from orchestration.paper.page.live import WORKER
from orchestration.paper.page.live_claims import JUDGED, NAMES
from orchestration.paper.page.live_data import live_data, programs
from orchestration.paper.page.live_settings import FIGURES, live_settings
from orchestration.paper.ready import scenario
from orchestration.paper.scenarios import SCENARIOS
from tests.faults.cli import Command, runner
from tests.interop.wasm.node import needs_node, script_output

pytestmark = needs_node
HEAD = """
import { readFileSync, writeFileSync } from "node:fs";
import { answer, evidence } from "./claims.js";
import { decimal, loopOf } from "./loop.js";
import { load } from "./system.mjs";
import { commandOf, fromLink, linkOf, preset, runOf, structureOf, valueOf } from "./state.js";
const data = JSON.parse(readFileSync("data.json", "utf8"));
const modules = Object.fromEntries(Object.keys(data.controllers).map((name) => [name, readFileSync(`${name}.wasm`)]));
const loop = await loopOf(data, modules, load);
"""
SWITCHED = {"figure": "fig5", "controller": "SlotineLiAdaptiveImpedance", "changes": {"m2": 2, "sample_time": 1e-4}}
STATES: Mapping[str, Mapping[str, Any]] = {
    "another controller, 10 kHz": SWITCHED,
    "adaptive control in fig2": {
        "figure": "fig2",
        "controller": "CraigAdaptiveImpedance",
        "changes": {"m2_hat": 3, "Psi_1": 60, "K_f": 5e4, "elbow": -1, "mu": 0.1},
    },
    "limits, noise and seed": {
        "figure": "fig7",
        "controller": "SlotineLiAdaptiveImpedance",
        "changes": {
            "tau_max_2": 200,
            "seed": 7,
            "contact_gated": 0,
            "noise_hold": 3e-4,
            "sample_time": 1e-4,
            "K_d": 90,
        },
    },
    "conventional in fig6": {"figure": "fig6", "controller": "HoganImpedance", "changes": {"sample_time": 1e-4}},
}
RELATIVE = 1e-12
"""By which a sum of 2e5 numbers may differ from that of numpy, whose pairwise sums err by about 18 units of 1e-16."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the scripts and the data of the live page."""
    folder = tmp_path_factory.mktemp("live")
    for name in WORKER:
        (folder / name).write_bytes((files("orchestration.paper.page") / "script" / name).read_bytes())
    (folder / "system.mjs").write_bytes(host())
    (folder / "package.json").write_text('{"type": "module"}')
    made = programs()
    for identifier, program in made.items():
        (folder / f"{identifier}.wasm").write_bytes(program.module)
    (folder / "data.json").write_text(json.dumps(live_data(made)), encoding="utf-8")
    return folder


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command line."""
    return runner(monkeypatch, capsys)


def run_page(page: Path, script: str, **given: Any) -> Any:
    """What a script prints as JSON; it finds the data, the loop and the given values."""
    values = "".join(f"const {name} = {json.dumps(value)};\n" for name, value in given.items())
    return script_output(page, HEAD + values + script)


def test_every_figure_has_the_hash_of_the_master(page: Path) -> None:
    script = """
    const found = {};
    for (const name of Object.keys(data.figures)) found[name] = await loop.hash(runOf(data, preset(data, name)));
    console.log(JSON.stringify(found));
    """
    native = json.loads((page / "data.json").read_text(encoding="utf-8"))["figures"]
    assert run_page(page, script) == {name: native[name]["hash"] for name in FIGURES}
    published = Path(__file__).parents[3] / "docs" / "same-bits.md"
    assert all(native[name]["hash"] in published.read_text(encoding="utf-8") for name in SCENARIOS)


@pytest.mark.parametrize("name", STATES)
def test_commands_and_files_give_the_same_bits(
    name: str, page: Path, adaptimp: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = """
    const run = runOf(data, state);
    writeFileSync("page.csv", Buffer.from(await loop.csv(run).arrayBuffer()));
    writeFileSync("page.ssd", structureOf(data, state));
    console.log(JSON.stringify({ hash: await loop.hash(run), command: commandOf(data, state) }));
    """
    said = run_page(page, script, state=STATES[name])
    monkeypatch.chdir(tmp_path)
    program, *words = shlex.split(said["command"])
    outcome = adaptimp(*words, "-o", "native.csv")
    assert (program, outcome.code) == ("adaptimp", 0), outcome.err
    assert f"SHA-256 of the rows: {said['hash']}\n" in outcome.out
    assert (page / "page.csv").read_bytes() == Path("native.csv").read_bytes()
    described = tmp_path / "page.ssd"
    described.write_bytes((page / "page.ssd").read_bytes())
    (tmp_path / "resources").mkdir()
    needed = {*FIGURES[STATES[name]["figure"]].models.values(), STATES[name]["controller"]}
    for identifier, path in fmus(sorted(needed)).items():
        shutil.copy(path, tmp_path / "resources" / f"{identifier}.fmu")
    assert f"SHA-256 of the rows: {said['hash']}\n" in adaptimp("run", "page.ssd", "--hash", "--no-verdict").out


class ChangedLaboratory(Laboratory):
    """Runs scenarios with start values that differ from theirs, which the test has chosen without the page."""

    def run(self, job: Job, record: Any = None) -> Any:
        """Run one job with the changes; those of the job go first."""
        noisy = {"sensor.seed": 2.0} if "controller.Gamma[2]" in FIGURES[job.scenario].values else {}
        psi = {"controller.Psi[1]": 60.0, "controller.Psi[2]": 60.0} if job.scenario in ("fig5", "fig6") else {}
        return super().run(replace(job, changes={"trajectory.depth": 0.01, **noisy, **psi, **job.changes}), record)


@pytest.mark.parametrize("changed", [False, True])
def test_claims_are_those_of_python(page: Path, changed: bool) -> None:
    """The same verdicts and the same numbers, for one seed; at the numbers of the figures and at others."""
    changes = {"depth": 0.01, "seed": 2, "Psi_1": 60} if changed else {}
    script = """
    const state = { ...preset(data, "fig5"), changes };
    const at = evidence(data, state, (run, columns) => loop.rows(run, columns));
    console.log(JSON.stringify(data.claims.map((claim) => answer(at, claim))));
    """
    answers = {one["id"]: one for one in run_page(page, script, changes=changes)}
    identifiers = {i for one in FIGURES.values() for i in one.models.values()}
    laboratory = (ChangedLaboratory if changed else Laboratory)(fmus(sorted(identifiers)))
    evidence = Evidence(laboratory, {name: laboratory.run(Job(name)) for name in SCENARIOS})
    expected = values_of(evidence)
    assert tuple(answers) == JUDGED == tuple(expected)
    for claim, values in expected.items():
        found = answers[claim]
        assert {NAMES[criterion] for criterion in values} == set(found["values"])
        for criterion, value in values.items():
            numbers = np.array(found["values"][NAMES[criterion]])
            expected_numbers = np.atleast_1d(cast("Any", value))
            np.testing.assert_allclose(numbers, expected_numbers, rtol=RELATIVE, err_msg=NAMES[criterion])
        assert found["holds"] == judged.met(values), claim


def values_of(evidence: Evidence) -> dict[str, judged.Values]:
    """What Python measures for each claim with one seed of the noise."""
    noise = {name: [summarize(evidence.results[name], evidence.ideal_force)] for name in judged.FIGURES}
    fixed = noise["fig7"][0].e_start / evidence.start_without_adaptation()
    allowed = np.array([SCENARIOS["fig6"].values[f"actuator.tau_max[{joint}]"].number for joint in (1, 2)])
    measured = {question.id: question.measurement for question in motion.QUESTIONS}
    return {
        **{claim: measured[claim](evidence).values for claim in ("C1", "C2", "C3a", "C3b")},
        "C4": judged.approach(noise),
        "C5": {**judged.deviation(noise), **judged.fluctuation(noise)},
        "C6": judged.recovery(noise),
        "C7": judged.saturation(noise),
        "C8": judged.torque(noise, allowed),
        "C9": {**judged.free_motion(noise), limits.FIXED_MASS_RATIO: fixed},
        "C10": judged.contact_errors(noise),
    }


def test_a_claim_that_cannot_be_judged_says_why(page: Path) -> None:
    """A wall out of reach is never touched; an impossible stiffness is refused by the controller."""
    script = """
    const said = (changes) => {
      const state = { ...preset(data, "fig5"), changes };
      const at = evidence(data, state, (run, columns) => loop.rows(run, columns));
      return answer(at, data.claims.find(({ id }) => id === "C2"));
    };
    console.log(JSON.stringify([{ wall_offset: 1.6, sample_time: 1e-4 }, { K: -1 }].map(said)));
    """
    untouched, refused = run_page(page, script)
    assert (untouched["holds"], untouched["why"]) == (None, "the tip never touches the wall")
    why = "the run fig2 fails: controller: K[1] = -1 must be at least 1e-12 N/m."
    assert (refused["holds"], refused["why"]) == (None, why)


def test_numbers_are_written_as_in_csv_files(page: Path) -> None:
    random = np.random.default_rng(17)
    bits = random.integers(0, 2**64, 20000, dtype=np.uint64).view(np.float64)
    special = [0.0, -0.0, 1e10, -1e10, 9999999999.999998, 1e15, 1e21, 1e-5, 1e-6, 1e-7, 5e-324, 0.1, 1e16, 123456.789]
    values = np.concatenate([bits[np.isfinite(bits)], special, random.normal(size=2000)])
    values.tofile(page / "numbers")
    script = """
    const bytes = readFileSync("numbers");
    const numbers = new Float64Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
    console.log(JSON.stringify([...numbers, NaN, Infinity, -Infinity].map(decimal)));
    """
    sink = pa.BufferOutputStream()
    pyarrow.csv.write_csv(pa.table({"x": [*values, np.nan, np.inf, -np.inf]}), sink)
    assert run_page(page, script) == sink.getvalue().to_pybytes().decode().split("\n")[1:-1]


def test_a_link_carries_the_state(page: Path) -> None:
    script = """
    const there = states.map((state) => fromLink(data, `#${linkOf(data, state)}`));
    const wrong = ["#try=fig9&m2=2", "#try=fig5&m2=two&mass=1&controller=PID", "#try=constructor", "#claims"];
    console.log(JSON.stringify([there, wrong.map((text) => fromLink(data, text) ?? null)]));
    """
    there, wrong = run_page(page, script, states=list(STATES.values()))
    assert [found["state"] for found in there] == [dict(state) for state in STATES.values()]
    fig5 = {"figure": "fig5", "controller": "CraigAdaptiveImpedance", "changes": {}}
    assert wrong == [
        {"state": {**fig5, "changes": {"m2": 2}}, "unknown": ["try=fig9"]},
        {"state": fig5, "unknown": ["m2=two", "mass=1", "controller=PID"]},
        {"state": fig5, "unknown": ["try=constructor"]},
        None,
    ]


def test_every_setting_shows_the_number_of_the_scenario_within_its_range(page: Path) -> None:
    script = """
    const shown = (name, setting) => valueOf(data, preset(data, name), setting) ?? null;
    const all = Object.keys(data.figures);
    const found = data.settings.map((setting) => [setting.key, all.map((name) => shown(name, setting))]);
    console.log(JSON.stringify(Object.fromEntries(found)));
    """
    found = run_page(page, script)
    for setting in live_settings():
        values = [value for value in found[setting.key] if value is not None]
        assert values, setting.key
        assert all(setting.low <= value <= setting.high for value in values), setting.key


def test_every_variable_of_a_setting_is_a_parameter() -> None:
    systems = {name: scenario(name) for name in FIGURES}
    for setting in live_settings():
        for path, figures in setting.changes.items():
            kinds = {systems[name].resolve(path)[1].causality for name in figures if path in FIGURES[name].values}
            assert kinds <= {"parameter"}, path
