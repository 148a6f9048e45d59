"""What pyright needs to know of lxml's compiled module, which carries no types: its names exist."""

from typing import Any

def __getattr__(name: str) -> Any: ...
