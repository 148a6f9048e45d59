"""Reads the default experiment of a package: start and stop time, and the step that some tool has noted for itself.

SSP 1.0 has no place for a communication step. Three tools keep it in annotations: this one, OMSimulator and the Open
Simulation Platform (OSP).
"""

from pathlib import Path
from typing import TypedDict

from lxml import etree

from orchestration.errors import ArchiveError
from orchestration.ssp.schema import SSC, STEP_ANNOTATION, Xml, ssd

OMSIMULATOR, OSP = "org.openmodelica", "com.opensimulationplatform"
"""Types of the annotations of both tools."""


class Experiment(TypedDict, total=False):
    """Arguments of a `System` that a package may give: step, start and stop time, s, and notices."""

    step: float
    start_time: float
    stop_time: float
    notices: tuple[str, ...]


def read_experiment(root: Xml, path: Path) -> Experiment:
    """Read the times of the default experiment, and the step of an annotation.

    Parameters
    ----------
    root
        Root element of the .ssd file.
    path
        Path of the package, for messages.

    Raises
    ------
    ArchiveError
        If the step of an annotation is not a number.
    """
    found: Experiment = {}
    experiment = root.find(ssd("DefaultExperiment"))
    if experiment is not None:
        if (stop_time := experiment.get("stopTime")) is not None:
            found["stop_time"] = float(stop_time)
        found["start_time"] = float(experiment.get("startTime") or 0)
    step = root.find(f".//{{{SSC}}}Annotation[@type='{STEP_ANNOTATION}']/step")
    if step is not None:
        found["step"] = _number(step.get("size"), f"{path}: the annotation {STEP_ANNOTATION} has the size")
        return found
    for tool, kind, names in (
        ("OMSimulator", OMSIMULATOR, ("FixedStepMaster",)),
        ("OSP", OSP, ("FixedStepAlgorithm",)),
    ):
        for text in _step_sizes(root, kind, names):
            found["step"] = _number(text, f"{path}: the annotation {kind} has the step")
            found["notices"] = (f"The step of {found['step']:g} s comes from {tool}'s annotation of the package.",)
            return found
    if _elements(root, OMSIMULATOR, ("VariableStepSolver",)):
        found["notices"] = ("OMSimulator's annotation asks for steps of variable length; give a step, or adaptive.",)
    return found


def _step_sizes(root: Xml, kind: str, names: tuple[str, ...]) -> list[str | None]:
    """Texts of the steps in annotations of a type, the outermost system's first."""
    found = []
    for element in _elements(root, kind, names):
        attributes = {str(name).lower(): str(value) for name, value in element.attrib.items()}
        found.append(attributes.get("basestepsize", attributes.get("stepsize")))
    return found


def _elements(root: Xml, kind: str, names: tuple[str, ...]) -> list[Xml]:
    """Elements of some local names in annotations of a type, at the outermost system, then at the experiment."""
    holders = [root.find(ssd("System/Annotations")), root.find(ssd("DefaultExperiment/Annotations"))]
    holders.append(root.find(ssd("Annotations")))
    return [
        element
        for holder in holders
        if holder is not None
        for annotation in holder.iterfind(f"{{{SSC}}}Annotation[@type='{kind}']")
        for element in annotation.iter()
        if isinstance(element.tag, str) and etree.QName(element).localname in names
    ]


def _number(text: str | None, what: str) -> float:
    try:
        return float(text or "")
    except ValueError as error:
        msg = f"{what} {text!r}, which is not a number."
        raise ArchiveError(msg) from error
