"""Access to the XML files of an SSP package: names of the standard, safe reading, validation by the XSD schemas."""

import importlib.resources
import re
import tempfile
import zipfile
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path, PurePosixPath
from typing import IO
from urllib.parse import unquote

from lxml import etree

from adaptimp_fmu.files.cache_folder import cache_folder, writable_cache
from orchestration.errors import ArchiveError, SystemDescriptionError
from orchestration.fmi.units import BASE_UNITS, Linear, Unit, UnitDefinition
from orchestration.sandbox.archive import file_hash, unpack
from orchestration.sandbox.missing import require_file
from orchestration.ssp.leniency import brought_into_form
from orchestration.ssp.variants import DEFAULT, chosen, is_unpacked, unpacked_place

_BASE = "http://ssp-standard.org/SSP1/SystemStructure"
SSD, SSC = f"{_BASE}Description", f"{_BASE}Common"
SSV, SSM = f"{_BASE}ParameterValues", f"{_BASE}ParameterMapping"
STRUCTURE, VALUES, MAPPING = (f"SystemStructure{n}.xsd" for n in ("Description", "ParameterValues", "ParameterMapping"))
FMU_TYPE = "application/x-fmu-sharedlibrary"
PACKAGE_TYPE, DEFINITION_TYPE = "application/x-ssp-package", "application/x-ssp-definition"
PARAMETER_SET_TYPE = "application/x-ssp-parameter-set"
PARAMETER_MAPPING_TYPE = "application/x-ssp-parameter-mapping"
STEP_ANNOTATION = "org.adaptimp.step"
ASSUMPTIONS_ANNOTATION = "org.adaptimp.assumptions"
NAMES_ANNOTATION = "org.adaptimp.names"
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")

Xml = etree._Element
"""Type of an XML element, for which lxml has no public name."""


def ssd(path: str) -> str:
    """Return an XPath to elements of ``SystemStructure.ssd``, such as ``Elements/Component``, with their namespace."""
    return "/".join(f"{{{SSD}}}{part}" for part in path.split("/"))


@dataclass(frozen=True)
class Package:
    """An SSP package that is unpacked in the cache folder.

    Attributes
    ----------
    path
        Path of the package, for messages.
    folder
        Folder with the unpacked files.
    main
        Path of the .ssd file in the folder. The sources that it names are relative to it.
    formalities
        Sentences on rules of form that documents of the package break, as far as they have been read.
    """

    path: Path
    folder: Path
    main: str = DEFAULT
    formalities: list[str] = field(default_factory=list, compare=False)

    @classmethod
    def open(cls, path: Path, variant: str | None = None) -> "Package":
        """Open an SSP package, an unpacked folder or an .ssd file; `variant` names another .ssd file beside it.

        Raises
        ------
        ArchiveError
            If the package is missing, invalid or unsafe.
        SystemDescriptionError
            If there is no such variant.
        """
        folder, main = cls.folder_of(path)
        return cls(path, folder, chosen(path, folder, main, variant))

    @classmethod
    def folder_of(cls, path: Path) -> tuple[Path, str]:
        """Return the folder with the files of a package, folder or .ssd file, and the name of the .ssd file there."""
        return unpacked_place(path) if is_unpacked(path) else (cls._unpacked(path), DEFAULT)

    @staticmethod
    def _unpacked(path: Path) -> Path:
        """Unpack a package into the cache folder, unless the cache folder holds the package already.

        The cache folder is ``$ADAPTIMP_CACHE``, or else the cache folder of the user. The hash of a package names
        its folder there. The folder appears only when it is complete, even if two runs read the package at the
        same time.

        Raises
        ------
        ArchiveError
            If the package is missing, invalid or unsafe.
        """
        require_file(path, "package")
        folder = cache_folder() / "ssp" / file_hash(path)[:32]
        if not folder.is_dir():
            folder = writable_cache("ssp") / folder.name
        if not folder.is_dir():
            with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
                fresh = Path(scratch) / "package"
                fresh.mkdir()
                unpack(path, fresh)
                with suppress(OSError):  # another run was faster
                    fresh.rename(folder)
        return folder

    def file(self, source: str | None) -> Path:
        """Return the path of a file in the package by its URI.

        Raises
        ------
        ArchiveError
            If the file is missing, or the URI leads out of the package.
        """
        if source and _SCHEME.match(source):
            msg = f"{self.path}: the source {source!r} lies elsewhere; only files in the package can be read."
            raise ArchiveError(msg)
        for name in dict.fromkeys((source or "", unquote(source or ""))):
            relative = PurePosixPath(name)
            file = ((self.folder / self.main).parent / relative).resolve()
            if not name or "\0" in name or relative.is_absolute() or not file.is_relative_to(self.folder.resolve()):
                msg = f"{self.path}: the source {source!r} is missing or leads outside the package."
                raise ArchiveError(msg)
            if file.is_file():
                return file
        msg = f"{self.path}: the source {source!r} is not in the package."
        raise ArchiveError(msg)

    def definition(self, file: Path) -> "Package":
        """The same package with another .ssd file in it, which a component refers to."""
        return replace(self, main=file.relative_to(self.folder.resolve()).as_posix(), formalities=[])

    def structure(self) -> Xml:
        """Return the valid root element of the .ssd file.

        Raises
        ------
        ArchiveError
            If the file is missing or invalid.
        """
        file = self.folder / self.main
        if not file.is_file() and (self.folder / "modelDescription.xml").is_file():
            msg = f"{self.path} is an FMU, not an SSP package; System.of couples FMUs, and `adaptimp run` runs one."
            raise ArchiveError(msg)
        return self._parse(file, self.main, STRUCTURE)

    def document(self, element: Xml, schema: str, fmu: Path | None) -> Xml:
        """Return the valid root element of the file that the attribute ``source`` of an element names.

        Parameters
        ----------
        element
            Element with the attribute ``source``. With ``sourceBase="component"``, the file lies in the FMU.
        schema
            File name of the XSD schema.
        fmu
            FMU of the component that has the element; None for a system.

        Raises
        ------
        ArchiveError
            If the file is missing or invalid.
        """
        source = element.get("source")
        if element.get("sourceBase") != "component":
            file = self.file(source)
            return self._parse(file, file.name, schema)
        try:
            with zipfile.ZipFile(str(fmu)) as archive, archive.open(unquote(source or "")) as inner:
                return self._parse(inner, str(source), schema)
        except (OSError, KeyError) as error:
            where = "a system, which has no files of its own" if fmu is None else fmu.name
            msg = f"{self.path}: the source {source!r} is not in {where}."
            raise ArchiveError(msg) from error

    def validated(self, root: Xml, name: str, schema: str) -> Xml:
        """Validate an element by a schema, and return the element.

        Raises
        ------
        ArchiveError
            If the element is invalid.
        """
        if not _schema(schema).validate(root):
            fault = _schema(schema).error_log.last_error
            why = (
                f"{str(fault.message).rstrip('.')} (line {fault.line})"
                if fault is not None
                else "its schema refuses it"
            )
            msg = f"{self.path}: {name} is invalid: {why}."
            raise ArchiveError(msg)
        return root

    def _parse(self, file: Path | IO[bytes], name: str, schema: str) -> Xml:
        """Parse and validate a file without external entities."""
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
        try:
            root = etree.parse(str(file) if isinstance(file, Path) else file, parser).getroot()
        except (etree.XMLSyntaxError, OSError) as error:
            msg = f"{self.path}: {name} is missing or is not well-formed XML: {error}"
            raise ArchiveError(msg) from error
        if root.getroottree().docinfo.doctype:
            msg = f"{self.path}: {name} declares a document type; entities are not allowed."
            raise ArchiveError(msg)
        self.formalities.extend(brought_into_form(root, f"{self.path}: {name}"))
        return self.validated(root, name, schema)


def required(element: Xml, path: str) -> Xml:
    """Return the first descendant on a path that the schema requires.

    Raises
    ------
    ArchiveError
        If there is no such element.
    """
    found = element.find(path)
    if found is None:
        msg = f"The element {element.tag} has no element {path}, which SSP requires."
        raise ArchiveError(msg)
    return found


def read_units(root: Xml) -> dict[str, UnitDefinition]:
    """Return the units that a document defines, by their names."""
    found = {}
    for element in root.iterfind(f"{{*}}Units/{{{SSC}}}Unit"):
        base, name = required(element, f"{{{SSC}}}BaseUnit"), element.attrib["name"]
        powers = ((symbol, int(base.get(symbol) or 0)) for symbol in BASE_UNITS)
        exponents = tuple((symbol, power) for symbol, power in powers if power)
        meaning = Unit(exponents, float(base.get("factor") or 1), float(base.get("offset") or 0))
        found[name] = UnitDefinition(name, meaning if meaning.convertible else None)
    return found


def transformation(element: Xml, where: str) -> Linear:
    """Return the linear transformation of a connection or of an entry of a parameter mapping.

    Parameters
    ----------
    element
        Connection or entry.
    where
        Name of the element, for messages.

    Returns
    -------
    Linear
        Transformation; the identity if the element has none.

    Raises
    ------
    SystemDescriptionError
        If the transformation maps single values, such as a BooleanMappingTransformation.
    """
    for child in element.iterchildren(f"{{{SSC}}}*"):
        kind = etree.QName(child).localname
        if kind == "LinearTransformation":
            return Linear(float(child.get("factor") or 1), float(child.get("offset") or 0))
        if kind.endswith("Transformation"):
            msg = f"{where}: a {kind} is not supported; use a LinearTransformation."
            raise SystemDescriptionError(msg)
    return Linear()


def boolean(text: str | None) -> bool:
    """Return the value of an attribute of type xs:boolean; False if the attribute is missing."""
    return text is not None and text.strip() in ("true", "1")


def serialized(root: Xml, schema: str, name: str) -> bytes:
    """Validate a document by a schema, and return its bytes in UTF-8.

    Parameters
    ----------
    root
        Root element.
    schema
        File name of the XSD schema.
    name
        Name of the system or component, for messages.

    Raises
    ------
    SystemDescriptionError
        If the document is invalid.
    """
    if not _schema(schema).validate(root):
        msg = f"{name}: the SSP description is invalid: {_schema(schema).error_log.last_error}"
        raise SystemDescriptionError(msg)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


@cache
def _schema(name: str) -> etree.XMLSchema:
    """Schema of a file name, loaded once from the fmpy package."""
    folder = importlib.resources.files("fmpy") / "ssp" / "schema"
    return etree.XMLSchema(etree.parse(str(folder / name)))
