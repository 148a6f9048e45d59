"""Faults for `tests.conformance.mutations` as data: the changed text, and the tests that ought to notice first.

Every old text occurs exactly once in its file. None of the faults is equivalent:
each changes what a host can see. Faults that do not compile, or that the exporter refuses, are not listed.
"""

from typing import NamedTuple

DESCRIPTION, STATE, ORDER, CONTAINER = "modelDescription", "state", "call order", "container"


class Group(NamedTuple):
    """Faults in one file of a package: kind, the test modules to run first, and (old, new) by name."""

    kind: str
    file: str
    first: tuple[str, ...]
    faults: dict[str, tuple[str, str]]
    package: str = "adaptimp_fmu"


GROUPS = (
    Group(
        DESCRIPTION,
        "description.py",
        ("test_description", "test_call_order", "test_instantiation_and_logging"),
        {
            "value references are off by one": ("valueReference=str(reference)", "valueReference=str(reference + 1)"),
            "tunables are fixed": ('return "tunable"', 'return "fixed"'),
            "outputs are exact without a start": (
                'element.set("initial", "calculated")',
                'element.set("initial", "exact")',
            ),
            "descriptions are missing": ("description=variable.description", 'description=""'),
            "units of gains are missing": (
                "if variable.unit:\n        typed.set",
                "if variable.unit in QUANTITIES:\n        typed.set",
            ),
            "minimum is not declared": (
                '(("min", variable.minimum), ("max", variable.maximum))',
                '(("max", variable.maximum),)',
            ),
            "maximum is not declared": (', ("max", variable.maximum))', ",)"),
            "starts have six digits": ("    return repr(value)", '    return f"{value:.6g}"'),
            "Booleans start as their opposite": (
                'return "true" if value else "false"',
                'return "false" if value else "true"',
            ),
            "canInterpolateInputs is the opposite": (
                '"false" if isinstance(model, SampledModel) else "true"',
                '"true" if isinstance(model, SampledModel) else "false"',
            ),
            "output derivatives are not declared": ('maxOutputDerivativeOrder="1"', 'maxOutputDerivativeOrder="0"'),
            "only one instance is declared": ('OncePerProcess="false"', 'OncePerProcess="true"'),
            "variable steps are not declared": ('StepSize="true"', 'StepSize="false"'),
            "host's memory functions are declared": ('ManagementFunctions="true"', 'ManagementFunctions="false"'),
            "structure is off by one": ("index=str(first + i + 1)", "index=str(first + i)"),
            "initial unknowns depend as in a step": ("depends.initial)", "depends.in_step)"),
            "a category is not declared": ('    "logAll": "All messages",\n', ""),
        },
    ),
    Group(
        DESCRIPTION,
        "structure.py",
        ("test_description",),
        {
            "inputs are counted without parameters": ("tuple(n_p + j for j in row)", "tuple(j for j in row)"),
            "inputs do not reach outputs initially": ("ca.vertcat(p, u))", "p)"),
            "modes do not depend on the indicators": ("event.mode, event.indicator)", "event.mode, ca.SX(0))"),
            "noise does not depend on its seed": ("noise.active + noise_seed(model)", "noise.active"),
            "held outputs depend on inputs": ("= [[] for _ in range(y.numel())]\n    else", "= _rows(y, u)\n    else"),
        },
    ),
    Group(
        DESCRIPTION,
        "units.py",
        ("test_description",),
        {
            "denominators are factors": ("power = sign * int", "power = int"),
        },
    ),
    Group(
        DESCRIPTION,
        "package.py",
        ("test_archive", "test_description"),
        {
            "XML and binary have different GUIDs": ("guid.encode())", "guid.upper().encode())"),
            "GUID does not cover the sources": (
                'f"\\0{name}\\0{text}".encode())\n    guid',
                'f"\\0{name}".encode())\n    guid',
            ),
            "GUID does not cover the XML": ("hashlib.sha256(draft)", "hashlib.sha256()"),
            "entries have the time of the build": (
                "zipfile.ZipInfo(name, _EPOCH)",
                "zipfile.ZipInfo(name, __import__('time').localtime()[:6])",
            ),
            "a source is missing": (
                "for name, text in sources.items():",
                "for name, text in list(sources.items())[:-1]:",
            ),
        },
    ),
    Group(
        STATE,
        "runtime/snapshot.c",
        ("test_state", "test_derivatives"),
        {
            "a state forgets the tick's fraction": (
                "snapshot->state = instance->state;",
                "snapshot->state = instance->state;\n    snapshot->state.tick_fraction = 0;",
            ),
            "a state forgets what is prepared": (
                "snapshot->state = instance->state;",
                "snapshot->state = instance->state;\n"
                "    memset(snapshot->state.shared, 0, sizeof snapshot->state.shared);",
            ),
            "a state does not restore the phase": (
                "    instance->state = ((const Snapshot *)FMUstate)->state;",
                "    const int32_t phase = instance->state.phase;\n"
                "    instance->state = ((const Snapshot *)FMUstate)->state;\n"
                "    instance->state.phase = phase;",
            ),
            "a state forgets input derivatives": (
                "    instance->state = ((const Snapshot *)FMUstate)->state;",
                "    instance->state = ((const Snapshot *)FMUstate)->state;\n"
                "#if !MODEL_SAMPLED\n    instance->state.rates_given = 0;\n#endif",
            ),
            "a given state is not overwritten": ("*FMUstate ? (Snapshot *)*FMUstate : calloc", "calloc"),
            "a freed state is not freed": ("    free(*FMUstate);\n", ""),
            "refused bytes are not freed": ("        free(snapshot);\n", ""),
            "the checksum does not cover the last bytes": ("i < sizeof *snapshot;", "i + 8 < sizeof *snapshot;"),
            "the checksum is not compared": ("snapshot->checksum != checksum_of(snapshot)", "snapshot->checksum == 0"),
            "states of other FMUs are taken": ("model_guid, GUID_LENGTH) != 0", "model_guid, 1) != 0"),
            "a buffer may be a byte short": ("if (size < sizeof *snapshot)", "if (size + 1 < sizeof *snapshot)"),
        },
    ),
    Group(
        STATE,
        "runtime/lifecycle.c",
        ("test_state", "test_steps_and_experiment"),
        {
            "reset keeps a failed instance": (
                "    start_afresh(&instance->state);\n    return fmi2OK",
                "    if (instance->state.phase != FAILED) start_afresh(&instance->state);\n    return fmi2OK",
            ),
            "the name of an instance is not freed": ("    free(instance->name);\n", ""),
        },
    ),
    Group(
        STATE,
        "runtime/sampled.c",
        ("test_ticks", "test_state", "test_reference_data"),
        {
            "ticks are not rounded to": (
                "if (real_fabs(end - nearest) <= 1e-9 + 4",
                "if (real_fabs(end - nearest) <= 1e-14 + 4",
            ),
            "late clocks lose ticks": (" + 4 * DBL_EPSILON * real_fabs(t + h) / period)", " + 0 * DBL_EPSILON * t)"),
            "a tick at the start runs twice": ("- ceil_of(s->tick_fraction))", "- floor_of(s->tick_fraction))"),
            "the time of a tick is the step's": ("return s->start_time + (double)s->tick", "return s->time + 0.0"),
            "every step is a tick": ("return h == STATE_OF(instance)->values[MODEL_PERIOD]", "return h > 0"),
            "slow states are one tick early": ("s->tick % n == 0", "(s->tick + 1) % n == 0"),
            "a refused tick shows its outputs": (
                "    if (!outputs_valid(instance, y, tick_time(s))) return 0;\n",
                "    memcpy(outputs(s), y, MODEL_N_OUTPUTS * sizeof *y);\n"
                "    if (!outputs_valid(instance, y, tick_time(s))) return 0;\n",
            ),
        },
    ),
    Group(
        STATE,
        "runtime/continuous.c",
        ("test_derivatives", "test_state"),
        {
            "second input derivatives are doubled": ("0.5 * dt * s->input_rates[1][i]", "dt * s->input_rates[1][i]"),
            "second input derivatives stay": (
                "memset(s->input_rates, 0, sizeof s->input_rates);",
                "memset(s->input_rates, 0, sizeof s->input_rates[0]);",
            ),
            "outputs feel the inputs at the start": (
                "inputs_at(s, t, continued), sizeof s->end_inputs",
                "inputs_at(s, s->step_start, continued), sizeof s->end_inputs",
            ),
            "output derivatives feel the rates at the start": (
                "s->input_rates[0][i] + (t - s->step_start) * s->input_rates[1][i]",
                "s->input_rates[0][i] + 0 * t",
            ),
            "a sub-step that diverges is left out": ("return states_valid(instance, s->states, t + dt);", "return 1;"),
            "a sub-step that diverges in contact is left out": (
                "if (!states_valid(instance, end, t + rest)) return 0;",
                "if (!states_valid(instance, end, t + rest)) return 1;",
            ),
        },
    ),
    Group(
        STATE,
        "runtime/phases.c",
        ("test_settable", "test_numbers"),
        {
            "setting an input hides a changed parameter": (
                "constants_stale |= parameter_changed",
                "constants_stale = parameter_changed",
            ),
            "outputs are not refreshed initially": (
                "constants_stale |= parameter_changed;\n    s->outputs_stale = 1;\n",
                "constants_stale |= parameter_changed;\n",
            ),
        },
    ),
    Group(
        STATE,
        "runtime/access.c",
        ("test_settable", "test_numbers"),
        {
            "a refused array is stored in part": (
                "parameter_changed |= vr[i] < MODEL_FIRST_INPUT;",
                "parameter_changed |= vr[i] < MODEL_FIRST_INPUT, SLOT(&instance->state, vr[i]) = CONVERT(value[i]);",
            ),
        },
    ),
    Group(
        ORDER,
        "runtime/lifecycle.c",
        ("test_instantiation_and_logging", "test_call_order", "test_steps_and_experiment"),
        {
            "get before initialization": ("ALLOWED_GET = INIT", "ALLOWED_GET = INSTANTIATED | INIT"),
            "set after termination": ("ALLOWED_SET = INST", "ALLOWED_SET = TERMINATED | INST"),
            "set up twice": ("ALLOWED_SETUP = INST", "ALLOWED_SETUP = INITIALIZATION | INST"),
            "terminate changes nothing": ("    instance->state.phase = TERMINATED;\n", ""),
            "initialize without an experiment": (
                "if (!instance->state.experiment_defined)",
                "if (instance->state.experiment_defined > 1)",
            ),
            "stop before start": ("stopTime >= startTime && real_is_finite(stopTime)", "real_is_finite(stopTime)"),
            "any GUID": ("!fmuGUID || strcmp(fmuGUID, model_guid) != 0", "!fmuGUID || !*fmuGUID"),
            "a category off is all off": ("instance->logged & ~mask;", "0;"),
        },
    ),
    Group(
        ORDER,
        "runtime/step.c",
        ("test_steps_and_experiment", "test_call_order", "test_numbers"),
        {
            "any communication point": (
                "continues = real_fabs(t - s->time) <=",
                "continues = 0 * real_fabs(t - s->time) <=",
            ),
            "any communication point, quickly": (
                "h > 0 && real_fabs(t - s->time) <=",
                "h > 0 && 0 * real_fabs(t - s->time) <=",
            ),
            "clocks must be exact": ("return 1e-6 * h + CLOCK_TOLERANCE * scale;", "return 1e-16 * h * scale;"),
            "steps past the stop time": ("t + h > s->stop_time", "t > s->stop_time"),
            "steps past the stop time, quickly": ("t + h <= s->latest_end", "t <= s->latest_end"),
            "steps back": ("if (h > 0 && real_fabs", "if (real_fabs"),
            "inputs that are not finite": ("if (!inputs_valid(instance) || !cal", "if (!cal"),
            "a failed step leaves no error state": ("        instance->state.phase = FAILED;\n", ""),
            "no text as pending status": ('*value = "";', "*value = NULL;"),
        },
    ),
    Group(
        ORDER,
        "runtime/access.c",
        ("test_access", "test_numbers", "test_settable", "test_call_order", "test_description"),
        {
            "values below the minimum": ("value >= variable->min && ", ""),
            "values above the maximum": (" && value <= variable->max)", ")"),
            "outputs can be set": ("run->role == ROLE_INPUT", "run->role >= ROLE_INPUT"),
            "a Real as Integer": ("return run->type == type &&", "return run->type <= type &&"),
            "two variables are always neighbours": ("return vr[n - 1] == vr[0] + n - 1;", "return 1;"),
            "neighbours are those between two": (
                "n * sizeof *vr) == 0",
                "sizeof *vr) == 0 && vr[n - 1] == vr[0] + n - 1",
            ),
            "a run may end one later": ("n > run->length)", "n > run->length + 1)"),
            "what is copied at once may be more": ("#define COPIED_AT_ONCE 24", "#define COPIED_AT_ONCE 30"),
        },
    ),
    Group(
        ORDER,
        "runtime/derivatives.c",
        ("test_derivatives",),
        {
            "input derivatives without orders": (
                "    if (!arrays_present(instance, nvr, vr, value, name) ||\n"
                "        !arrays_present(instance, nvr, vr, order, name))",
                "    if (!arrays_present(instance, nvr, vr, value, name))",
            ),
            "output derivatives of order 2": ("if (order[i] != 1)", "if (order[i] < 1)"),
            "parameters between steps": (
                "(role != ROLE_INPUT && instance->state.phase != INITIALIZATION)",
                "(role != ROLE_INPUT && instance->state.phase == FAILED)",
            ),
            "directions have length one": ("direction[vr[i]] += dv[i];", "direction[vr[i]] += 1.0 + 0 * dv[i];"),
        },
    ),
    Group(
        ORDER,
        "runtime/log.c",
        ("test_instantiation_and_logging",),
        {
            "percent signs are not doubled": ("        if (*text == '%') escaped[n++] = '%';\n", ""),
            "refusals are logged although off": ("if (logging) {", "if (logging >= 0) {"),
        },
    ),
    Group(
        ORDER,
        "runtime/validate.c",
        ("test_numbers",),
        {
            "the first input is not looked at": (
                "sums[4] = {0};\n    size_t i = 0;",
                "sums[4] = {0};\n    size_t i = 1;",
            ),
            "the last input is not looked at": ("for (; i < n; ++i) sums", "for (; i + 1 < n; ++i) sums"),
            "huge numbers are not finite": ("? 1 : each_finite(values, n)", "? 1 : 0 * each_finite(values, n)"),
            "a check that is NaN passes": ("if (!(checks[i] > 0))", "if (checks[i] <= 0)"),
        },
    ),
    Group(
        CONTAINER,
        "runtime/container.c",
        ("test_container", "test_steps_and_experiment", "test_call_order"),
        {
            "steps need not be multiples": ("fabs(ratio - nearest) <= rounding", "fabs(ratio - nearest) <= 1"),
            "clocks of a container must be exact": ("1e-9 + 4 * DBL_EPSILON *", "0 * DBL_EPSILON *"),
            "a step of no inner step is taken": ("nearest >= 1 &&", "nearest >= 0 &&"),
            "inner steps are cut off": ("(uint64_t)(ratio + 0.5)", "(uint64_t)ratio"),
            "a failed initialization stays half done": (
                "        instance->state = before;\n",
                "        (void)before;\n",
            ),
            "the component is not named": ("if (failure->component)", "if (!failure->component)"),
            "numbers of a failure are cut": ("digits ? digits : DEFAULT_DIGITS", "DEFAULT_DIGITS"),
            "a container takes inputs that are not finite": ("if (!real_is_finite(value))", "if (0)"),
            "outputs of a container are not refreshed": ("{ CONTAINER(show)(&s->system); }", "{ (void)s; }"),
        },
    ),
    Group(
        CONTAINER,
        "runtime/access.c",
        ("test_access", "test_container"),
        {
            "runs of components are copied as one": ("return end < n ? end : n;", "return end < n ? n : n;"),
            "runs of another type are copied": (
                "if (!is_of_kind(&model_runs[vr[i]], type, only_inputs)) return 0;\n    return 1;\n#else",
                "if (is_of_kind(&model_runs[vr[i]], type, 2 * only_inputs)) continue;\n    return 1;\n#else",
            ),
        },
    ),
    Group(
        CONTAINER,
        "runtime/snapshot.c",
        ("test_container", "test_state"),
        {
            "positions within a state are not looked at": (
                "return position_fault(s);",
                "return (void)position_fault(s), NULL;",
            ),
        },
    ),
    Group(
        CONTAINER,
        "containers/fmu/structure.py",
        ("test_container", "test_description"),
        {
            "dependencies end at connections": ("                waiting.append(source)\n", ""),
            "parameters do not reach outputs initially": ('("input", "parameter", "local")', '("input",)'),
        },
        "orchestration",
    ),
    Group(
        CONTAINER,
        "containers/fmu/description.py",
        ("test_container", "test_description"),
        {
            "limits of components are lost": ('"relativeQuantity", "min", "max",', '"relativeQuantity",'),
            "tunables of components are fixed": ('TUNABLE: "tunable"}', 'TUNABLE: "fixed"}'),
            "the step is not declared": ('"stopTime": plan.system.stop_time, "stepSize": plan.step', '"stopTime": 1.0'),
        },
        "orchestration",
    ),
    Group(
        CONTAINER,
        "containers/fmu/write.py",
        ("test_container", "test_description", "test_access"),
        {
            "the GUID does not cover the sources": (
                'return "{" + str(uuid.UUID(bytes=digest.digest()[:16]))',
                'return "{" + str(uuid.UUID(int=7))',
            ),
            "components that lie apart are neighbours": (
                "return variable.member, variable.declared.type, variable.role, variable.place + ahead",
                "return variable.declared.type, variable.role",
            ),
        },
        "orchestration",
    ),
)
