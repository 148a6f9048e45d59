"""A missing part of the installation is one error with the command that installs it; other errors stay as they are."""

import sys

import pytest

from adaptimp_fmu.files.parts import MissingPartError, imported, missing_part, require


@pytest.fixture
def without_arrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let Python find no pyarrow."""

    def found(name: str) -> None:
        assert name == "pyarrow"

    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setattr("adaptimp_fmu.files.parts.find_spec", found)


@pytest.mark.usefixtures("without_arrow")
def test_a_missing_package_names_its_part() -> None:
    for need in (lambda: imported("pyarrow"), lambda: require("pyarrow")):
        with pytest.raises(MissingPartError, match=r'needs pyarrow.*pip install "adaptimp\[files\]"$') as error:
            need()
        assert (error.value.part, error.value.name) == ("files", "pyarrow")


@pytest.mark.usefixtures("without_arrow")
def test_another_part_may_be_named() -> None:
    with pytest.raises(MissingPartError, match=r'"adaptimp\[paper\]"$'):
        imported("pyarrow", "paper")


def test_a_module_of_a_missing_package_counts_as_the_package() -> None:
    error = missing_part(ModuleNotFoundError("no", name="scipy.stats"))
    assert error is not None
    assert error.part == "studies"


def test_an_unknown_module_is_not_a_part() -> None:
    with pytest.raises(ModuleNotFoundError, match="no_such_module"):
        imported("no_such_module")
    assert missing_part(ImportError("cannot import name x", name="numpy")) is None
