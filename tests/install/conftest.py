"""The wheel of this checkout, and an environment in which only the wheel and its core are installed."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from tests.sharing import made_once

ROOT = Path(__file__).parents[2]
Adaptimp = Callable[..., subprocess.CompletedProcess[str]]


def uv(*arguments: str | Path) -> None:
    """Run uv without the network: all packages are in its cache since it has installed this checkout."""
    tool = os.environ.get("UV") or shutil.which("uv")
    if tool is None:
        pytest.skip("uv, which builds the wheel, is not on the search path")
    done = subprocess.run([tool, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from the checkout."""

    def build(folder: Path) -> None:
        uv("build", "--offline", "--quiet", "--wheel", "--out-dir", folder)

    (path,) = made_once(tmp_path_factory, "wheel", build).glob("*.whl")
    return path


@pytest.fixture(scope="session")
def wheel_of_sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from the sdist of the checkout."""
    folder = tmp_path_factory.mktemp("sdist")
    uv("build", "--offline", "--quiet", "--out-dir", folder)
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="session")
def core(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of an environment with the wheel and what its core needs."""
    folder = tmp_path_factory.mktemp("core") / "environment"
    uv("venv", "--offline", "--quiet", "--python", sys.executable, folder)
    uv("pip", "install", "--offline", "--quiet", "--python", folder, wheel)
    return folder


def program(environment: Path, name: str) -> Path:
    """Path of a program in an environment."""
    return environment / ("Scripts" if os.name == "nt" else "bin") / name


@pytest.fixture
def adaptimp(core: Path, tmp_path: Path) -> Adaptimp:
    """Runs ``adaptimp`` of the environment in an empty folder."""

    def run(*arguments: str | Path, fails: Sequence[str] = ()) -> subprocess.CompletedProcess[str]:
        command = [program(core, "adaptimp"), *arguments]
        environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL"))}
        environment["COLUMNS"] = "400"  # no line of a list is folded
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert (done.returncode == 2) if fails else (done.returncode == 0), done.stderr
        for words in fails:
            assert words in done.stderr
        assert "Traceback" not in done.stderr
        return done

    return run
