"""What the bytecode of a function reads from outside: global names, attributes, and modules that it imports itself."""

import dis
from dataclasses import dataclass
from types import CodeType

from orchestration.campaigns.measuring.module_content import imported

_GLOBALS = ("LOAD_GLOBAL", "LOAD_NAME", "LOAD_FROM_DICT_OR_GLOBALS")


@dataclass(frozen=True)
class Reads:
    """Names that code reads, those of functions within it included.

    Attributes
    ----------
    names
        Global names.
    attributes
        Names after a dot.
    modules
        Full names of modules in import statements.
    """

    names: frozenset[str]
    attributes: frozenset[str]
    modules: tuple[str, ...]

    @classmethod
    def of(cls, code: CodeType, package: str) -> "Reads":
        """What code of a package reads."""
        steps = [step for step in dis.get_instructions(code) if step.opname not in ("EXTENDED_ARG", "CACHE")]
        names = {str(step.argval) for step in steps if step.opname in _GLOBALS}
        modules: list[str] = []
        for place, step in enumerate(steps):
            if step.opname == "IMPORT_NAME":  # the number of dots and the names after "import" lie before it
                level, after = steps[place - 2].argval, steps[place - 1].argval
                modules += imported(package, str(step.argval), int(level), after)
        inner = [cls.of(constant, package) for constant in code.co_consts if isinstance(constant, CodeType)]
        return cls(
            frozenset(names).union(*(one.names for one in inner)),
            frozenset(code.co_names).union(*(one.attributes for one in inner)),
            tuple(dict.fromkeys([*modules, *(name for one in inner for name in one.modules)])),
        )
