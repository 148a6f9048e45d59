"""What can go wrong between a definition and a built FMU, and when one is tested."""


class DefinitionError(ValueError):
    """A model's declaration contradicts itself or FMI 2.0."""


class ToolchainError(RuntimeError):
    """The compiler is missing or refused the generated code."""


class FmuError(RuntimeError):
    """A unit cannot be loaded, or refuses a call; says where, when, and the unit's last message."""


class SignalError(ValueError):
    """A name, a shape, a value or a time that does not fit the unit."""
