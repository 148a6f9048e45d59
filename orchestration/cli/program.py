"""What all commands of ``adaptimp`` share: the look of the help, options on what is said, Ctrl-C.

The help is plain text of the width of the terminal, in sections, so that it looks the same on narrow terminals, in
files and without colours or Unicode.
"""

import inspect
from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from orchestration.cli.codes import MEANINGS, ExitCode, exit_code_of
from orchestration.cli.interrupts import Interrupts
from orchestration.cli.output import output

ARGUMENTS, OPTIONS, MESSAGES, COMPLETION = "Arguments", "Options", "Messages and help", "Completion in the shell"
_SECTION_OF = {"help": MESSAGES, "install_completion": COMPLETION, "show_completion": COMPLETION}
MOST_COLUMNS = 110  # of the help; longer lines are hard to read
SETTINGS: dict[str, Any] = {"help_option_names": ["-h", "--help"], "max_content_width": MOST_COLUMNS}

Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Say errors only.", rich_help_panel=MESSAGES)]
Verbose = Annotated[
    bool,
    typer.Option(
        "--verbose",
        "-v",
        help="Say more: what is unpacked, compiled or taken from a cache, what FMUs log, what to do about findings.",
        rich_help_panel=MESSAGES,
    ),
]
Debug = Annotated[
    bool, typer.Option("--debug", help="Show where in the program an error arose.", rich_help_panel=MESSAGES)
]


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"adaptimp {version('adaptimp')}")
        raise typer.Exit


Version = Annotated[
    bool,
    typer.Option(
        "--version", callback=_print_version, is_eager=True, help="Print the version.", rich_help_panel=MESSAGES
    ),
]
_COMMON: Mapping[str, Any] = {"quiet": Quiet, "verbose": Verbose, "debug": Debug}


class Command(TyperCommand):
    """A command whose options stand in sections, and whose examples keep their lines."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the arguments and options."""
        _write_parameters(self.get_params(ctx), ctx, formatter)

    def format_epilog(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002 - click gives both
        """Write examples and exit codes as they are."""
        _write_closing(self.epilog, formatter)


class Program(TyperGroup):
    """The commands, which print a sentence when a signal ends them."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the commands, and then the options."""
        commands = [(name, self.get_command(ctx, name)) for name in self.list_commands(ctx)]
        shown = [(name, command.get_short_help_str(200)) for name, command in commands if command is not None]
        _write_section("Commands", shown, formatter)
        _write_parameters(self.get_params(ctx), ctx, formatter)

    def format_epilog(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002 - click gives both
        """Write examples and exit codes as they are."""
        _write_closing(self.epilog, formatter)

    def invoke(self, ctx: Any) -> Any:
        """Run a command.

        Raises
        ------
        typer.Exit
            For a KeyboardInterrupt.
        """
        try:
            with Interrupts():
                return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            from orchestration.errors import RunInterrupted, StudyInterrupted

            if not isinstance(interrupt, RunInterrupted | StudyInterrupted):  # that was said when rows were kept
                output.error("Interrupted.")
            raise typer.Exit(exit_code_of(interrupt)) from None


def with_messages(function: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options on what is said, so that they may stand before and after its name."""

    @wraps(function)
    def command(*, quiet: bool, verbose: bool, debug: bool, **own: Any) -> None:
        output.choose(quiet=quiet, verbose=verbose, debug=debug)
        function(**own)

    signature = inspect.signature(function)
    common = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=annotation)
        for name, annotation in _COMMON.items()
    ]
    made: Any = command
    made.__signature__ = signature.replace(parameters=[*signature.parameters.values(), *common])
    made.__annotations__ = {**function.__annotations__, **_COMMON}
    return command


def closing(*examples: str, codes: Mapping[ExitCode, str] | None = None) -> str:
    """The end of a command's help: examples, of less than 60 columns, and exit codes.

    Parameters
    ----------
    codes
        Meanings of exit codes that differ from `MEANINGS`.
    """
    lines = ["Examples:", *("  " + line for example in examples for line in example.split("\n")), ""]
    meanings = {**MEANINGS, **(codes or {})}
    lines += ["Exit codes:", *(f"  {int(code):<3}  {meaning}" for code, meaning in meanings.items())]
    return "\n".join(lines)


def _write_parameters(parameters: Iterable[Any], ctx: Any, formatter: Any) -> None:
    sections: dict[str, list[tuple[str, str]]] = {}
    for parameter in parameters:
        record = parameter.get_help_record(ctx)
        if record is None:
            continue
        usual = ARGUMENTS if parameter.param_type_name == "argument" else OPTIONS
        section = getattr(parameter, "rich_help_panel", None) or _SECTION_OF.get(parameter.name, usual)
        sections.setdefault(section, []).append(record)
    for section, records in sorted(sections.items(), key=lambda item: item[0] in (MESSAGES, COMPLETION)):
        _write_section(section, records, formatter)


def _write_section(title: str, records: list[tuple[str, str]], formatter: Any) -> None:
    with formatter.section(title):
        formatter.write_dl(records, col_max=max(16, min(30, formatter.width // 3)))


def _write_closing(text: str | None, formatter: Any) -> None:
    if text:
        formatter.write("\n" + text + "\n")
