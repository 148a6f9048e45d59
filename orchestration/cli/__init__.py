"""The command line interface ``adaptimp``."""

from orchestration.cli.app import main

__all__ = ["main"]
