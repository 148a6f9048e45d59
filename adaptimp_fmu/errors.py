"""Errors of declaring and compiling an FMU."""


class DefinitionError(ValueError):
    """A model's declaration contradicts itself or FMI 2.0.

    Examples
    --------
    >>> from adaptimp_fmu import ContinuousModel, DefinitionError
    >>> model = ContinuousModel("Cart", "A cart")
    >>> m = model.parameter("m", 1.0, unit="kg", description="Mass")
    >>> try:
    ...     model.input("m", 0.0, unit="m", description="Position")
    ... except DefinitionError as error:
    ...     print(error)
    Cart already has a variable m...
    """


class ToolchainError(RuntimeError):
    """The compiler is missing or refused the generated code.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu import ContinuousModel, Platform, ToolchainError, build
    >>> constant = ContinuousModel("Constant", "A constant")
    >>> constant.output("y", 1.0, description="One")
    >>> try:
    ...     build(constant, Path("built"), [Platform("rover", "no-such-target", ".so")])
    ... except ToolchainError as error:
    ...     print(str(error).splitlines()[0])
    model.c does not compile for rover...
    """
