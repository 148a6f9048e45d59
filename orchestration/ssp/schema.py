"""Files of an SSP package: names of the standard, screened reading, validation against the schemas."""

import importlib.resources
import os
import re
import tempfile
import zipfile
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import unquote

import platformdirs
from lxml import etree

from orchestration.errors import ArchiveError, SystemDescriptionError
from orchestration.fmi.units import BASE_UNITS, Linear, Unit, UnitDefinition
from orchestration.sandbox.archive import file_hash, unpack

_BASE = "http://ssp-standard.org/SSP1/SystemStructure"
SSD, SSC = f"{_BASE}Description", f"{_BASE}Common"
SSV, SSM = f"{_BASE}ParameterValues", f"{_BASE}ParameterMapping"
STRUCTURE, VALUES, MAPPING = (f"SystemStructure{n}.xsd" for n in ("Description", "ParameterValues", "ParameterMapping"))
FMU_TYPE = "application/x-fmu-sharedlibrary"
PARAMETER_SET_TYPE = "application/x-ssp-parameter-set"
PARAMETER_MAPPING_TYPE = "application/x-ssp-parameter-mapping"
STEP_ANNOTATION = "org.adaptimp.step"
ASSUMPTIONS_ANNOTATION = "org.adaptimp.assumptions"
NAMES_ANNOTATION = "org.adaptimp.names"
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")


def ssd(path: str) -> str:
    """A path of elements of the structure description, such as ``Elements/Component``."""
    return "/".join(f"{{{SSD}}}{part}" for part in path.split("/"))


@dataclass(frozen=True)
class Package:
    """An unpacked package.

    Attributes
    ----------
    path
        Of the package itself, for messages.
    """

    path: Path
    folder: Path

    @classmethod
    def open(cls, path: Path) -> "Package":
        """Unpack a package once into the cache (``$ADAPTIMP_CACHE`` or the user's), by its hash.

        The folder appears whole, also when two runs read at once.
        """
        if not path.is_file():
            msg = f"{path}: there is no such package."
            raise ArchiveError(msg)
        cache_folder = os.environ.get("ADAPTIMP_CACHE") or platformdirs.user_cache_path("adaptimp")
        folder = Path(cache_folder) / "ssp" / file_hash(path)[:32]
        if not folder.is_dir():
            folder.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
                fresh = Path(scratch) / "package"
                fresh.mkdir()
                unpack(path, fresh)
                with suppress(OSError):  # another run was faster
                    fresh.rename(folder)
        return cls(path, folder)

    def file(self, source: str | None) -> Path:
        """A file of the package by its URI; one that leads out of the package is refused."""
        if source and _SCHEME.match(source):
            msg = f"{self.path}: the source {source!r} lies elsewhere; only files in the package are read."
            raise ArchiveError(msg)
        for name in dict.fromkeys((source or "", unquote(source or ""))):
            relative = PurePosixPath(name)
            file = (self.folder / relative).resolve()
            if not name or "\0" in name or relative.is_absolute() or not file.is_relative_to(self.folder.resolve()):
                msg = f"{self.path}: the source {source!r} is missing or leads outside the package."
                raise ArchiveError(msg)
            if file.is_file():
                return file
        msg = f"{self.path}: the source {source!r} is not in the package."
        raise ArchiveError(msg)

    def structure(self) -> Any:
        """Root of ``SystemStructure.ssd``."""
        name = "SystemStructure.ssd"
        return self._parse(self.folder / name, name, STRUCTURE)

    def document(self, element: Any, schema: str, fmu: Path | None) -> Any:
        """Root of what an element has in a file, by its attribute ``source``.

        With ``sourceBase="component"`` the file lies in the component's FMU.
        """
        source = element.get("source")
        if element.get("sourceBase") != "component":
            file = self.file(source)
            return self._parse(file, file.name, schema)
        try:
            with zipfile.ZipFile(str(fmu)) as archive, archive.open(unquote(source or "")) as inner:
                return self._parse(inner, source, schema)
        except (OSError, KeyError) as error:
            where = "a system, which has no files" if fmu is None else fmu.name
            msg = f"{self.path}: the source {source!r} is not in {where}."
            raise ArchiveError(msg) from error

    def validated(self, root: Any, name: str, schema: str) -> Any:
        """The root itself, valid against a schema."""
        if not _schema(schema).validate(root):
            msg = f"{self.path}: {name} is invalid: {_schema(schema).error_log.last_error}"
            raise ArchiveError(msg)
        return root

    def _parse(self, file: Any, name: str, schema: str) -> Any:
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
        try:
            root = etree.parse(str(file) if isinstance(file, Path) else file, parser).getroot()
        except (etree.XMLSyntaxError, OSError) as error:
            msg = f"{self.path}: {name} is missing or no well-formed XML: {error}"
            raise ArchiveError(msg) from error
        if root.getroottree().docinfo.doctype:
            msg = f"{self.path}: {name} declares a document type; entities are not read."
            raise ArchiveError(msg)
        return self.validated(root, name, schema)


def read_units(root: Any) -> dict[str, UnitDefinition]:
    """Units that a document defines, by name."""
    found = {}
    for element in root.iterfind(f"{{*}}Units/{{{SSC}}}Unit"):
        base, name = element.find(f"{{{SSC}}}BaseUnit"), element.get("name")
        exponents = tuple((n, int(base.get(n))) for n in BASE_UNITS if int(base.get(n) or 0))
        meaning = Unit(exponents, float(base.get("factor") or 1), float(base.get("offset") or 0))
        found[name] = UnitDefinition(name, meaning if meaning.convertible else None)
    return found


def transformation(element: Any, where: str) -> Linear:
    """The linear transformation of a connection or mapping entry.

    Raises
    ------
    SystemDescriptionError
        If it is a map of values.
    """
    for child in element.iterchildren(f"{{{SSC}}}*"):
        kind = etree.QName(child).localname
        if kind == "LinearTransformation":
            return Linear(float(child.get("factor") or 1), float(child.get("offset") or 0))
        if kind.endswith("Transformation"):
            msg = f"{where}: a {kind} is not supported, only a LinearTransformation is."
            raise SystemDescriptionError(msg)
    return Linear()


def boolean(text: str | None) -> bool:
    """An xs:boolean; False if it is not given."""
    return text is not None and text.strip() in ("true", "1")


def serialized(root: Any, schema: str, name: str) -> bytes:
    """Valid XML as bytes.

    Raises
    ------
    SystemDescriptionError
        If it is not valid.
    """
    if not _schema(schema).validate(root):
        msg = f"{name}: the SSP description is invalid: {_schema(schema).error_log.last_error}"
        raise SystemDescriptionError(msg)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


@cache
def _schema(name: str) -> Any:
    folder = importlib.resources.files("fmpy") / "ssp" / "schema"
    return etree.XMLSchema(etree.parse(str(folder / name)))
