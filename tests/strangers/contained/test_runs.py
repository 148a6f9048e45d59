"""A program that contains FMUs of other tools shows what the master shows, bit by bit."""

import re
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import System, prepare, scenario, simulate
from orchestration.containers.c.program import c_sources
from orchestration.containers.contained.foreign.compiler import write_below
from orchestration.containers.plan import plan_of
from tests.interop.foreign.builders import MAPPING, without_compiler
from tests.strangers.contained.conftest import Compiled
from tests.strangers.contained.fmus import SPELLINGS, controller, small, small_sources
from tests.strangers.contained.program import ZIG, FailedError

STRICT = (
    *("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wstrict-prototypes", "-Wmissing-prototypes"),
    *("-Wcast-qual", "-Wundef", "-Wvla", "-Werror", "-Wno-error=missing-prototypes"),
)
STEP = 0.01
SHARED = "#define MEMORY(m) (*((void)(m), &memory))\nextern double memory;\n"
"""Makes the state of the small FMU one that all instances in a process share."""
SAVING = """
static {ID}_System copy;
static void *saved[{ID}_N_SAVED];
int save({ID}_System *s) {{ return {ID}_save(s, &copy, saved); }}
int restore({ID}_System *s) {{ return {ID}_restore(s, &copy, saved); }}
void forget({ID}_System *s) {{ {ID}_forget(s, saved); }}
"""
ALGORITHMS = ("gauss-seidel", "jacobi")

pytestmark = [
    pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning"),
    pytest.mark.filterwarnings("ignore::orchestration.FormalityWarning"),
]


def coupled(first: Path, second: Path) -> System:
    """Three components of two FMUs, linked by all types of numbers, with start values of a parameter and a state."""
    system = System.of({"a": first, "b": second, "c": first})
    system = system.connect("a.y -> b.u", "a.count -> b.m", "b.odd -> c.on", "b.y -> c.u")
    return replace(system.set({"a.k": 1.5, "c.mode": 1, "a.x": 7.0}), step=STEP)


def assert_same(rows: Mapping[str, np.ndarray], result: Mapping[str, np.ndarray], every: int = 1) -> None:
    """Every column of a program has the bits of the master's result."""
    expected = {name: np.ascontiguousarray(np.asarray(result[name], np.float64)[::every]) for name in rows}
    assert {name for name, values in rows.items() if values.tobytes() != expected[name].tobytes()} == set()


@pytest.mark.skipif(without_compiler() is not None, reason=str(without_compiler()))
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_hand_written_controller_in_fig5(algorithm: str, tmp_path: Path, compiled: Compiled) -> None:
    """Its angles are degrees and its torques N.mm, so most of its connections convert units."""
    system = scenario("fig5").replace("controller", controller(tmp_path), MAPPING)
    steps = 92_000  # the first contact is from 0.907 s on
    result = simulate(system, stop_time=steps * system.run_step(), algorithm=algorithm)
    assert np.abs(result["plant.F_ext[1]"]).max() > 100
    program = compiled(system, algorithm=algorithm, compiler=ZIG)
    for every in (1, 7, 1000):  # inner steps in a step
        program.reset()
        rows = program.run(steps, every)
        assert len(rows) == len(result.names)
        assert_same(rows, {name: result[name][: steps // every * every + 1] for name in rows}, every)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_equal_names_do_not_clash(algorithm: str, pair: tuple[Path, Path], compiled: Compiled) -> None:
    """Both FMUs define `helper`, `table`, `memory` and FMI's functions, and another value of `table`."""
    system = coupled(*pair)
    result = simulate(system, stop_time=100 * STEP, algorithm=algorithm)
    assert_same(compiled(system, algorithm=algorithm).run(100), result)


@pytest.mark.parametrize("spelling", list(SPELLINGS)[1:])
def test_every_spelling_of_the_functions_is_found(
    spelling: str, pair: tuple[Path, Path], tmp_path: Path, compiled: Compiled
) -> None:
    system = coupled(small(tmp_path, "Spelled", spelling=spelling), pair[1])
    assert_same(compiled(system).run(100), simulate(system, stop_time=100 * STEP))


def test_the_adapter_compiles_without_a_warning(pair: tuple[Path, Path], compiled: Compiled) -> None:
    compiled(coupled(*pair), flags=STRICT, compiler=ZIG)


def test_equal_identifiers_do_not_clash(tmp_path: Path, compiled: Compiled) -> None:
    folders = [tmp_path / name for name in ("one", "two")]
    for folder in folders:
        folder.mkdir()
    system = coupled(small(folders[0]), small(folders[1], gain=-2.0))
    assert_same(compiled(system).run(100), simulate(system, stop_time=100 * STEP))


def test_one_instance_in_a_process_is_compiled_once_for_each_component(tmp_path: Path, compiled: Compiled) -> None:
    alone = small(tmp_path, "Alone", before=SHARED, flags='canBeInstantiatedOnlyOncePerProcess="true"')
    system = replace(System.of({"a": alone, "b": alone}).set({"b.k": 5.0}), step=STEP)
    program = compiled(system)
    assert [fmu.name for fmu in program.plan.fmus] == ["Alone", "Alone_1"]
    rows = program.run(100)
    assert_same(rows, simulate(system, stop_time=100 * STEP))
    assert rows["a.y"][-1] != rows["b.y"][-1]


def test_units_are_converted(tmp_path: Path, compiled: Compiled) -> None:
    length = small(tmp_path, "Length", units={"y": "mm", "u": "degC"})
    warmth = small(tmp_path, "Warmth", units={"u": "m", "y": "K"})
    system = replace(System.of({"a": length, "b": warmth}).connect("a.y -> b.u", "b.y -> a.u"), step=STEP)
    assert [c.scale.trivial for c in system.connections] == [False, False]
    assert_same(compiled(system).run(100), simulate(system, stop_time=100 * STEP))


def test_strings_keep_the_start_of_the_fmu(tmp_path: Path, compiled: Compiled) -> None:
    """The library begins with "ab", and the description says "abcd", which the master sets; y counts characters."""
    head = 'valueReference="0" causality="input" variability="discrete"'
    text = f'<ScalarVariable name="text" {head}><String start="abcd"/></ScalarVariable>'
    system = replace(System.of({"a": small(tmp_path, more=text)}), step=STEP)
    rows = compiled(system).run(10)
    assert rows["a.y"][0] == 1.5
    assert_same(rows, simulate(system, stop_time=10 * STEP, record="a.y a.count a.odd".split()))


def test_start_values_of_outputs_are_set(tmp_path: Path, compiled: Compiled) -> None:
    path = small(tmp_path, exact_output=True)
    system = replace(System.of({"a": path}).set({"a.x": 7.0}), step=STEP)
    rows = compiled(system).run(10)
    assert rows["a.x"][0] == 7
    assert_same(rows, simulate(system, stop_time=10 * STEP))


def test_tunables_and_inputs_act_from_the_next_step_on(pair: tuple[Path, Path], compiled: Compiled) -> None:
    system = replace(System.of({"a": pair[0]}), step=STEP)
    changes = {"a.b": 3.5, "a.u": 2.0, "a.m": 4, "a.on": True}
    with prepare(system, stop_time=10 * STEP) as run:
        run.run(until=5 * STEP)
        run.set(changes)
        run.run()
        result = run.result()
    program = compiled(system)
    rows = program.run(5)
    program.set({name: float(value) for name, value in changes.items()})
    later = [(program.step(), program.outputs())[1] for _ in range(5)]
    whole = {name: [*rows[name], *values] for name, values in zip(rows, np.transpose(later), strict=True)}
    assert_same({name: np.array(values) for name, values in whole.items()}, result)
    with pytest.raises(FailedError, match=r"^a: k is a fixed parameter"):
        program.set({"a.k": 1.0})


def test_states_are_saved_and_restored(pair: tuple[Path, Path], compiled: Compiled) -> None:
    system = coupled(*pair)
    program = compiled(system, more=SAVING.format(ID=system.name or "system"))
    program.run(30)
    assert program.library.save(program.state_pointer) == 1
    later = [(program.step(), program.outputs())[1] for _ in range(20)]
    for _ in range(2):
        assert program.library.restore(program.state_pointer) == 1
        program.set({"a.b": 0.5})
        again = [(program.step(), program.outputs())[1] for _ in range(20)]
        assert np.array(again).tobytes() == np.array(later).tobytes()
        program.set({"a.b": 9.0})  # the next restoring takes it back
        program.step(3)
    program.library.forget(program.state_pointer)


RESET = """
FMI2_Export fmi2Status NAMED(fmi2Reset)(fmi2Component c) {
    Model *m = c;
    const Model old = *m;
    memset(m, 0, sizeof *m);
    m->callbacks = old.callbacks, m->born = old.born;
    m->real[K] = 2, m->real[B] = 0.5, m->integer[M] = 1, m->integer[MODE] = 2;
    MEMORY(m) = 1;
    return strcpy(m->text, "ab"), fmi2OK;
}
"""
"""A function that the small FMU lacks, as the end of its source."""


def owning(folder: Path) -> Path:
    """A small FMU whose states mean something only in the instance that they are of."""
    source = small_sources()["small.c"]
    source = source.replace("    char text[16];\n", "    char text[16];\n    int born;\n")
    source = source.replace("    if (m == NULL) return NULL;\n", "    static int born;\n    m->born = ++born;\n")
    mine = "    if (((Model *)state)->born != ((Model *)c)->born) return fmi2Fatal;\n"
    begin = source.index("NAMED(fmi2SetFMUstate)")
    source = source[:begin] + source[begin:].replace("{\n", "{\n" + mine, 1)
    return small(folder, "Owning", edit={"small.c": source + RESET})


def test_a_saved_state_outlives_a_reset(tmp_path: Path, compiled: Compiled) -> None:
    path = owning(tmp_path)
    system = coupled(path, path)
    program = compiled(system, more=SAVING.format(ID=system.name or "system"))
    first = program.run(30)
    assert program.library.save(program.state_pointer) == 1
    later = [(program.step(), program.outputs())[1] for _ in range(20)]
    program.reset()
    again = program.run(30)
    assert {name: rows.tobytes() for name, rows in again.items()} == {n: rows.tobytes() for n, rows in first.items()}
    program.reset()
    assert program.library.restore(program.state_pointer) == 1
    assert np.array([(program.step(), program.outputs())[1] for _ in range(20)]).tobytes() == np.array(later).tobytes()
    program.library.forget(program.state_pointer)
    program.reset()
    assert_same(program.run(30), simulate(system, stop_time=30 * STEP))


def test_the_state_of_an_instance_that_is_gone_is_not_restored(pair: tuple[Path, Path], compiled: Compiled) -> None:
    """The sources have no fmi2Reset, so that a reset makes a new instance, in which the state means nothing."""
    system = replace(System.of({"a": pair[0]}), step=STEP)
    program = compiled(system, more=SAVING.format(ID=system.name or "system"))
    program.run(30)
    assert program.library.save(program.state_pointer) == 1
    program.reset()
    assert program.library.restore(program.state_pointer) == 0
    assert program.library.save(program.state_pointer) == 1
    assert program.library.restore(program.state_pointer) == 1
    program.library.forget(program.state_pointer)
    assert_same(program.run(30), simulate(system, stop_time=30 * STEP))


def test_a_system_saves_only_if_every_fmu_does(pair: tuple[Path, Path], tmp_path: Path, compiled: Compiled) -> None:
    system = coupled(pair[0], small(tmp_path, "Forgetful", flags=""))
    header = compiled(system)
    assert not [fmu.saves for fmu in header.plan.fmus][1]
    assert "_save" not in (tmp_path / "program0" / "step.h").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        (2, r"^a: fmi2DoStep returned fmi2Discard; its last message: \"the tank is 2 % full\"\.$"),
        (3, r"^a: fmi2DoStep returned fmi2Error; its last message: \"the tank is 3 % full\"\.$"),
        (4, r"^a: fmi2DoStep returned fmi2Fatal; its last message: \"the tank is 4 % full\"\.$"),
        (5, r"^a: Output y is nan at t = 0\.2\d* s; it must be finite\.$"),
    ],
)
def test_failures_tell_the_function_and_the_message(
    fault: int, sentence: str, pair: tuple[Path, Path], compiled: Compiled
) -> None:
    system = replace(System.of({"a": pair[0]}).set({"a.fault": fault}), step=STEP)
    program = compiled(system)
    for _ in range(2):  # after a reset everything is as before
        with pytest.raises(FailedError, match=sentence):
            program.run(100)
        assert program.get("a.count") in (20, 21, 22)
        program.reset()


def test_a_warning_is_no_failure(pair: tuple[Path, Path], compiled: Compiled) -> None:
    system = replace(System.of({"a": pair[0]}).set({"a.fault": 1}), step=STEP)
    assert compiled(system).run(100)["a.count"][-1] == 100


def test_a_failed_instantiation_is_told_at_initialization(pair: tuple[Path, Path], compiled: Compiled) -> None:
    system = replace(System.of({"a": pair[0]}), step=STEP)
    program = compiled(system, flags=("-DFOREIGN_ARENA=64",))
    with pytest.raises(FailedError, match=r"^a: fmi2Instantiate failed; it logged nothing\.$"):
        program.initialize()


def test_memory_may_come_from_an_array(pair: tuple[Path, Path], compiled: Compiled) -> None:
    """Its pieces come back: a system is reset as often as needed."""
    system = coupled(*pair)
    result = simulate(system, stop_time=20 * STEP)
    program = compiled(system, flags=("-DFOREIGN_ARENA=2048",))
    for _ in range(50):
        assert_same(program.run(20), result)
        program.reset()


def test_values_have_places_where_doubles_are_aligned_to_4_bytes(pair: tuple[Path, Path], tmp_path: Path) -> None:
    """On 32-bit x86 a double in a structure may lie between two places; step.c asserts that none does."""
    write_below(tmp_path, c_sources(plan_of(coupled(*pair))))
    target = ("-target", "x86-linux-musl", "-msse2", "-mfpmath=sse")
    command = [*ZIG, *target, "-std=c11", "-fno-sanitize=all", "-c", "step.c", "-o", "step.o"]
    found = subprocess.run(command, cwd=tmp_path, check=False, capture_output=True, text=True)
    assert (found.returncode, found.stderr) == (0, "")
    assert "_Static_assert" in (tmp_path / "step.c").read_text(encoding="utf-8")


def test_the_header_is_one_of_cpp_too(pair: tuple[Path, Path], tmp_path: Path) -> None:
    write_below(tmp_path, c_sources(plan_of(coupled(*pair))))
    (tmp_path / "user.cpp").write_text('#include "step.h"\nint step_of(system_System *s);\n', encoding="utf-8")
    compiler = ("g++",) if shutil.which("g++") else (*ZIG[:-1], "c++")
    command = [*compiler, "-std=c++11", "-Wall", "-Wpedantic", "-fsyntax-only", "user.cpp"]
    found = subprocess.run(command, cwd=tmp_path, check=False, capture_output=True, text=True)
    assert (found.returncode, found.stderr) == (0, "")


def test_the_sources_are_unchanged(tmp_path: Path, compiled: Compiled) -> None:
    latin = b"/* L\xe4nge */\n"
    path = small(tmp_path, edit={"notes.txt": latin.decode("utf-8", "surrogateescape")})
    compiled(replace(System.of({"a": path}), step=STEP))
    folder = tmp_path / "program0" / "fmus" / "Small"
    assert (folder / "notes.txt").read_bytes() == latin
    assert not re.search("Small_", (folder / "small.c").read_text(encoding="utf-8"))
