"""Variants of the controller in C that have one mistake each, as its author could have made it.

Each is an edit of its C source or of its description. What `check` finds first is the mistake. What a run of
Fig. 5 says depends: the swap is refused, the FMU refuses to start, or a step fails; or nothing, where only the
torques are wrong, or what a plain run never uses.
"""

from dataclasses import dataclass
from enum import Enum

from orchestration import InitializationError, SimulationError, SystemDescriptionError
from orchestration.check import Severity
from orchestration.check.findings import ROLE
from orchestration.paper.closed_loop import LOOP
from tests.interop.foreign.builders import Edit

ERROR, WARNING = Severity.ERROR, Severity.WARNING
COMPUTE = "    compute_torque(core->value);\n    core->time = t + h;"


class Outcome(Enum):
    """What becomes of a run of Fig. 5 that no exception ends."""

    SAME = "the rows of the right controller: a plain run does not use what is wrong"
    LOST = "rows that are useless: the tip is nowhere near the virtual trajectory"
    DEAD = "the process ends, or never returns: it is not tried in this one"


@dataclass(frozen=True)
class Wrong:
    """A mistake and what is seen of it.

    Attributes
    ----------
    source, description
        What it changes.
    found
        Rule, severity and message of `check`'s finding.
    run
        Exception and message, or what becomes of the rows.
    """

    found: tuple[str, Severity, str]
    run: tuple[type[Exception], str] | Outcome
    source: Edit = lambda text: text
    description: Edit = lambda text: text


def swap(old: str, new: str, times: int = 1) -> Edit:
    """An edit of all places of a text, as many as there must be."""

    def edit(text: str) -> str:
        assert text.count(old) == times, f"{old!r} is there {text.count(old)} times"
        return text.replace(old, new)

    return edit


def both(first: Edit, second: Edit) -> Edit:
    """Two edits."""
    return lambda text: second(first(text))


def before_the_law(lines: str) -> Edit:
    """C code in a step, before the torque is computed."""
    return swap(COMPUTE, f"{lines}\n{COMPUTE}")


def behind_the_law(lines: str) -> Edit:
    """C code in a step, behind the computation of the torque."""
    return swap(COMPUTE, f"{COMPUTE}\n{lines}")


def joint_angle(old: str, new: str) -> Edit:
    """An edit of the element that declares the second joint angle, whose start value is its alone."""
    begin = '    <ScalarVariable name="JointAngle[2]" valueReference="1" '
    end = "</ScalarVariable>"

    def edit(text: str) -> str:
        start = text.index(begin)
        stop = text.index(end, start)
        return text[:start] + swap(old, new)(text[start:stop]) + text[stop:]

    return edit


WRONG: dict[str, Wrong] = {
    "a torque has another name": Wrong(
        (ROLE, ERROR, r"The output tau_cmd\[2\] in N.m of the controller is missing"),
        (
            SystemDescriptionError,
            r"Mapping tau_cmd=Torque: CartesianImpedance has no variable Torque\[2\]; the elements",
        ),
        description=swap('name="Torque[2]"', 'name="TorqueOfElbow"'),
    ),
    "torques are declared in N": Wrong(
        (ROLE, ERROR, r"tau_cmd\[1\] of the controller has the unit N \(kg m s-2\); N.m \(kg m2 s-2\) is needed"),
        (SystemDescriptionError, r"controller.tau_cmd\[1\] -> actuator.tau_cmd\[1\].*: units N and N.m differ"),
        description=swap('<Real unit="N.mm"/>', '<Real unit="N"/>', times=2),
    ),
    "an input is declared as parameter": Wrong(
        (ROLE, ERROR, r"q\[2\] of the controller has causality parameter; input is needed"),
        (SystemDescriptionError, r"plant.q\[2\] -> controller.q\[2\].*: q\[2\] has causality parameter, not input"),
        description=joint_angle('causality="input"', 'causality="parameter" variability="fixed"'),
    ),
    "the description is of another version": Wrong(
        ("9", ERROR, r"fmi2Instantiate refuses the GUID of the description \(.The GUID .*1c04} is not .*1c03}"),
        (InitializationError, r"controller: fmi2Instantiate failed; its last message: .The GUID .*1c04} is not "),
        description=swap("4f1c03}", "4f1c04}"),
    ),
    "a direction of no force": Wrong(
        ("11", ERROR, r"Outputs are not finite at t = 0.0001 s: Torque\[1\] = -?nan"),
        (
            SimulationError,
            r"actuator: fmi2DoStep returned fmi2Error at t = 0 s \(step 0\); its last message: .Input tau_cmd\[1\] is "
            r"-?nan; it must be finite.*It was given controller.tau_cmd\[1\] = -?nan\.",
        ),
        source=behind_the_law(
            "    core->value[TORQUE] -= 50 * core->value[FORCE] / hypot(core->value[FORCE], core->value[FORCE + 1]);"
        ),
    ),
    "only its own step is taken": Wrong(
        ("11", ERROR, r"Stepping: fmi2DoStep returns fmi2Error at t = 0 s \(.This controller runs at 1 kHz"),
        (
            SimulationError,
            r"controller: fmi2DoStep returned fmi2Error at t = 0 s \(step 0\); its last message: "
            r".This controller runs at 1 kHz, not with steps of 2e-05 s\.",
        ),
        source=before_the_law(
            "    if (fabs(h - 1e-3) > 1e-9)\n"
            '        return failed(unit, "This controller runs at 1 kHz, not with steps of %g s.", h);'
        ),
    ),
    "a file that is not there": Wrong(
        ("11", ERROR, "fmi2DoStep dies of SIG(SEGV|BUS) during the experiment 'stepping'"),
        Outcome.DEAD,
        source=before_the_law(
            '    FILE *log = fopen("/nonexistent/torques.csv", "a");\n    fprintf(log, "%g\\n", core->value[TORQUE]);'
        ),
    ),
    "waits for contact": Wrong(
        ("11", ERROR, r"fmi2DoStep does not return within [0-9.]+ s during the experiment 'stepping'"),
        Outcome.DEAD,
        source=before_the_law(
            "    const volatile double *force = &core->value[FORCE];\n    while (*force == 0) {\n    }"
        ),
    ),
    "a restored state forgets the torque": Wrong(
        ("13", ERROR, r"After fmi2SetFMUstate, Torque\[1\] is .* in row 0; when the state was saved it is"),
        Outcome.SAME,
        source=swap(
            "    memcpy(&unit->core, state, sizeof(Core));\n",
            "    const double held[2] = {unit->core.value[TORQUE], unit->core.value[TORQUE + 1]};\n"
            "    memcpy(&unit->core, state, sizeof(Core));\n"
            "    memcpy(&unit->core.value[TORQUE], held, sizeof held);\n",
        ),
    ),
    "a restored state forgets the time": Wrong(
        (
            "13",
            ERROR,
            r"Rollback: fmi2DoStep returns fmi2Error at t = \S+ s \(.The step begins at .*, but this unit is at",
        ),
        Outcome.SAME,
        source=swap(
            "    memcpy(&unit->core, state, sizeof(Core));\n",
            "    memcpy(unit->core.value, ((Core *)state)->value, sizeof unit->core.value);\n",
        ),
    ),
    "a reset keeps the inputs": Wrong(
        ("13", ERROR, r"After fmi2Reset, Torque\[1\] is .* in row 0; in a fresh instance it is"),
        Outcome.SAME,
        source=swap("(ALIVE);\n    unit->core = FRESH;", "(ALIVE);\n    unit->core.mode = INSTANTIATED;"),
    ),
    "the sign of the torque": Wrong(
        (LOOP, ERROR, "The loop does not run: plant: fmi2DoStep returned fmi2Error at t = 0.0[0-9]+ s .*it diverges"),
        (
            SimulationError,
            r"plant: fmi2DoStep returned fmi2Error at t = 0.0\d+ s \(step \d+\); .*(divergence|diverges)",
        ),
        source=swap("v[TORQUE + i] /= TORQUE_UNIT;", "v[TORQUE + i] /= -TORQUE_UNIT;"),
    ),
    "degrees are declared as radians": Wrong(
        (LOOP, ERROR, r"The tip misses the virtual trajectory by [0-9.]+ m within 1.2 s, .* the loop diverges"),
        Outcome.LOST,
        description=both(
            swap(
                '<Unit name="deg"><BaseUnit rad="1" factor="0.017453292519943295"/>',
                '<Unit name="rad"><BaseUnit rad="1"/>',
            ),
            swap('<Real unit="deg" ', '<Real unit="rad" ', times=2),
        ),
    ),
    "the sign of the force": Wrong(
        (
            LOOP,
            WARNING,
            r"misses the virtual trajectory by 0.030\d* m within 1.2 s, 0.0165 m with the loop's own controller; "
            "at the wall, not before: look at what the controller makes of F_hat",
        ),
        Outcome.SAME,  # before the wall is touched
        source=both(
            swap("(damped + sprung + v[FORCE + i])", "(damped + sprung - v[FORCE + i])"),
            swap("force[i] += v[FORCE + i]", "force[i] -= v[FORCE + i]"),
        ),
    ),
}
