"""Errors of declaring, compiling and testing an FMU."""


class DefinitionError(ValueError):
    """A model's declaration contradicts itself or FMI 2.0."""


class ToolchainError(RuntimeError):
    """The compiler is missing or refused the generated code."""


class FmuError(RuntimeError):
    """An FMU cannot be loaded, or refuses a call. The error gives place, time and the FMU's last message."""


class SignalError(ValueError):
    """A name, a shape, a value or a time does not fit the FMU's variables."""
