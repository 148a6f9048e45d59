"""The tables of the runtime's mathematics are what mpmath gives, to the last digit."""

from tests.golden.mathematics import FILE, tables


def test_tables_are_up_to_date() -> None:
    assert FILE.read_text(encoding="utf-8") == tables(), "run: python -m tests.golden.mathematics --write"
