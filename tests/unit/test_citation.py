"""CITATION.cff says of the project what pyproject.toml says, and of the paper what README.md says."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
CITATION = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def stated(key: str, indent: str = "") -> str:
    """What the file says under a key that it has once."""
    (value,) = re.findall(rf"^{indent}{key}: (.*)$", CITATION, re.MULTILINE)
    return value


def test_the_project_is_the_same() -> None:
    assert (stated("title"), stated("version"), stated("license")) == (
        PROJECT["name"],
        PROJECT["version"],
        PROJECT["license"],
    )
    assert re.findall(r"^  - name: (.*)$", CITATION, re.MULTILINE) == [author["name"] for author in PROJECT["authors"]]
    keywords = CITATION.partition("keywords:\n")[2].partition("references:")[0]
    assert re.findall(r"^  - (.*)$", keywords, re.MULTILINE) == PROJECT["keywords"]


def test_the_paper_is_the_one_of_the_readme() -> None:
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    volume, year = f"{stated('volume', '    ')}({stated('issue', '    ')})", stated("year", "    ")
    source = f"IEEE Trans. Robotics and Automation {volume}, {year}"
    doi = stated("doi", "    ")
    assert f'"{stated("title", "    ")}" ({source}, [doi:{doi}](https://doi.org/{doi}))' in readme
