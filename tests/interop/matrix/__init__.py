"""Runs every FMU and every figure's package in every other tool and compares the rows: ``docs/interop.md``.

    uv run python -m tests.interop.matrix [--only TOOL] [--job NAME] [--write docs/interop.md]

A tool is a module of `tests.interop.matrix.tools`: who it is, and a function that runs a `Job`. Each run
is a process of its own, so a crash or a hang is an entry. Tools whose requirements conflict with the
project's run in an environment that ``uv run --no-project --with`` makes for them; those processes see
the standard library, numpy and the tool, so neither the tools nor `protocol` import anything of ours.
"""
