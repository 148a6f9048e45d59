"""The paper's scenarios as systems that are ready to run."""

from pathlib import Path

from orchestration.paper.built_fmus import built, find_scenario, fmus
from orchestration.system.system import System


def scenario(name: str, *, controller: str | Path | None = None, reals: bool = False) -> System:
    """A scenario of the paper as a system; its FMUs are built when they are not there yet.

    Parameters
    ----------
    name
        ``fig2`` to ``fig7``, ``ideal`` or ``spong-ortega``; ``fig5-first`` and so on at the earlier calibration; or
        another one of `orchestration.paper.scenarios.ALL_SCENARIOS`, such as ``sensor-dropout`` or ``puma``.
    controller
        Another controller: the path of an FMU, or the model identifier of a shipped one such as
        ``SlotineLiAdaptiveImpedance``. Default: that of the scenario.
    reals
        Whether the shipped FMUs have Reals in the place of Booleans and Integers, as `adaptimp_fmu.build` makes them
        for tools that know Reals only.

    Raises
    ------
    UnknownNameError
        If there is no such scenario.
    OrchestrationError
        If an FMU cannot be built or read.

    Examples
    --------
    >>> from orchestration import scenario
    >>> system = scenario("fig2", controller="SlotineLiAdaptiveImpedance")
    >>> system["controller"].description.model_name, system.stop_time
    ('SlotineLiAdaptiveImpedance', 2.0)
    >>> scenario("fig2", reals=True)["actuator"].variable("saturated[1]").type
    'Real'
    """
    from fmus.catalog import MODELS, VARIANTS

    found = find_scenario(name)
    system = found.system(fmus(found.models.values(), reals=reals))
    if controller is None:
        return system
    own = str(controller) in MODELS or str(controller) in VARIANTS
    return system.replace("controller", built(str(controller), reals=reals) if own else controller)
