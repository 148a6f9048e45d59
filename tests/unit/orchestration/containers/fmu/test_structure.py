"""What outputs of a system depend on follows the connections, where nothing is declared and in loops, too."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from lxml import etree

from orchestration.containers.fmu.structure import Structure, structure
from orchestration.fmi.description import Description, Variable
from orchestration.fmi.document import Document
from orchestration.system.component import Component
from orchestration.system.system import System

NAMES = ("p", "u", "v", "y", "z")  # a parameter, two inputs, two outputs; indices from 1
CAUSALITIES = {"p": "parameter", "u": "input", "v": "input", "y": "output", "z": "output"}
Rows = dict[str, Sequence[str] | None]


def listed(rows: Rows) -> str:
    """Rows of a list of unknowns; None leaves the dependencies out."""
    text = ""
    for output, names in rows.items():
        given = "" if names is None else f' dependencies="{" ".join(str(NAMES.index(n) + 1) for n in names)}"'
        text += f'<Unknown index="{NAMES.index(output) + 1}"{given}/>'
    return text


def document(in_step: Rows, initial: Rows) -> Document:
    """The description of a component with these dependencies."""
    rows = "".join(
        f'<ScalarVariable name="{name}" valueReference="{i}" causality="{CAUSALITIES[name]}"><Real/></ScalarVariable>'
        for i, name in enumerate(NAMES)
    )
    lists = f"<Outputs>{listed(in_step)}</Outputs><InitialUnknowns>{listed(initial)}</InitialUnknowns>"
    return Document(
        etree.fromstring(
            f"<fmiModelDescription><ModelVariables>{rows}</ModelVariables>"
            f"<ModelStructure>{lists}</ModelStructure></fmiModelDescription>"
        )
    )


def component(name: str) -> Component:
    variables = {
        n: Variable(n, i, "Real", CAUSALITIES[n], "fixed" if n == "p" else "continuous", "", None)
        for i, n in enumerate(NAMES)
    }
    return Component(name, Description(Path(name), name, name, "", variables, {}))


def found(connections: Sequence[str], **documents: Document) -> Structure:
    """The structure of a system of such components."""
    system = System("s", tuple(map(component, documents)))
    return structure(system.connect(*connections) if connections else system, documents)


def paths(names: frozenset[tuple[str, str]]) -> set[str]:
    return {".".join(name) for name in names}


THROUGH = document({"y": ["u"], "z": []}, {"y": ["u", "p"], "z": ["v"]})


def test_a_chain_reaches_the_inputs_that_nothing_drives() -> None:
    result = found(["a.y -> b.u", "b.y -> c.u"], a=THROUGH, b=THROUGH, c=THROUGH)
    assert paths(result.in_step["c", "y"]) == {"a.u"}
    assert paths(result.in_step["c", "z"]) == set()
    assert paths(result.initial["c", "y"]) == {"a.u", "a.p", "b.p", "c.p"}
    assert paths(result.initial["c", "z"]) == {"c.v"}


def test_a_held_output_ends_the_way() -> None:
    held = document({"y": [], "z": []}, {"y": ["u"], "z": ["u"]})
    result = found(["a.y -> b.u"], a=held, b=THROUGH)
    assert paths(result.in_step["b", "y"]) == set()
    assert paths(result.initial["b", "y"]) == {"a.u", "b.p"}


def test_what_is_not_declared_depends_on_everything() -> None:
    silent = document({"y": None, "z": []}, {"y": None})
    result = found(["a.y -> b.u"], a=THROUGH, b=silent)
    assert paths(result.in_step["b", "y"]) == {"a.u", "b.v"}
    assert paths(result.initial["b", "y"]) == {"a.u", "a.p", "b.v", "b.p"}
    assert paths(result.initial["b", "z"]) == {"a.u", "a.p", "b.v", "b.p"}


@pytest.mark.parametrize("loop", [["a.y -> b.u", "b.y -> a.u"], ["b.y -> a.u", "a.y -> b.u"]])
def test_a_loop_ends(loop: list[str]) -> None:
    """Both outputs depend on what either component takes from outside."""
    wide = document({"y": ["u", "v"], "z": []}, {"y": ["u", "v"], "z": []})
    result = found(loop, a=wide, b=wide)
    assert paths(result.in_step["a", "y"]) == paths(result.in_step["b", "y"]) == {"a.v", "b.v"}
