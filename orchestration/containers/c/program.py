"""Writes the C program of a system: order, links, initialization and inner step, around the sources of its FMUs.

    step.h  step.c  failure.h      the system
    fmus/NAME.h  fmus/NAME.c       each FMU as a part of the program
    fmus/NAME.source1.c ...        the sources of an FMU of another tool, under names of their own
    fmus/NAME/...                  the files of its sources

Links are direct assignments. Values take the way that FMI's functions give them in a run: a Boolean is 0 or 1.
"""

from collections.abc import Iterator, Sequence

from adaptimp_fmu.runtime_files import runtime_sources
from orchestration.containers.c_text import c_number, environment
from orchestration.containers.plan import FIXED, GAUSS_SEIDEL, INPUT, OUTPUT, TUNABLE, Link, Plan
from orchestration.fmi.codes import BOOLEAN, INTEGER

FOLDER = "fmus"
"""Folder of the FMUs' sources."""
_FINITE_INPUTS = "/* All inputs take outputs that were found to be finite. */\n#define INPUTS_ARE_FINITE\n\n"


def c_sources(plan: Plan, *, variable_step: bool = False) -> dict[str, str]:
    """Return the C sources of a system, without a main function.

    Parameters
    ----------
    plan
        Plan of the program.
    variable_step
        Whether the step is a number in the state of the system, which is set after each reset, instead of the plan's.

    Returns
    -------
    dict
        Texts by file name. To compile are ``step.c`` and each ``fmus/NAME.c``.
    """
    templates = environment()
    given = {
        "plan": plan,
        "id": plan.identifier,
        "system": plan.system.name,
        "folder": FOLDER,
        "plain": all(fmu.plain for fmu in plan.fmus),
        "saves": bool(plan.foreign) and plan.saves,
        "foreign": plan.foreign,
        "output_starts": list(_output_starts(plan)),
        "counts": counts(plan),
        "owners": [variable.member for variable in plan.with_role(FIXED, TUNABLE, INPUT)],
        "wholes": [i for i, v in enumerate(plan.variables) if v.variable.stands_for and v.role != OUTPUT],
        "integer_links": any(link.type == INTEGER for link in plan.links),
        "passes": list(_passes(plan)),
        "sampled": any(member.period for member in plan.members),
        "step": list(_inner_step(plan)),
        "variable_step": variable_step,
        "given_system": f"const {plan.identifier}_System *s, " if variable_step else "",
        "give_system": "s, " if variable_step else "",
    }
    found = {name: templates.get_template(f"{name}.j2").render(given) for name in ("step.h", "step.c")}
    found["failure.h"] = runtime_sources()["failure.h"]
    for fmu in plan.fmus:
        tested = _FINITE_INPUTS if plan.takes_tested_values(fmu) else ""
        found[f"{FOLDER}/{fmu.name}.h"] = fmu.header
        found[f"{FOLDER}/{fmu.name}.c"] = tested + fmu.source
        found |= {f"{FOLDER}/{name}": text for name, text in fmu.wrappers.items()}
        found |= {f"{FOLDER}/{fmu.name}/{name}": text for name, text in fmu.sources.items()}
    return found


def counts(plan: Plan) -> dict[str, int]:
    """Return the numbers of variables by their role."""
    return {
        "parameters": len(plan.with_role(FIXED, TUNABLE)),
        "inputs": len(plan.with_role(INPUT)),
        "outputs": len(plan.with_role(OUTPUT)),
    }


def compiled_files(plan: Plan) -> list[str]:
    """Return the names of the files that are compiled, each alone."""
    files = [name for fmu in plan.fmus for name in (f"{fmu.name}.c", *fmu.wrappers)]
    return ["step.c", *(f"{FOLDER}/{name}" for name in files)]


def _output_starts(plan: Plan) -> Iterator[tuple[str, int, float]]:
    """Start values that the system gives to outputs: where they are, and the values."""
    for member in plan.members:
        for name, value in member.component.start.items():
            if member.component.variable(name).causality == "output":
                yield member.field, member.place(name), float(value)


def _passes(plan: Plan) -> Iterator[dict[str, object]]:
    """Passes of the initialization as C."""
    members = {member.name: member for member in plan.members}
    links = {(link.connection.target, link.connection.input): link for link in plan.links}
    for one in plan.initialization:
        member = members[one.component]
        copied = [links[c.target, c.input] for c in one.connections]
        yield {
            "function": member.fmu.name,
            "field": member.field,
            "lines": [_assignment(plan, link) for link in _ordered(copied)],
        }


def _ordered(links: Sequence[Link]) -> list[Link]:
    return sorted(links, key=lambda link: (link.target, link.target_place))


def _inner_step(plan: Plan) -> Iterator[str]:
    """Lines of an inner step."""
    numbers = range(len(plan.members))
    if plan.algorithm == GAUSS_SEIDEL:
        for i in numbers:
            yield from (_assignment(plan, link) for link in plan.links_to(i))
            yield _call(plan, i)
        return
    for i in numbers:
        yield from (_assignment(plan, link) for link in plan.links_to(i))
    yield from (_call(plan, i) for i in numbers)


def _call(plan: Plan, i: int) -> str:
    member = plan.members[i]
    call = f"{member.fmu.name}_step(&s->{member.field}, t, STEP_SIZE, failure)"
    return f"if (!{call}) return failed(failure, {i});"


def _assignment(plan: Plan, link: Link) -> str:
    """A link as an assignment, rounded as the master's conversion of inputs is."""
    source = f"s->{plan.members[link.source].field}.values[{link.source_place}]"
    target = f"s->{plan.members[link.target].field}.values[{link.target_place}]"
    if link.type == BOOLEAN:
        return f"{target} = {source} < 0 || {source} > 0 ? 1 : 0;"
    if link.type == INTEGER:
        return f"{target} = to_integer({source});"
    if link.scale.trivial:
        return f"{target} = {source};"
    return f"{target} = {c_number(link.scale.factor)} * {source} + {c_number(link.scale.offset)};"
