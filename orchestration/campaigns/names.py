"""Names of factors in tables, and values that users give by them."""

from collections.abc import Mapping, Sequence
from typing import Any

from orchestration.campaigns.columns import MESSAGE, RESERVED, STATUS, SYSTEM
from orchestration.campaigns.design.factor import Factor, Target
from orchestration.errors import StudyError
from orchestration.fmi.given import shown


def column_names(factors: Sequence[Factor], measures: Sequence[str]) -> tuple[str, ...]:
    """Names of the factors' columns: the last part of each name, where nothing else in the table has it.

    Raises
    ------
    StudyError
        If a whole name is one that tables use themselves, or that of a measure.
    """
    shorts = [factor.short for factor in factors]
    found = []
    for factor in factors:
        own = shorts.count(factor.short) == 1 and factor.short not in (*RESERVED, *measures)
        name = factor.short if own else factor.name
        if name in (*RESERVED, *measures):
            advice = "give a Factor with a name of its own"
            msg = f"Factor {factor.name}: the table has another column of this name; {advice}."
            raise StudyError(msg)
        found.append(name)
    return tuple(found)


def all_names(columns: Sequence[str], targets: Sequence[Target]) -> dict[str, Factor]:
    """Factors by their columns, by their own names, and by the only start value that they set.

    Parameters
    ----------
    columns, targets
        Name of the column of each factor, and what the factor sets.
    """
    found = {target.names[0]: target.factor for target in targets if len(target.names) == 1 and not target.sets_step}
    found |= {target.factor.name: target.factor for target in targets}
    return found | {column: target.factor for column, target in zip(columns, targets, strict=True)}


def asked(given: Mapping[str, Any], known: Mapping[str, Factor], ignored: Sequence[str]) -> dict[Factor, Any]:
    """Values by the factors that bear the names; names of no factor are those of start values.

    Parameters
    ----------
    given
        Values by the name of a column, of a factor or of a start value.
    known
        Factors of the study by all of their names.
    ignored
        Columns that are no factors, such as measures.

    Raises
    ------
    StudyError
        If a factor is given twice.
    """
    found: dict[Factor, Any] = {}
    for name, value in given.items():
        if name in (SYSTEM, STATUS, MESSAGE, *ignored):
            continue
        factor = known.get(name) or Factor(name, name)
        if factor in found:
            msg = f"Factor {factor.name} is given twice, as {name} too; give it once."
            raise StudyError(msg)
        found[factor] = value
    return found


def row_of(row: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """Values of a row of a table and values beside it, by name.

    Parameters
    ----------
    row
        A mapping, a row of a DataFrame, a point of a Dataset, or None.
    values
        Further values, which count more than those of the row.
    """
    if row is None:
        return dict(values)
    if hasattr(row, "coords"):  # a Dataset, whose factors are its coordinates
        named = {str(name): coordinate.values for name, coordinate in row.coords.items()}
        wide = [name for name, value in named.items() if value.size != 1]
        if wide:
            msg = f"The row has {named[wide[0]].size} values of {wide[0]}; choose one, as table.sel({wide[0]}=...)."
            raise StudyError(msg)
        return {name: value.item() for name, value in named.items()} | dict(values)
    if hasattr(row, "to_dict"):
        row = row.to_dict()
    if not isinstance(row, Mapping):
        msg = f"A row is {shown(row)}; give values by name, such as K_f=1e5, or a row of the table."
        raise StudyError(msg)
    return {str(name): value for name, value in row.items()} | dict(values)


def in_words(values: Mapping[str, Any]) -> str:
    """Factors of a run in words, such as ``K_f = 1e+05, seed = 7``."""
    return ", ".join(
        f"{name} = {value:g}" if _is_number(value) else f"{name} = {value}" for name, value in values.items()
    )


def _is_number(value: Any) -> bool:
    return not isinstance(value, str) and hasattr(value, "__float__")
