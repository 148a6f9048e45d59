"""The identity of a function changes with everything that it uses, and with nothing else."""

import importlib
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from orchestration import Study, StudyError, System
from orchestration.campaigns.measuring import module_content
from orchestration.campaigns.measuring.code_identity import function_identity

LIMIT = 1.0


def limited(result: Any) -> float:
    """The last value, in parts of a limit."""
    return LIMIT * float(result["plant.x"][-1])


def made(text: str) -> Callable[..., Any]:
    """The object ``m`` that a program defines."""
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(text, names)
    return names["m"]


CALLED = "class C:\n    {}\n    def __call__(self, r):\n        return self.k\nm = C()"
TWO: dict[str, str] = {
    "a function in a dict": "T = {{'a': lambda r: {}}}\ndef m(r):\n    return T['a'](r)",
    "a function in a list": "T = [lambda r: {}]\ndef m(r):\n    return T[0](r)",
    "a function behind a cache": "import functools\n@functools.lru_cache\ndef a(x):\n    return {}\n"
    "def m(r):\n    return a(1)",
    "a cached measure": "import functools\n@functools.lru_cache\ndef m(r):\n    return {}",
    "a partial": "import functools\ndef a(x, r):\n    return {}\nm = functools.partial(a, 1)",
    "a wrapped function": "import functools\ndef a(r):\n    return {}\n@functools.wraps(a)\ndef m(r):\n    return a(r)",
    "a context": "import contextlib\n@contextlib.contextmanager\ndef a():\n    yield {}\n"
    "def m(r):\n    with a() as k:\n        return k",
    "a vectorized function": "import numpy as np\nv = np.vectorize(lambda x: x * {})\ndef m(r):\n    return v(1)",
    "a compiled function": "import numba\n@numba.njit\ndef a(x):\n    return x * {}\ndef m(r):\n    return a(1)",
    "an option of a compiled function": "import numba\n@numba.njit(fastmath={} > 1)\ndef a(x):\n    return x\n"
    "def m(r):\n    return a(1)",
    "an attribute of a function": "def m(r):\n    return m.k\nm.k = {}",
    "a class attribute": CALLED.format("k = {}"),
    "a property": CALLED.format("k = property(lambda self: {})"),
    "a cached property": "import functools\n" + CALLED.format("k = functools.cached_property(lambda self: {})"),
    "a static method": CALLED.format("k = staticmethod(lambda: {})"),
    "a class method": CALLED.format("k = classmethod(lambda cls: {})"),
    "a base class": "class B:\n    def k(self):\n        return {}\nclass C(B):\n    def __call__(self, r):\n"
    "        return self.k()\nm = C()",
    "the class of an object": "class C:\n    def k(self):\n        return {}\nc = C()\ndef m(r):\n    return c.k()",
    "a state of an object": "class C:\n    def __init__(self):\n        self.f = lambda r: {}\nc = C()\n"
    "def m(r):\n    return c.f(r)",
    "a field": "from dataclasses import dataclass\n@dataclass(frozen=True)\nclass C:\n    k: float = {}\n"
    "def m(r):\n    return C().k",
    "a keyword of a function": "def m(r, *, k={}):\n    return k",
    "a bound method": "class C:\n    def k(self, r):\n        return {}\nm = C().k",
}


@pytest.mark.parametrize("case", TWO)
def test_whatever_a_function_uses_counts(case: str) -> None:
    first, again, other = (function_identity(made(TWO[case].format(number))) for number in (1.0, 1.0, 2.0))
    assert first == again
    assert first != other


@pytest.mark.parametrize(
    "program",
    [
        "def m(r):\n    import own_helper\n    return own_helper.f(r)",
        "def m(r):\n    def inner():\n        from own_helper import f\n        return f(r)\n    return inner()",
        "import own_helper\ndef m(r):\n    return own_helper.f(r)",
    ],
)
@pytest.mark.parametrize("changed", ["own_helper", "own_second", "own_package/__init__", "own_package/third"])
def test_own_modules_count_wherever_they_are_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str, changed: str
) -> None:
    (tmp_path / "own_package").mkdir()
    (tmp_path / "own_package" / "__init__.py").write_text("GAIN = 1.0\n")
    (tmp_path / "own_package" / "third.py").write_text("from . import GAIN\n")
    (tmp_path / "own_second.py").write_text("def g(r):\n    from own_package import third\n    return third.GAIN\n")
    (tmp_path / "own_helper.py").write_text("import own_second\ndef f(r):\n    return own_second.g(r)\n")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.invalidate_caches()
    try:
        before = function_identity(made(program))
        assert function_identity(made(program)) == before
        with (tmp_path / f"{changed}.py").open("a") as file:
            file.write("MORE = 1\n")
        assert function_identity(made(program)) != before
    finally:
        for name in [name for name in sys.modules if name.startswith("own_")]:
            del sys.modules[name]


def test_a_value_that_a_program_sets_in_a_module_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "own_values.py").write_text("GAIN = 1.0\n")
    monkeypatch.syspath_prepend(tmp_path)
    function = made("import own_values\ndef m(r):\n    return own_values.GAIN")
    before = function_identity(function)
    monkeypatch.setattr("own_values.GAIN", 2.0)
    assert function_identity(function) != before
    del sys.modules["own_values"]


def test_a_module_that_no_import_gives_counts_by_its_file(tmp_path: Path) -> None:
    file = tmp_path / "beside.py"
    file.write_text("GAIN = 1.0\n")
    program = (
        "from importlib.util import module_from_spec, spec_from_file_location\n"
        f"spec = spec_from_file_location('beside', {str(file)!r})\nbeside = module_from_spec(spec)\n"
        "def m(r):\n    return beside.GAIN"
    )
    before = function_identity(made(program))
    file.write_text("GAIN = 2.0\n")
    assert function_identity(made(program)) != before
    file.unlink()
    with pytest.raises(StudyError, match="module beside, whose file"):
        function_identity(made(program))


@pytest.mark.parametrize(
    "program",
    [
        "import scipy.signal\ndef m(r):\n    return scipy.signal.detrend(r)",
        "from scipy.signal import detrend\ndef m(r):\n    return detrend(r)",
        "def m(r):\n    from scipy import signal\n    return signal.detrend(r)",
    ],
)
def test_the_version_of_an_installed_package_counts(program: str, monkeypatch: pytest.MonkeyPatch) -> None:
    before = function_identity(made(program))
    monkeypatch.setattr(module_content, "_version", lambda name: "0.0" if name == "scipy" else "1.0")
    old = function_identity(made(program))
    monkeypatch.setattr(module_content, "_version", lambda name: "9.9" if name == "scipy" else "1.0")
    assert len({before, old, function_identity(made(program))}) == 3


PROGRAM = """
from orchestration.campaigns.measuring.code_identity import function_identity
class C:
    names = {"alpha", "beta", "gamma", "delta"}
TABLE = {"wanted": {"alpha", "beta", "gamma", ("delta", 1)}, "object": C()}
def m(r):
    return r in TABLE["wanted"] or r in {"one", "two", "three"}
print(function_identity(m))
"""


def test_a_set_has_the_same_identity_in_every_process() -> None:
    found = {
        subprocess.run(
            [sys.executable, "-c", PROGRAM],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            check=True,
            text=True,
            timeout=300,
        ).stdout
        for seed in ("1", "2", "3")
    }
    assert len(found) == 1
    assert len(found.pop().strip()) == 64


@pytest.mark.parametrize(
    ("program", "message"),
    [
        (
            "import threading\nlock = threading.Lock()\ndef m(r):\n    return lock",
            "reads lock of m, a value of type lock",
        ),
        (
            "import types\nheap = types.ModuleType('heap')\ndef m(r):\n    return heap.x",
            "module heap, which has no file",
        ),
        ("def m(r):\n    return eval('r')", "m uses eval, which cannot be followed"),
        ("from importlib import import_module\ndef m(r):\n    return import_module('x')", "uses import_module as"),
        ("import importlib\ndef m(r):\n    return importlib.import_module('x')", r"uses importlib\.import_module"),
    ],
)
def test_what_cannot_be_followed_is_refused(program: str, message: str) -> None:
    with pytest.raises(StudyError, match=message):
        function_identity(made(program))


def test_a_changed_global_makes_the_runs_of_a_study_anew(
    loop: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = Study(loop, limited, stop_time=0.125).grid({"plant.x_start": [1.0, 2.0]})
    before = study.run(store=tmp_path)["limited"].values
    monkeypatch.setitem(globals(), "LIMIT", 2.0)
    after = study.run(store=tmp_path)["limited"].values
    assert after.tolist() == (2.0 * before).tolist()
    assert before.all()
