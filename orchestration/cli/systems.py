"""Finds the system that a command line names, with another controller and other start values if asked for."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from orchestration.cli.settings import setting_of, start_value
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion
from orchestration.system.system import System

FMU, PACKAGE, DEFINITION = ".fmu", ".ssp", ".ssd"


@dataclass(frozen=True)
class SystemRequest:
    """The system that a command is about: its name, and what is changed in it.

    Attributes
    ----------
    name
        A scenario, an .ssp or .ssd file, a folder with an .ssd file, or an .fmu file.
    controller
        FMU in the place of the component ``controller``: a file or the name of a shipped model.
    mapping
        Texts OURS=THEIRS: a name in the system, and that FMU's name for the same variable.
    settings
        Texts COMPONENT.VARIABLE=VALUE: start values.
    sample_time
        Communication step and every sampling period, s.
    variant
        Name of another .ssd file of a package.
    reals
        Whether the shipped FMUs have Reals in the place of Booleans and Integers.
    """

    name: str
    controller: str | None = None
    mapping: Sequence[str] = ()
    settings: Sequence[str] = ()
    sample_time: float | None = None
    variant: str | None = None
    reals: bool = False

    def system(self) -> System:
        """Make the system; FMUs that are not there yet are built.

        Raises
        ------
        OrchestrationError
            If there is no such system, or it cannot be changed as asked.
        """
        if self.mapping and self.controller is None:
            msg = "--map says what --controller calls our variables; give one."
            raise SystemDescriptionError(msg)
        system = named_system(self.name, self.variant, reals=self.reals)
        if self.controller is not None:
            names: Mapping[str, str] = dict(map(setting_of("--map"), self.mapping))
            system = system.replace("controller", named_fmu(self.controller, reals=self.reals), names)
        system = system.set(dict(start_value(text, system) for text in self.settings))
        return system if self.sample_time is None else system.with_sample_time(self.sample_time)


def is_package(name: str) -> bool:
    """Whether a name is that of a package, an .ssd file or a folder; a scenario goes before a folder of its name."""
    from orchestration.paper.scenarios import ALL_SCENARIOS

    if Path(name).suffix.lower() in (PACKAGE, DEFINITION):
        return True
    return Path(name).is_dir() and name not in ALL_SCENARIOS


def named_system(name: str, variant: str | None = None, *, reals: bool = False) -> System:
    """The system of a file or folder, or a scenario by name."""
    path = Path(name)
    if reals and (is_package(name) or path.suffix):
        msg = f"--reals: {name} has FMUs of its own, and --reals is for scenarios such as fig5; leave the option out."
        raise SystemDescriptionError(msg)
    if is_package(name):
        return System.read(path, variant)
    if variant is not None:
        msg = f"--variant {variant}: only a package has variants, and {name} is none."
        raise SystemDescriptionError(msg)
    if path.suffix.lower() == FMU:
        component = path.stem.replace(".", "_")
        system = System.of({component: path}, component)
        own = system[component].description.experiment  # it stands alone, so its own experiment is the run's
        return replace(system, step=own.step, stop_time=own.stop_time, start_time=own.start_time or 0.0)
    if path.suffix:
        kinds = "an .ssp, .ssd or .fmu file, or from a folder"
        msg = f"{path}: a system is read from {kinds}; scenarios have names, such as adaptimp run fig5."
        raise SystemDescriptionError(msg)
    from orchestration.paper.ready import scenario

    return scenario(name, reals=reals)


def named_fmu(name: str, *, reals: bool = False) -> Path:
    """The FMU of a file, or a shipped one by its model identifier."""
    from fmus.catalog import MODELS, VARIANTS
    from orchestration.paper.built_fmus import built

    if Path(name).exists() or Path(name).name != name or Path(name).suffix:
        return Path(name)
    if name not in MODELS and name not in VARIANTS:
        msg = f"--controller: there is no model {name}; {suggestion(name, [*MODELS, *VARIANTS])}"
        raise SystemDescriptionError(msg)
    return built(name, reals=reals)
