"""Tests of the replacement of an FMU by an FMU with other names and other units of its variables.

The models `Stranger` and `Ours` have the same equations and different names of variables. The unit of the variables
of `FineStranger` is 2**-10 m. All conversions are exact.
"""

import re
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import Connection, Options, System, SystemDescriptionError, simulate
from tests.unit.orchestration.packages import same
from tests.unit.orchestration.small_models import H, system

MAPPING = {"tau_cmd": "Torque", "x": "Position", "offset": "Gain"}
FINE = 2.0**10  # fine units in a metre
LINES = """
a.y -> controller.x[1]
b.y -> controller.x[2]
controller.tau_cmd[1] -> a.u
controller.tau_cmd[2] -> b.u
"""


@pytest.fixture
def arm(strange: dict[str, Path]) -> System:
    """System of a controller and two decaying components."""
    units = {"controller": "Ours", "a": "Decay", "b": "Decay"}
    assumed = {"controller.offset": "nothing is known of it", "a.z_start": "as b"}
    return replace(system(strange, units, LINES).set({"controller.offset": 0.5, "b.z_start": 2}), assumptions=assumed)


def test_names_follow(strange: dict[str, Path], arm: System) -> None:
    changed = arm.replace("controller", strange["Stranger"], MAPPING)
    assert (changed.connections, changed.notices) == (arm.connections, ())
    assert changed.assumptions == arm.assumptions
    assert changed.component("controller").start == {"offset": 0.5}
    names = ("controller.tau_cmd[2]", "a.y")
    before, after = (simulate(s, 2.0, H, options=Options(record=names)) for s in (arm, changed))
    assert after.names == names
    np.testing.assert_array_equal(after.rows, before.rows)
    assert np.ptp(after["a.y"]) > 1  # m


def test_units_follow_too(strange: dict[str, Path], arm: System) -> None:
    changed = arm.replace("controller", strange["FineStranger"], MAPPING)
    assert changed.component("controller").start == {"offset": 512.0}
    assert {c.factor for c in changed.connections if c.target == "controller"} == {FINE}
    before, after = simulate(arm, 2.0, H), simulate(changed, 2.0, H)
    np.testing.assert_array_equal(after["b.y"], before["b.y"])
    np.testing.assert_array_equal(after["controller.tau_cmd[1]"], FINE * before["controller.tau_cmd[1]"])
    assert changed.replace("controller", strange["Ours"]) == arm


def test_a_scale_of_the_users_own_is_kept_between_the_old_units(strange: dict[str, Path], arm: System) -> None:
    own = Connection("controller", "tau_cmd[1]", "a", "u", 3.0, 1.0)
    arm = replace(arm, connections=(*(c for c in arm.connections if c.target != "a"), own))
    changed = arm.replace("controller", strange["FineStranger"], MAPPING)
    assert changed.connections[-1] == replace(own, factor=3 / FINE)
    np.testing.assert_array_equal(simulate(changed, 1.0, H)["a.y"], simulate(arm, 1.0, H)["a.y"])


def test_a_mapped_component_survives_a_package(strange: dict[str, Path], arm: System, tmp_path: Path) -> None:
    changed = arm.replace("controller", strange["FineStranger"], MAPPING)
    read = System.read(changed.write(tmp_path / "mapped.ssp"))
    assert same(read, changed)
    with zipfile.ZipFile(tmp_path / "mapped.ssp") as archive:  # other tools know only the names in the FMU
        text = archive.read("SystemStructure.ssd").decode()
        assert 'name="Gain"' in archive.read("resources/controller.ssv").decode()
    assert re.search(r'<ssd:Connector name="Torque\[1\]" kind="output">.*startConnector="Torque\[1\]"', text, re.DOTALL)
    assert '="tau_cmd' not in text.replace('item variable="tau_cmd', "").replace('endConnector="tau_cmd', "")
    assert read.write(tmp_path / "again.ssp").read_bytes() == (tmp_path / "mapped.ssp").read_bytes()


def test_single_elements_can_be_mapped(strange: dict[str, Path], arm: System) -> None:
    turned = {"tau_cmd[1]": "Torque[2]", "tau_cmd[2]": "Torque[1]", "x[1]": "Position[2]", "x[2]": "Position[1]"}
    changed = arm.replace("controller", strange["Stranger"], {**turned, "offset": "Gain"})
    before, after = simulate(arm, 1.0, H), simulate(changed, 1.0, H)
    for name in before.names:  # the loop at the start is solved to 1e-12, with its equations in another order
        np.testing.assert_allclose(after[name], before[name], rtol=1e-10)
    known = changed.component("controller").description.variables
    assert known["x[1]"].fmu_name == "Position[2]"


def test_optional_inputs_are_dropped_and_told(strange: dict[str, Path], arm: System) -> None:
    changed = arm.replace("controller", strange["Stranger"], {"tau_cmd": "Torque", "x[1]": "Position[1]"})
    assert changed.notices == (
        "controller: start values dropped, Stranger has no offset.",
        "controller: connections dropped, Stranger has no input x[2].",
    )
    assert changed.unconnected_inputs() == ["controller.Position[2]"]
    assert changed.assumptions == {"a.z_start": "as b"}


def test_a_further_input_is_connected_by_the_name_it_is_mapped_to(strange: dict[str, Path]) -> None:
    lone = system(strange, {"controller": "Ours", "a": "Decay"})
    changed = lone.replace("controller", strange["Stranger"], {"y": "Position[1]"})
    assert [str(c) for c in changed.connections] == ["a.y -> controller.y"]
    assert changed.notices == ("Connection a.y -> controller.y added: Stranger has this input too.",)


@pytest.mark.parametrize(
    ("mapping", "message"),
    [
        (
            {"x": "Position"},
            r"^Stranger\.fmu cannot be controller: it has no output tau_cmd, which a reads, but",
        ),
        ({"tau": "Torque"}, r"Mapping tau=Torque: controller has no variable tau; did you mean tau_cmd\?"),
        (
            {"tau_cmd": "T"},
            r"Mapping tau_cmd=T: Stranger has no variable T\[1\]; there are sample_time, Gain, Position, Torque\.",
        ),
        ({"tau_cmd": "Torque", "x": "Torque"}, r"Mapping x=Torque: Torque\[1\] is already mapped to tau_cmd\[1\]"),
        ({"tau_cmd": "Position"}, r"tau_cmd\[1\] has causality input, not output"),
        ({"tau_cmd": "Torque", "x[1]": "Gain"}, r"a\.y -> controller\.x\[1\].*: x\[1\] has causality parameter, not"),
        ({"offset": "sample_time", "tau_cmd": "Torque"}, r"controller\.offset = 0\.5: units m and s differ; map it"),
        (
            {"tau_cmd": "Torque", "sample_time": "Gain"},
            r"Gain and sample_time would both|sample_time and Gain would both",
        ),
    ],
)
def test_mappings_that_do_not_fit_are_refused(
    strange: dict[str, Path], arm: System, mapping: dict[str, str], message: str
) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        arm.replace("controller", strange["Stranger"], mapping)
