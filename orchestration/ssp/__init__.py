"""Reading and writing of coupled systems as SSP 1.0 packages.

A package is a zip archive with the files ``SystemStructure.ssd``, ``resources/*.fmu`` and ``resources/*.ssv``.
Written packages keep to a profile that other simulation tools can load:

- The system is flat, without systems inside the system.
- Only connected variables have connectors.
- Each component has one parameter set.
- The prefixes of XML names are ``ssd:``, ``ssc:`` and ``ssv:``.
- A linear transformation converts between different units, because some tools do not convert units.

Packages of other tools may have nested systems, mapped parameters, linear transformations and other units; see
`orchestration.ssp.read`.
"""

from orchestration.ssp.read import read_ssp
from orchestration.ssp.write import write_ssp

__all__ = ["read_ssp", "write_ssp"]
