"""Access to the XML files of an SSP package: names of the standard, safe reading, validation by the XSD schemas."""

import re
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

from lxml import etree

from adaptimp_fmu.files.standards import standard_file
from orchestration.errors import ArchiveError, SystemDescriptionError
from orchestration.fmi.units import BASE_UNITS, Linear, Unit, UnitDefinition
from orchestration.sandbox.archive import read_entries
from orchestration.sandbox.missing import require_file
from orchestration.sandbox.xml import LARGEST, XmlError, parse_xml, violation
from orchestration.sandbox.zip.rules import shown
from orchestration.ssp.leniency import brought_into_form
from orchestration.ssp.unpacked import forget_package, unpacked_package
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

MAX_PARSED = 64 * 1024**2  # bytes of all XML files of a package and of the packages within it

Xml = etree._Element
"""Type of an XML element, for which lxml has no public name."""


def ssd(path: str) -> str:
    """Return an XPath to elements of ``SystemStructure.ssd``, such as ``Elements/Component``, with their namespace."""
    return "/".join(f"{{{SSD}}}{part}" for part in path.split("/"))


@dataclass
class Shared:
    """What a package has in common with all packages within it.

    Attributes
    ----------
    parsed_bytes
        Bytes of the XML files that were parsed until now.
    unpacked
        Folders in the cache to which packages were unpacked just now, so that nothing else uses them yet.
    """

    parsed_bytes: int = 0
    unpacked: list[Path] = field(default_factory=list)


@dataclass
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
    shared
        What the package has in common with the packages around it and within it.
    """

    path: Path
    folder: Path
    main: str = DEFAULT
    formalities: list[str] = field(default_factory=list, compare=False)
    shared: Shared = field(default_factory=Shared, compare=False)
    _documents: dict[tuple[Path | None, str, str], Xml] = field(default_factory=dict, repr=False)

    @classmethod
    def open(cls, path: Path, variant: str | None = None, outer: "Package | None" = None) -> "Package":
        """Open an SSP package, an unpacked folder or an .ssd file.

        Parameters
        ----------
        path
            The package, folder or .ssd file.
        variant
            Name of another .ssd file beside the usual one.
        outer
            The package that this one lies in.

        Raises
        ------
        ArchiveError
            If the package is missing, invalid or unsafe.
        SystemDescriptionError
            If there is no such variant.
        """
        package = cls.at(path, outer)
        try:
            package.main = chosen(path, package.folder, package.main, variant)
        except SystemDescriptionError:
            package.discard()
            raise
        return package

    @classmethod
    def at(cls, path: Path, outer: "Package | None" = None) -> "Package":
        """Return a package, folder or .ssd file before a variant is chosen; parameters and errors are as of `open`.

        A package is unpacked into the cache folder, unless the cache folder holds the package already. The cache
        folder is ``$ADAPTIMP_CACHE``, or else the cache folder of the user; see `orchestration.ssp.unpacked`.
        """
        shared = Shared() if outer is None else outer.shared
        if is_unpacked(path):
            return cls(path, *unpacked_place(path), shared=shared)
        require_file(path, "package")
        folder, unpacked_now = unpacked_package(path)
        if unpacked_now:
            shared.unpacked.append(folder)
        return cls(path, folder, shared=shared)

    def discard(self) -> None:
        """Remove from the cache folder what was unpacked for this package, the packages around it and within it.

        Files that the cache folder held before stay, because another system may use them. The next `open` unpacks
        again what is removed.
        """
        while self.shared.unpacked:
            forget_package(self.shared.unpacked.pop())

    def file(self, source: str | None) -> Path:
        """Return the path of a file in the package by its URI.

        Raises
        ------
        ArchiveError
            If the file is missing, or the URI leads out of the package.
        """
        if source and _SCHEME.match(source):
            msg = f"{self.path}: the source {shown(source)} lies elsewhere; only files in the package can be read."
            raise ArchiveError(msg)
        given, plain = source or "", unquote(source or "")
        for name in dict.fromkeys((given, plain, plain.replace("\\", "/"))):  # some tools write paths of Windows
            relative = PurePosixPath(name)
            inside = bool(name) and "\0" not in name and not relative.is_absolute()
            file = ((self.folder / self.main).parent / relative).resolve() if inside else self.folder
            if not inside or not file.is_relative_to(self.folder.resolve()):
                msg = f"{self.path}: the source {shown(str(source))} is missing or leads outside the package."
                raise ArchiveError(msg)
            with suppress(OSError):  # a name may be too long for a file
                if file.is_file():
                    return file
        msg = f"{self.path}: the source {shown(str(source))} is not in the package."
        raise ArchiveError(msg)

    def definition(self, file: Path) -> "Package":
        """The same package with another .ssd file in it, which a component refers to."""
        return replace(self, main=file.relative_to(self.folder.resolve()).as_posix(), formalities=[], _documents={})

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
        source, base = element.get("source"), element.get("sourceBase")
        key = (fmu if base == "component" else None, f"{base}:{source}", schema)
        if key not in self._documents:
            self._documents[key] = self._document(source, schema, fmu, inside=base == "component")
        return self._documents[key]

    def _document(self, source: str | None, schema: str, fmu: Path | None, *, inside: bool) -> Xml:
        """Read a file of the package, or of an FMU."""
        if not inside:
            file = self.file(source)
            return self._parse(file, file.name, schema)
        name = unquote(source or "")
        content = dict(read_entries(fmu, [name], LARGEST + 1)).get(name) if fmu is not None else None
        if content is None:
            where = "a system, which has no files of its own" if fmu is None else fmu.name
            msg = f"{self.path}: the source {shown(str(source))} is not in {where}."
            raise ArchiveError(msg)
        return self._parse(content, shown(name), schema)

    def validated(self, root: Xml, name: str, schema: str) -> Xml:
        """Validate an element by a schema, and return the element.

        Raises
        ------
        ArchiveError
            If the element is invalid.
        """
        if found := violation(root, _schema(schema)):
            msg = f"{self.path}: {name} is invalid{found}."
            raise ArchiveError(msg)
        return root

    def _parse(self, file: Path | bytes, name: str, schema: str) -> Xml:
        """Parse and validate a file without external entities."""
        try:
            content = file if isinstance(file, bytes) else _first_bytes(file, LARGEST + 1)
            self.shared.parsed_bytes += len(content)
            if self.shared.parsed_bytes > MAX_PARSED:
                msg = f"{self.path}: its XML files have more than {MAX_PARSED} bytes, {name} included."
                raise ArchiveError(msg)
            root = parse_xml(content)
            self.formalities.extend(brought_into_form(root, f"{self.path}: {name}"))
            self.validated(root, name, schema)
        except OSError as error:
            msg = f"{self.path}: {name} is missing, or it cannot be read: {error.strerror}."
            raise ArchiveError(msg) from error
        except XmlError as error:
            msg = f"{self.path}: {name} {error}."
            raise ArchiveError(msg) from error
        return root


def _first_bytes(file: Path, most: int) -> bytes:
    with file.open("rb") as opened:
        return opened.read(most)


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
    """Schema of a file name, loaded once."""
    return etree.XMLSchema(etree.parse(str(standard_file("ssp", "schema", name))))
