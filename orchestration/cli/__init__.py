"""The command line, ``adaptimp``."""

from orchestration.cli.app import main

__all__ = ["main"]
