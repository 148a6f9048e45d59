"""The pages in the FMUs of an arm in space: their programs run with FMPy alone, and every parameter has its cell."""

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from scipy.spatial.transform import Rotation

from adaptimp_fmu import build
from adaptimp_fmu.documentation import documentation
from fmus.catalog import model, unit_of_arm
from orchestration.paper.built_fmus import fmus
from tests.conformance.test_documentation import Page
from tests.property.spatial_robots import robot

LOOP = ("VirtualTrajectory", "ForceSensor", "HoganImpedance", "Actuator", "Plant")
NUMBER = re.compile(r"-?\d+\.?\d*")
COLUMNS = ("p1 m", "p2 m", "p3 m", "roll rad", "pitch rad", "yaw rad", "a1", "a2", "a3")
ADAPTIVE = "SlotineLiAdaptiveImpedancePuma560"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMUs of the loop side by side, as a user has them."""
    place = tmp_path_factory.mktemp("puma")
    for name, path in fmus(f"{unit}Puma560" for unit in LOOP).items():
        (place / f"{name}.fmu").symlink_to(path)
    return place


@pytest.fixture(scope="module")
def programs(folder: Path) -> dict[str, str]:
    """Programs of the plant's page, by heading."""
    return programs_of(folder / "PlantPuma560.fmu")


def programs_of(fmu: Path) -> dict[str, str]:
    """Programs of the page in an FMU, by heading, as a reader copies them."""
    with zipfile.ZipFile(fmu) as archive:
        root = etree.fromstring(archive.read("documentation/index.html"))
    found, heading = {}, ""
    for element in root.iter("{*}h3", "{*}pre"):
        text = element.xpath("string()")
        if etree.QName(element).localname == "h3":
            heading = text
        elif "import" in text and "fmpy" in text:
            found[heading] = text
    return found


def cells_of(page: bytes) -> dict[str, str]:
    """Texts of the cells of all tables with names on both sides, by row and column."""
    found = {}
    for table in etree.fromstring(page).iterfind(".//{*}table[@class='grid']"):
        heads = [head.xpath("string()").strip() for head in table.iterfind("{*}thead/{*}tr/{*}th")]
        for row in table.iterfind("{*}tbody/{*}tr"):
            name, *cells = (cell.xpath("string()").strip() for cell in row)
            found.update(dict(zip([f"{name}: {head}" for head in heads], cells, strict=True)))
    return found


def said(program: str, folder: Path) -> list[str]:
    """Lines that a program prints in a folder that has the FMUs and nothing of this project."""
    done = subprocess.run(
        [sys.executable, "-I", "-c", program], cwd=folder, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr
    assert "adaptimp" not in program
    return done.stdout.splitlines()


def test_arm_is_held_and_falls(programs: dict[str, str], folder: Path) -> None:
    """The torques have four digits, so 1 mm in 0.2 s is far more than a held arm moves; a free fall is 196 mm."""
    held, let_go = (
        [float(number) for number in NUMBER.findall(line)]
        for line in said(programs["A first run: hold the arm, and let it go"], folder)
    )
    assert len(held) == len(let_go) == 3
    assert max(map(abs, held)) < 1
    assert -196 < let_go[2] < -20


def test_own_controller_presses_on_the_wall(programs: dict[str, str], folder: Path) -> None:
    """20 N, less what the springs of the joints take of the depth of some 0.2 mm: 400/s2 times some 10 kg is 1 N."""
    (line,) = said(programs["A controller of your own: press on the wall"], folder)
    *force, depth = map(float, NUMBER.findall(line))
    assert force[:2] == [0, 0]
    assert -20 < force[2] < -18
    assert depth == pytest.approx(-force[2] / 1e5 * 1e3, abs=1e-3)


def test_whole_loop_runs(programs: dict[str, str], folder: Path) -> None:
    (line,) = said(programs["The whole loop"], folder)
    error, force = map(float, NUMBER.findall(line))
    assert 0 < error < 2
    assert 20 < force < 200


def test_programs_fit_an_arm_of_seven_joints(tmp_path: Path) -> None:
    """Light wrists without rotors: gains in proportion to the inertias stay stable with steps of 1 ms."""
    fmu = build(unit_of_arm("Plant", robot("Panda"), "Panda"), tmp_path)
    first, own, _ = programs_of(fmu).values()
    held, let_go = ([float(number) for number in NUMBER.findall(line)] for line in said(first, tmp_path))
    assert max(map(abs, held)) < 1
    assert max(map(abs, let_go)) > 20
    *force, _ = map(float, NUMBER.findall(said(own, tmp_path)[0]))
    assert force[:2] == [0, 0]
    assert -20 < force[2] < -18


@pytest.mark.parametrize("name", ["PlantPuma560", ADAPTIVE])
def test_page_has_a_cell_for_each_element(name: str) -> None:
    declared = model(name)
    page = Page(documentation(declared)["index.html"].decode())
    names = {variable.name for variable in declared.variables if variable.role.name != "STATE"}
    assert {text for text in page.texts["code"] if text in names} == {
        name for name in names if not name.startswith(("der(", "time"))
    }


def test_cells_stand_by_body(folder: Path) -> None:
    """p[11] is the mass of link 2, 17.4 kg; p[75] the inertia of the rotor of joint 3."""
    with zipfile.ZipFile(folder / "PlantPuma560.fmu") as archive:
        found = cells_of(archive.read("documentation/index.html"))
    found = {place: text for place, text in found.items() if text.startswith("p[")}
    assert found["body link2: m kg"] == "p[11] 17.4"
    assert found["joint 3: rotor inertia kg.m2"].startswith("p[75] 0.8624")
    assert len(found) == 78


@pytest.mark.parametrize("name", ["PUMA", "UR5", "Panda"])
def test_page_tells_where_the_joints_are(name: str) -> None:
    """Who has the page alone finds the tip by it: ten digits in each of up to nine frames of less than 2 m."""
    arm = robot(name)
    found = cells_of(documentation(unit_of_arm("Plant", arm, "Arm"))["index.html"])
    names = dict.fromkeys(place.partition(": ")[0] for place in found if ": roll rad" in place)
    q = np.random.default_rng(7).uniform(-3, 3, arm.n)
    R, p = np.eye(3), np.zeros(3)
    for row, angle in zip(names, [*q, 0.0], strict=True):
        number = {head: float(found[f"{row}: {head}"] or 0) for head in COLUMNS}
        p = p + R @ [number["p1 m"], number["p2 m"], number["p3 m"]]
        turned = Rotation.from_euler("xyz", [number["roll rad"], number["pitch rad"], number["yaw rad"]])
        axis = np.array([number["a1"], number["a2"], number["a3"]])
        R = R @ turned.as_matrix() @ Rotation.from_rotvec(angle * axis).as_matrix()
    assert list(names)[-1] == "tip"
    for ours, true in zip((R, p), arm.arm.tip_frame(q), strict=True):
        np.testing.assert_allclose(ours, np.array(true).reshape(ours.shape), rtol=0, atol=1e-8)
