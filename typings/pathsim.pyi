"""Shows pyright that pathsim is a package, not the file of the same name in tests/interop/matrix/tools."""

from typing import Any

def __getattr__(name: str) -> Any: ...
