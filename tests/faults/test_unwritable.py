"""Evidence that everything works where neither the home nor the installation can be written to.

For the administrator permissions of folders count for nothing. So these tests give that privilege up, by setpriv.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.untested import needs

if sys.platform == "win32":
    pytest.skip("permissions of folders and the programs of POSIX are needed", allow_module_level=True)

ROOT = Path(__file__).parents[2]
HOURS = 3600.0  # s, far beyond what a command takes on a busy machine
WARNING = "Warning: Nothing can be written to the cache "
PICTURE = """
from orchestration import Result
Result.read("x.parquet").plot("plant.x")
import matplotlib.pyplot as plt
plt.savefig("x.png")
import matplotlib
print(matplotlib.get_configdir())
"""
MODEL = """from adaptimp_fmu import SampledModel
model = SampledModel("Gain", "Multiplies")
model.output("y", 2 * model.input("u", 1.0, description="In"), description="Out")
"""
Run = Callable[..., subprocess.CompletedProcess[str]]


def without_privilege() -> list[str]:
    """The beginning of a command for which permissions of folders count."""
    if os.geteuid() != 0:
        return []
    if shutil.which("setpriv") is None:
        pytest.skip(needs("setpriv is not installed", "util-linux"))
    return ["setpriv", "--bounding-set=-dac_override,-dac_read_search,-fowner"]


def with_installation_sealed() -> list[str]:
    """The beginning of a command that finds the project and the packages of Python on file systems for reading only."""
    places = dict.fromkeys([str(ROOT), sysconfig.get_path("purelib"), sysconfig.get_path("platlib")])
    seal = "".join(f"mount --bind '{p}' '{p}' && mount -o remount,bind,ro '{p}' && " for p in places)
    command = ["unshare", "--mount", "sh", "-c", seal + 'exec "$@"', "sh"]
    if (
        shutil.which("unshare") is None
        or subprocess.run([*command, "true"], capture_output=True, check=False).returncode
    ):
        pytest.skip("only an administrator can seal a folder")
    return command


@pytest.fixture
def home(tmp_path: Path):
    """A home in which nothing can be written."""
    home = tmp_path / "home"
    home.mkdir(mode=0o555)
    for name in ("temporary", "work"):
        (tmp_path / name).mkdir()
    (tmp_path / "work" / "Gain.py").write_text(MODEL, encoding="utf-8")
    yield home
    home.chmod(0o755)


def runner(home: Path, *before: str) -> Run:
    """A function that runs Python there with arguments, and demands that it succeeds."""
    gone = ("ADAPTIMP_CACHE", "ZIG_GLOBAL_CACHE_DIR", "MPLCONFIGDIR", "PYTHONDONTWRITEBYTECODE", "PYTHONPYCACHEPREFIX")
    environment = {name: value for name, value in os.environ.items() if name not in gone}
    environment |= {"HOME": str(home), "XDG_CACHE_HOME": f"{home}/cache", "XDG_CONFIG_HOME": f"{home}/config"}
    environment |= {"TMPDIR": str(home.parent / "temporary"), "MPLBACKEND": "Agg"}

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [*before, sys.executable, *arguments],
            cwd=home.parent / "work",
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=HOURS,
        )
        assert done.returncode == 0, done.stderr
        return done

    return run


def adaptimp(run: Run, line: str) -> str:
    """What a command says on standard output; on standard error it says at most that the cache is elsewhere."""
    done = run("-c", "from orchestration.cli import main; main()", *line.split())
    said = [line for line in done.stderr.splitlines() if not line.endswith(" ...")]
    assert [line for line in said if not line.startswith(WARNING)] == []
    assert len(said) <= 1
    return done.stdout


def test_the_privilege_is_given_up(home: Path) -> None:
    assert subprocess.run([*without_privilege(), "touch", str(home / "x")], check=False).returncode != 0


def test_commands_do_their_work_without_a_home(home: Path) -> None:
    """Models are compiled, packages unpacked, loops and libraries compiled, and a picture drawn."""
    run = runner(home, *without_privilege())
    cache, work = home.parent / "temporary" / f"adaptimp-{os.geteuid()}", home.parent / "work"
    assert adaptimp(run, "cache") == f"{home}/cache/adaptimp: nothing is kept.\n"
    for line in (
        "build Gain.py -o .",
        "run fig2 --stop 0.01 --no-verdict --isolate controller -o x.parquet",
        "export fig2 -o fig2.ssp",
        "run fig2.ssp --stop 0.01 --no-verdict -o y.parquet",
        "sweep fig2 --vary plant.K_f=1e4:1e5:2log --stop 0.01 --measure peak_force --store runs",
        "new controller Mine",
    ):
        adaptimp(run, line)
    assert (work / "x.parquet").is_file()
    assert run("-W", "ignore", "-c", PICTURE).stdout == f"{cache / 'matplotlib'}\n"
    assert (work / "x.png").is_file()
    listed = adaptimp(run, "cache")
    assert listed.startswith(f"{cache}\n")
    for kind in ("kernel", "binaries", "fmus", "ssp", "native", "zig", "matplotlib"):
        assert f"\n{kind} " in listed
    adaptimp(run, "cache clear")
    assert adaptimp(run, "cache") == f"{cache}: nothing is kept.\n"
    assert list(home.iterdir()) == []
    assert {path.name for path in (home.parent / "temporary").iterdir()} == {cache.name}


def test_commands_do_their_work_with_a_sealed_installation(home: Path) -> None:
    run = runner(home, *with_installation_sealed(), *without_privilege())
    adaptimp(run, "run fig2 --stop 0.01 --no-verdict -o x.parquet")
    run("-W", "ignore", "-c", PICTURE)
    assert (home.parent / "work" / "x.png").is_file()


def test_a_sealed_installation_is_sealed() -> None:
    command = [*with_installation_sealed(), "touch", str(Path(sysconfig.get_path("purelib")) / "x")]
    assert subprocess.run(command, capture_output=True, check=False).returncode != 0
