"""Reference runs and parameter sets as files inside an FMU, in the form of the layered standard FMI-LS-REF.

The standard (a draft, version 1.0.0-alpha.1) asks for one manifest in ``extra/org.fmi-standard.fmi-ls-ref/``, which
says what each file is for. FMI 2.0 has such folders since release 2.0.2. What is in them is not a part of the FMU's
definition: FMI lets anyone add to them and remove from them. So the GUID does not depend on these files.

Runs are listed in a file of experiments, each with its table of inputs (called stimuli) and of results.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from lxml import etree

from adaptimp_fmu.description import number
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.model import Model
from adaptimp_fmu.parameter_set_file import parameter_set_file
from adaptimp_fmu.reference_tables import require_repeatable
from adaptimp_fmu.references import ReferenceRun
from adaptimp_fmu.variables import Type

STANDARD = "org.fmi-standard.fmi-ls-ref"
FOLDER = f"extra/{STANDARD}"
MANIFEST = "fmi-ls-manifest.xml"
VERSION = "1.0.0-alpha.1"
_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
_SENTENCE = "Layered Standard providing information on related files included in an FMU."  # the standard's own words
_CSV, _SSV, _EXPERIMENTS = "text/csv", "application/x-ssp-parameter-set", "application/x-ma-hs-experiments"


@dataclass(frozen=True)
class RelatedFile:
    """A file in the folder of the layered standard, and what its manifest says of the file.

    Attributes
    ----------
    role
        One of the standard's words, such as ``result``.
    type
        MIME type.
    labels
        Names by which a tool can choose files.
    """

    name: str
    role: str
    type: str
    description: str
    content: bytes
    labels: Sequence[str] = ()


def related_files(model: Model) -> list[RelatedFile]:
    """Return the files of a model's reference runs and parameter sets; none if the model has neither.

    Raises
    ------
    DefinitionError
        If a run or a set does not fit the model, or if two of them have one name.
    """
    named = [*model.reference_runs, *model.parameter_sets]
    taken: set[str] = set()
    for one in named:
        if one.name.casefold() in taken:
            msg = f"{model.name} has two reference runs or parameter sets {one.name}; give one another name."
            raise DefinitionError(msg)
        taken.add(one.name.casefold())
    files = []
    if model.reference_runs:
        about = f"Runs that show whether a tool simulates {model.name} correctly"
        content = _experiments(model)
        files.append(RelatedFile(f"{model.name}.exp", "experiment/smoke-test", _EXPERIMENTS, about, content))
    for run in model.reference_runs:
        require_repeatable(model, run)
        if run.inputs:
            about = f"Inputs of the run {run.name}"
            files.append(RelatedFile(_inputs(run), "testcase", _CSV, about, run.inputs))
        files.append(RelatedFile(_results(run), "result", _CSV, f"Outputs of the run {run.name}", run.results))
    for given in model.parameter_sets:
        content = parameter_set_file(model, given)
        labels = [f"variant:{variant}" for variant in given.variants or [given.name]]
        about = given.description or f"Parameters of {model.name} for {given.name}"
        files.append(RelatedFile(f"{given.name}.ssv", "parameter", _SSV, about, content, labels))
    return files


def archive_entries(files: Sequence[RelatedFile]) -> Mapping[str, bytes]:
    """Return the entries of the FMU's archive by name: the manifest, then the files; none without files."""
    if not files:
        return {}
    return {f"{FOLDER}/{MANIFEST}": _manifest(files)} | {f"{FOLDER}/{file.name}": file.content for file in files}


def _inputs(run: ReferenceRun) -> str:
    return f"{run.name}_in.csv"


def _results(run: ReferenceRun) -> str:
    return f"{run.name}_ref.csv"


def _experiments(model: Model) -> bytes:
    """The file that lists the runs."""
    root = etree.Element("Experiments", name=model.name, description=f"Runs of {model.name} alone")
    for run in model.reference_runs:
        stated = run.experiment.stated()
        element = etree.SubElement(root, "Experiment", name=run.name)
        if run.description:
            element.set("description", run.description)
        names = {"start_time": "startTime", "stop_time": "stopTime", "tolerance": "tolerance", "step_size": "stepSize"}
        for ours, theirs in names.items():
            element.set(theirs, number(stated[ours], Type.REAL))
        if run.inputs:
            etree.SubElement(element, "Stimuli", type=_CSV, source=_inputs(run))
        etree.SubElement(element, "References", type=_CSV, source=_results(run))
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def _manifest(files: Sequence[RelatedFile]) -> bytes:
    """The file that says what each file is for."""
    about = {"name": STANDARD, "version": VERSION, "description": _SENTENCE}
    attributes = {f"{{{_NAMESPACE}}}fmi-ls-{name}": text for name, text in about.items()}
    root = etree.Element("fmiReferences", attributes, {"fmi-ls": _NAMESPACE})
    for file in files:
        element = etree.SubElement(
            root, "Related", type=file.type, source=file.name, role=file.role, description=file.description
        )
        for label in file.labels:
            etree.SubElement(element, "Label", name=label)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)
