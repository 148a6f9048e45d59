"""Tests of packages in the style of other tools: annotations, faults of form, SSP 2.0, other versions of FMI."""

import re
import zipfile
from pathlib import Path

import pytest

from orchestration import ArchiveError, System, SystemDescriptionError
from tests.unit.orchestration.foreign import binding, component, connection, connector, foreign, real, system_xml
from tests.unit.orchestration.packages import SSD_FILE, edited, substitute

pytestmark = pytest.mark.usefixtures("own_cache")
TOP = system_xml(
    "top",
    component("a", "Decay", binding(real("z_start", 4.0)), connector("y", "output", "m")) + component("b", "Decay"),
    connection("a.y", "b.u"),
)
OMS = 'xmlns:oms="https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"'
MASTER = f'<oms:FixedStepMaster {OMS} description="oms-ma" stepSize="0.100000" relativeTolerance="0.0001"/>'
SOLVER = f'<oms:VariableStepSolver {OMS} description="cvode" maximumStepSize="0.1"/>'
SIMULATION = "<oms:SimulationInformation {oms}>{inner}</oms:SimulationInformation>"
OSP = (
    '<osp:Algorithm xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations">'
    '<osp:FixedStepAlgorithm {size}="5e-2"/></osp:Algorithm>'
)


def annotations(kind: str, inner: str, prefix: str = "ssc") -> str:
    """Annotations with one of a type."""
    annotation = f'<{prefix}:Annotation type="{kind}">{inner}</{prefix}:Annotation>'
    return f"<ssd:Annotations>{annotation}</ssd:Annotations>"


def at_system(inner: str, prefix: str = "ssc") -> str:
    """The system with an annotation of OMSimulator."""
    text = SIMULATION.format(oms=OMS, inner=inner)
    return TOP.replace("</ssd:System>", f"{annotations('org.openmodelica', text, prefix)}</ssd:System>")


def with_experiment(package: Path, experiment: str) -> Path:
    """The package with a default experiment."""
    return edited(package, SSD_FILE, substitute("</ssd:Units>", f"</ssd:Units>{experiment}"))


def second(package: Path, kind: str = "2.0") -> Path:
    """The package as SSP 2.0, with the types of FMI 3."""

    def edit(text: str) -> str:
        text = text.replace('version="1.0" name="theirs"', f'version="{kind}" name="theirs"')
        return text.replace("ssc:Real", "ssc:Float64").replace("ssv:Real", "ssv:Float64")

    return edited(package, SSD_FILE, edit)


@pytest.fixture
def plain(tmp_path: Path, strange: dict[str, Path]) -> Path:
    """A package of two components."""
    return foreign(tmp_path / "theirs.ssp", TOP, strange)


def test_the_step_of_omsimulator_is_taken_and_said(tmp_path: Path, strange: dict[str, Path]) -> None:
    wrapped = f"<oms:Annotations {OMS}>{MASTER}</oms:Annotations>"
    for inner in (MASTER, wrapped):
        system = System.read(foreign(tmp_path / "oms.ssp", at_system(inner), strange))
        assert system.step == 0.1
        assert system.notices == ("The step of 0.1 s comes from OMSimulator's annotation of the package.",)


def test_a_solver_of_omsimulator_is_said(tmp_path: Path, strange: dict[str, Path]) -> None:
    system = System.read(foreign(tmp_path / "oms.ssp", at_system(SOLVER), strange))
    assert system.step is None
    assert system.notices == ("OMSimulator's annotation asks for steps of variable length; give a step, or adaptive.",)


@pytest.mark.parametrize("attribute", ["baseStepSize", "stepSize"])
def test_the_step_of_osp_is_taken_and_said(plain: Path, attribute: str) -> None:
    noted = annotations("com.opensimulationplatform", OSP.format(size=attribute))
    experiment = f'<ssd:DefaultExperiment startTime="0.5" stopTime="2">{noted}</ssd:DefaultExperiment>'
    system = System.read(with_experiment(plain, experiment))
    assert (system.step, system.start_time, system.stop_time) == (0.05, 0.5, 2.0)
    assert system.notices == ("The step of 0.05 s comes from OSP's annotation of the package.",)


def test_a_step_that_is_no_number_is_refused(tmp_path: Path, strange: dict[str, Path]) -> None:
    wrong = at_system(MASTER.replace("0.100000", "fast"))
    with pytest.raises(ArchiveError, match=r"annotation org\.openmodelica has the step 'fast', which is not a number"):
        System.read(foreign(tmp_path / "oms.ssp", wrong, strange))


def test_faults_of_form_are_told_and_read_over(tmp_path: Path, strange: dict[str, Path], plain: Path) -> None:
    odd = at_system(MASTER, prefix="ssd").replace('name="b" source="resources/Decay.fmu">', "\\g<0><ssd:Connectors/>")
    odd = odd.replace("\\g<0>", 'name="b" source="resources/Decay.fmu">')
    notes = re.search("<ssd:Annotations>.*</ssd:Annotations>", odd)
    assert notes
    odd = odd.replace(notes[0], "").replace('<ssd:System name="top">', f'<ssd:System name="top">{notes[0]}')
    system = System.read(foreign(tmp_path / "oms.ssp", odd, strange))
    assert (system.step, system.connections) == (0.1, System.read(plain).connections)
    rules = "annotations in a wrong namespace and elements in another order and empty lists"
    assert system.notices[0].endswith(
        f"oms.ssp: SystemStructure.ssd breaks a rule of SSP that no reader needs: it has {rules}."
    )


def test_ssp_2_means_the_same_where_fmi_2_does(plain: Path) -> None:
    old, new = System.read(plain), System.read(second(plain))
    assert (new.connections, new["a"].start, new.notices) == (old.connections, {"z_start": 4.0}, ())


METADATA = '<ssd:MetaData kind="general" type="text/plain" source="x.txt"/>'


@pytest.mark.parametrize(
    ("pattern", "replacement", "words"),
    [
        ("<ssc:Real", "<ssc:Float32", "y is of type Float32"),
        (r'(<ssc:Real unit="m"/>)', r'\1<ssc:Dimension size="3"/>', "y is an array"),
        ('kind="output"', 'kind="structuralParameter"', "y is a structural parameter"),
        (r"<ssc:Real[^>]*>", "<ssc:Clock/>", "y has a clock"),
        ('startConnector="y"', 'startConnector="y" startIndices="1"', "top is an array"),
        ('Component name="a"', 'Component name="a" implementation="ScheduledExecution"', "a is to be run by scheduled"),
    ],
)
def test_ssp_2_with_more_than_fmi_2_is_refused(plain: Path, pattern: str, replacement: str, words: str) -> None:
    package = edited(plain, SSD_FILE, substitute(pattern, replacement)).rename(plain.with_name("more.ssp"))
    with pytest.raises(SystemDescriptionError, match=rf"{words}.*, which FMI 2\.0 does not have"):
        System.read(second(package))


def test_what_ssp_2_adds_beside_the_system_is_left_out(plain: Path) -> None:
    package = edited(plain, SSD_FILE, substitute("</ssd:Units>", f"</ssd:Units>{METADATA}"))
    package = package.rename(plain.with_name("more.ssp"))
    assert System.read(second(package)).connections == System.read(plain).connections
    with pytest.raises(ArchiveError, match=r"SystemStructure\.ssd is invalid"):
        System.read(second(package, "3.0"))


@pytest.mark.parametrize(
    ("version", "kind", "words"),
    [
        ("1.0", "<Implementation/>", r"FMI 1\.0 FMU for co-simulation"),
        ("1.0", "", r"FMI 1\.0 FMU for model exchange"),
        ("3.0", '<CoSimulation modelIdentifier="a"/>', r"FMI 3\.0 FMU for co-simulation"),
        ("3.0.2", '<ScheduledExecution modelIdentifier="a"/>', r"FMI 3\.0\.2 FMU for scheduled execution"),
        ("3.0-beta.2", '<ModelExchange modelIdentifier="a"/>', r"FMI 3\.0-beta\.2 FMU for model exchange"),
    ],
)
def test_other_versions_of_fmi_are_blamed_within_packages(
    tmp_path: Path, strange: dict[str, Path], version: str, kind: str, words: str
) -> None:
    other = tmp_path / "other.fmu"
    with zipfile.ZipFile(other, "w") as archive:
        xml = f'<fmiModelDescription fmiVersion="{version}" modelName="a" guid="0">{kind}</fmiModelDescription>'
        archive.writestr("modelDescription.xml", xml)
    package = foreign(tmp_path / "theirs.ssp", TOP, {**strange, "Decay": other})
    where = r"theirs\.ssp: component a \(resources/Decay\.fmu\) is an "
    with pytest.raises(
        ArchiveError, match=rf"{where}{words}; one of FMI 2\.0 for co-simulation is needed\."
    ) as refused:
        System.read(package)
    assert "cache" not in str(refused.value)
