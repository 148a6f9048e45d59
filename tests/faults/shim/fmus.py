"""Builds the FMU that misbehaves, and systems of it and a healthy FMU."""

from pathlib import Path

from adaptimp_fmu import ContinuousModel, Type, build, host_platform
from adaptimp_fmu.package import definition
from adaptimp_fmu.toolchain import compile_library
from orchestration import System
from orchestration.fmi.signatures import FUNCTIONS
from tests.faults.shim.codes import NO_FAULT, NUMBERS, Fault, header
from tests.strangers.fmus import packed

STEP, STOP, AFTER = 0.125, 4.0, 12
"""Step and end of a run, s; calls of the misbehaving function that are as they should be."""
_SHIM = Path(__file__).with_name("shim.c")
_PARAMETERS = ("fault", "function", "after")


def decay(
    name: str, start: float, through: float, fault: int = NO_FAULT, function: int = -1, after: int = 0
) -> ContinuousModel:
    """dx/dt = u - x, y = x + through u, with outputs of all types, and with parameters for the fault."""
    model = ContinuousModel(name, "A decay", dt_max=STEP / 4)
    u = model.input("u", 0.5, description="Drives x")
    model.input("n", 0, type=Type.INTEGER, description="Unused")
    model.input("b", 0, type=Type.BOOLEAN, description="Unused")
    for parameter, value in {"fault": fault, "function": function, "after": after}.items():
        model.parameter(parameter, value, type=Type.INTEGER, description="How the FMU misbehaves")
    x = model.state("x", start)
    model.derivative(x, u - x)
    model.output("y", x + through * u, description="x, and a part of u", scalar=True)
    model.output("m", x > 0.5, type=Type.INTEGER, description="Whether x is large, as a number", scalar=True)
    model.output("large", x > 0.5, type=Type.BOOLEAN, description="Whether x is large", scalar=True)
    return model


def misbehaving(folder: Path, fault: Fault | None = None, function: str = "", after: int = 0) -> Path:
    """Build ``Faulty.fmu``, whose functions are wrapped by the shim.

    Parameters
    ----------
    fault, function, after
        Start values: what the FMU does unless other values are set.
    """
    numbers = (NO_FAULT, -1) if fault is None else (int(fault), NUMBERS[function])
    model = decay("Faulty", 1.0, 0.25, *numbers, after)
    sources, description = definition(model)
    library = folder / f"Faulty{host_platform().extension}"
    _compile(sources, {name: model.reference(name) for name in _PARAMETERS}, folder / "sources", library)
    return packed(folder / "Faulty.fmu", library, description.decode())


def healthy(folder: Path) -> Path:
    """Build ``Healthy.fmu``, the same model as it is exported."""
    return build(decay("Healthy", 0.25, 0.0), folder)


def coupled(faulty: Path, partner: Path, fault: Fault | None, function: str, after: int = AFTER) -> System:
    """Both FMUs, each driven by the other; the component ``faulty`` misbehaves in calls of a function.

    The FMU has no parameters yet when it is instantiated; the fault is in the name of the component then.
    """
    born = fault is not None and function == "fmi2Instantiate"
    name = f"born_{int(fault)}" if born and fault is not None else "faulty"
    pairs = [(f"{name}.{source}", f"healthy.{target}") for source, target in (("y", "u"), ("m", "n"), ("large", "b"))]
    pairs += [(a.replace(name, "healthy"), b.replace("healthy", name)) for a, b in pairs]
    system = System.of({name: faulty, "healthy": partner}).connect(*(f"{a} -> {b}" for a, b in pairs))
    if fault is None or born:
        return system
    return system.set({f"{name}.function": NUMBERS[function], f"{name}.after": after, f"{name}.fault": int(fault)})


def _compile(sources: dict[str, str], references: dict[str, int], folder: Path, library: Path) -> None:
    """Compile the shim with the model inside."""
    folder.mkdir()
    sources["faults.h"] = header(references)
    # The functions of the model get names of their own.
    sources["inner_names.h"] = "".join(f"#undef {n}\n#define {n} inner_{n.removeprefix('fmi2')}\n" for n in FUNCTIONS)
    sources["outer_names.h"] = "".join(f"#undef {name}\n" for name in FUNCTIONS)
    sources["shim.c"] = _SHIM.read_text(encoding="utf-8")
    for name, text in sources.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    compile_library(folder / "shim.c", library, host_platform())
