"""The provenance of a result differs if the runs differ, and holds neither places nor times nor people."""

import getpass
import hashlib
import json
import platform
import shutil
from dataclasses import replace
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

from orchestration import ArchiveError, Component, Result, System, SystemDescriptionError
from orchestration.fmi.description import read_description
from orchestration.master import provenance as module
from orchestration.master.provenance import provenance
from tests.unit.orchestration.small_models import H, chain, mixed

RUN: dict[str, Any] = {"algorithm": "jacobi", "step": H, "start_time": 0.0, "stop_time": 2, "order": None}


def test_it_says_what_was_run(small: dict[str, Path]) -> None:
    system = mixed(small).set({"relay.even": True})
    found = provenance(system, **RUN)
    assert all(isinstance(text, str) for text in found.values())
    assert found["system"] == "small"
    assert [found[key] for key in ("algorithm", "step", "start_time", "stop_time")] == ["jacobi", "0.125", "0.0", "2.0"]
    relay = json.loads(found["components"])[1]
    assert relay == {
        "name": "relay",
        "file": "Relay.fmu",
        "model": "Relay",
        "identifier": "Relay",
        "guid": fmpy.read_model_description(str(small["Relay"])).guid,
        "sha256": hashlib.sha256(small["Relay"].read_bytes()).hexdigest(),
    }
    assert json.loads(found["start"]) == {"plant": {"x_start": 1.0}, "relay": {"even": 1.0}}
    assert json.loads(found["connections"])[0] == "plant.x -> relay.u"
    assert len(json.loads(found["connections"])) == 6
    assert json.loads(found["order"]) == ["source", "relay", "switch", "plant"]
    versions = json.loads(found["versions"])
    assert list(versions) == ["adaptimp", "fmpy", "numpy", "numba", "python", "platform"]
    assert versions["fmpy"] == fmpy.__version__
    assert versions["python"] == platform.python_version()


def test_numbers_are_kept_exactly(small: dict[str, Path]) -> None:
    system = mixed(small).set({"relay.offset": 0.1 + 0.2, "plant.x_start": float("inf")})
    found = provenance(system, **{**RUN, "step": 1 / 3})
    assert json.loads(found["start"]) == {"plant": {"x_start": "inf"}, "relay": {"offset": 0.1 + 0.2}}
    assert float(found["step"]) == 1 / 3


def test_seeds_are_those_in_force(fig2: System) -> None:
    assert json.loads(provenance(fig2.set({"sensor.seed": 7}), **RUN)["seeds"]) == {"sensor.seed": 7}
    bare = replace(fig2, components=tuple(replace(c, start={}) for c in fig2.components))
    start = fig2.component("sensor").description.variables["seed"].start
    assert json.loads(provenance(bare, **RUN)["seeds"]) == {"sensor.seed": start}


def test_an_order_of_its_own_is_told(small: dict[str, Path]) -> None:
    order = ["plant", "switch", "relay", "source"]
    assert json.loads(provenance(mixed(small), **{**RUN, "order": order})["order"]) == order
    with pytest.raises(SystemDescriptionError, match="must name each of"):
        provenance(mixed(small), **{**RUN, "order": order[:3]})


def test_every_difference_shows(small: dict[str, Path], tmp_path: Path) -> None:
    system = chain(small, 1)
    changed_fmu = Path(shutil.copy(small["Relay"], tmp_path / "Relay.fmu"))
    with changed_fmu.open("ab") as file:
        file.write(b"\0")  # read as before, but not the same file
    relay = Component("relay1", read_description(changed_fmu))
    variants = [
        (system, RUN, None),
        (replace(system, name="other"), RUN, "system"),
        (system.set({"relay1.offset": 1.0}), RUN, "start"),
        (replace(system, connections=system.connections[:2]), RUN, "connections"),
        (replace(system, components=(system.components[0], relay)), RUN, "components"),
        (system, {**RUN, "order": ["relay1", "source"]}, "order"),
        *((system, {**RUN, key: value}, key) for key, value in [("algorithm", "x"), ("step", 1.0), ("stop_time", 3.0)]),
    ]
    base = provenance(system, **RUN)
    for variant, run, differing in variants:
        found = provenance(variant, **run)
        assert [key for key in base if found[key] != base[key]] == ([differing] if differing else [])


def test_it_is_the_same_from_another_folder_and_order_of_settings(small: dict[str, Path], tmp_path: Path) -> None:
    copies = {name: Path(shutil.copy(path, tmp_path / path.name)) for name, path in small.items()}
    settings = {"relay.offset": 1.0, "relay.n": 3}
    here = mixed(small).set(settings)
    there = mixed(copies).set(dict(reversed(settings.items())))
    assert provenance(here, **RUN) == provenance(there, **RUN)
    texts = " ".join(provenance(there, **RUN).values())
    for private in (str(tmp_path), str(Path.home()), platform.node(), f"/{getpass.getuser()}"):
        assert private not in texts


def test_a_run_without_an_installed_package(small: dict[str, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    def version(package: str) -> str:
        if package == "adaptimp":
            raise PackageNotFoundError(package)
        return "1.2"

    monkeypatch.setattr(module, "version", version)
    versions = json.loads(provenance(mixed(small), **RUN)["versions"])
    assert (versions["adaptimp"], versions["numba"]) == ("not installed", "1.2")


def test_an_fmu_that_is_gone_is_an_error(small: dict[str, Path], tmp_path: Path) -> None:
    copies = {name: Path(shutil.copy(path, tmp_path / path.name)) for name, path in small.items()}
    system = mixed(copies)
    copies["Switch"].unlink()
    with pytest.raises(ArchiveError, match=r"^switch: Switch\.fmu cannot be read: No such file or directory\.$"):
        provenance(system, **RUN)


def test_it_comes_back_from_a_file(small: dict[str, Path], tmp_path: Path) -> None:
    system = mixed(small)
    result = Result(np.zeros(1), (), np.zeros((1, 0)), metadata=provenance(system, **RUN))
    result.write(tmp_path / "x.parquet")
    assert Result.read(tmp_path / "x.parquet").metadata == provenance(system, **RUN)
