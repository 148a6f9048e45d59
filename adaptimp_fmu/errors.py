"""Errors of declaring and compiling an FMU."""


class DefinitionError(ValueError):
    """A model's declaration contradicts itself or FMI 2.0."""


class ToolchainError(RuntimeError):
    """The compiler is missing or refused the generated code."""
