"""Makes a `SweepRequest` of the command's options, and of a study's file where one is named.

An option replaces the key of its name. ``--set`` and ``--vary`` replace one start value or one factor.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from orchestration.cli.isolation import EVERY
from orchestration.cli.sweep_file import SUFFIX, read_study_file
from orchestration.cli.sweep_request import Samples, SweepRequest, varied
from orchestration.cli.systems import SystemRequest
from orchestration.errors import SystemDescriptionError

DRAWING = ("method", "sample-seed")
"""Options on points that are drawn."""
RUNNING = ("workers", "cluster", "best", "store", "retry-failed", "out", "plot")
"""Options that say how runs are made and what becomes of the table."""


def sweep_request(system: str | None, given: Mapping[str, Any]) -> SweepRequest:
    """Make the request.

    Parameters
    ----------
    system
        A system or the file of a study; None with ``resume`` and ``ready``.
    given
        Values of the options by their long names; None and empty lists where an option is not given.

    Raises
    ------
    SystemDescriptionError
        If a text has another form, or options do not go together.
    """
    options = {name: value for name, value in given.items() if not (value is None or value is False or value == [])}
    for begun in ("resume", "ready"):
        if begun in options:
            return _begun(begun, system, options)
    if system is None:
        msg = "A system or the file of a study is needed, such as adaptimp sweep fig5 --vary plant.K_f=1e4:1e6:9log."
        raise SystemDescriptionError(msg)
    if Path(system).suffix.lower() == SUFFIX:
        return _request(read_study_file(Path(system)), options)
    return _request({"system": {"": system}}, options)


def _begun(begun: str, system: str | None, options: Mapping[str, Any]) -> SweepRequest:
    """The request to run a study that is defined already, by its store or by its name."""
    changes = [name for name in options if name not in (*RUNNING, "dry-run", "json", begun)]
    if begun == "resume" and "store" in options:
        changes.append("store")
    if system is not None or changes:
        what = f"SYSTEM {system}" if system is not None else f"--{changes[0]}"
        msg = f"{what}: --{begun} {options[begun]} takes the study as it is; leave {what} out, or begin another study."
        raise SystemDescriptionError(msg)
    if begun == "ready":
        return _with_running(SweepRequest(ready=options[begun]), options)
    return _with_running(SweepRequest(resume=options[begun], store=options[begun]), options)


def _request(file: Mapping[str, Any], options: Mapping[str, Any]) -> SweepRequest:
    """Put the keys of a file and options together."""
    wanted = {**file, **options}
    settings = [f"{path}={_text(value)}" for path, value in file.get("set", {}).items()]
    mapping = [f"{ours}={theirs}" for ours, theirs in file.get("map", {}).items()]
    common = {
        "controller": wanted.get("controller"),
        "mapping": tuple(options.get("map", mapping)),
        "settings": (*settings, *options.get("set", ())),
        "sample_time": wanted.get("sample-time"),
        "variant": wanted.get("variant"),
    }
    systems = {name: SystemRequest(one, **common) for name, one in file["system"].items()}
    request = SweepRequest(
        systems=systems,
        vary={**file.get("vary", {}), **varied(options.get("vary", ()))},
        seeds=wanted.get("seeds"),
        measures=_measures(wanted.get("measure", [])),
        samples=_samples(wanted),
        algorithm=wanted.get("algorithm", "gauss-seidel"),
        step=wanted.get("step"),
        stop=wanted.get("stop"),
        isolate=_isolated(wanted.get("isolate")),
    )
    return _with_running(request, wanted)


def _with_running(request: SweepRequest, wanted: Mapping[str, Any]) -> SweepRequest:
    """The request with what says how runs are made, and what becomes of the table."""
    running = {name.replace("-", "_"): wanted[name] for name in RUNNING if name in wanted}
    paths = {name: Path(running[name]) for name in ("store", "out", "plot") if name in running}
    flags = {"dry_run": bool(wanted.get("dry-run")), "json": bool(wanted.get("json"))}
    return replace(request, **{**running, **paths, **flags})


def _samples(wanted: Mapping[str, Any]) -> Samples | None:
    """How points are drawn; None if all combinations are wanted."""
    if "samples" not in wanted:
        useless = next((name for name in DRAWING if name in wanted), None)
        if useless is not None:
            msg = f"{useless} is about points that are drawn, and there are none; give --samples N."
            raise SystemDescriptionError(msg)
        return None
    named = {"method": wanted.get("method"), "seed": wanted.get("sample-seed")}
    return Samples(wanted["samples"], **{name: value for name, value in named.items() if value is not None})


def _measures(wanted: str | Sequence[str] | Mapping[str, str]) -> tuple[str, ...]:
    if isinstance(wanted, str):
        return (wanted,)
    if isinstance(wanted, Mapping):
        return tuple(f"{name} = {formula}" for name, formula in wanted.items())
    return tuple(wanted)


def _isolated(wanted: bool | Sequence[str] | None) -> tuple[str, ...]:
    """Names as the option ``--isolate`` has them."""
    if isinstance(wanted, bool):
        return (EVERY,) if wanted else ()
    return tuple(wanted or ())


def _text(value: Any) -> str:
    """A value of TOML as ``--set`` takes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return f"[{','.join(map(_text, value))}]"
    return str(value)
