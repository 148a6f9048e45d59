"""Systems as SSP 1.0 packages: ``SystemStructure.ssd`` and ``resources/*.fmu, *.ssv`` in a zip.

What is written keeps to the profile that other engines load too: a flat system, connected variables as
the only connectors, one parameter set per component, literal prefixes ``ssd:``, ``ssc:``, ``ssv:``, and
units that differ converted by a linear transformation, since not every engine converts units. What is
read may be nested, mapped, scaled and in other units: `orchestration.ssp.read`.
"""

from orchestration.ssp.read import read_ssp
from orchestration.ssp.write import write_ssp

__all__ = ["read_ssp", "write_ssp"]
