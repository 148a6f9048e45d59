"""Version, license, default experiment, references and terminals that all FMUs of this project carry.

Terminals of one name belong together, as signals of one name do: where a tool connects terminals, six connections
couple an arm. The references are the files in ``fmus/reference/NAME``, which `orchestration.paper.reference_data`
writes.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from adaptimp_fmu import (
    Drawing,
    Experiment,
    Icon,
    Model,
    Ownership,
    ParameterSet,
    ReferenceRun,
    Role,
    Signal,
    present,
    runtime_license,
)
from fmus import start
from fmus.drawings.loop import PLANT, SENSOR, loop, signals

AUTHOR = "The adaptimp authors"
VERSION = "1"
STEP = 1e-4  # s, start of every sample_time and of the plant's dt_max
REFERENCES = Path(__file__).parent / "reference"
TERMINALS = {
    "motion": ("q", "dq", "ddq"),  # of the joints
    "virtual_motion": ("x_v", "dx_v", "ddx_v"),  # that the tip is to follow
    "contact": ("F_ext",),  # of tip and wall
    "measured_force": ("F_hat",),
    "command": ("tau_cmd", "saturated"),  # from the controller, and back
    "drive": ("tau",),  # of the joints
}
"""Signals of each terminal. An FMU has those terminals of which it has a signal."""
TIP = {"tip": ("x",)}
"""A further terminal in space, where the sensor needs the orientation of the tip from the plant."""
TOPICS = {
    "Start": ("q_start", "dq_start", "p_start"),
    "Arm": ("m", "l", "payload", "viscous", "coulomb", "p", "coulomb_velocity", "gravity", "reference_rpy"),
    "Payload": ("payload_mass", "payload_center", "payload_inertia"),
    "Range of the joints": (
        *("q_min", "q_max", "stop_stiffness", "stop_damping"),
        *("limit_margin", "limit_stiffness", "limit_damping", "limit_torque"),
    ),
    "Wall": ("wall_normal", "wall_offset", "K_f", "D_f", "mu", "friction_velocity", "contact_point"),
    "Second wall": ("wall_normal2", "wall_offset2", "K_f2", "D_f2", "mu2", "friction_velocity2"),
    "Ellipse": ("semi_axis", "center", "plane_rpy", "period", "depth", "height", "orientation", "tilt"),
    "Target impedance": ("M", "B", "K", "task_rpy", "null_damping", "null_stiffness", "posture"),
    "Adaptation": (
        *("Gamma", "Psi", "K_d", "p_min", "p_max", "projection", "dead_zone", "freeze_when_saturated"),
        *("update_divisor", "acc_filter_time"),
    ),
    "Noise": ("noise_std", "noise_bound", "noise_period", "contact_gated", "seed"),
    "Rejection of noise": ("contact_threshold", "gamma_margin", "gamma_eps"),
    "Bias, range and resolution": ("bias", "range", "resolution", "moment_range", "moment_resolution"),
    "Norms of positions and angles": ("L",),
    "Frame of the sensor": ("sensor_position", "sensor_rpy"),
    "Filter, zero and weight compensation": ("filter_time", "zero", "tool_mass", "tool_center"),
    "Failure": ("failure", "failure_start", "failure_duration", "failure_force"),
    "Limits of the torque": ("tau_max", "tau_rate_max", "time_constant"),
    "Sampling and integration": ("sample_time", "dt_max"),
}
"""Parameters by topic, for all FMUs of this project; a page has the topics of which its FMU has a parameter."""
EXPERIMENT = Experiment(start_time=0.0, stop_time=start.PERIOD, step_size=STEP)


def publish(model: Model, icon: Icon, component: str, drawings: Sequence[Drawing], *modules: str) -> None:
    """Give a model of this project its icon, documentation, license, default experiment and references.

    Parameters
    ----------
    component
        Name of the component of the loop that the model is made for.
    drawings
        Drawings of what the model's variables mean.
    modules
        Names of the modules whose docstrings hold the equations, the model's own module first.
    """
    present(model, icon, *modules)
    model.guide = replace(model.guide, drawings=drawings, place=[loop(component)], signals=signals(), topics=TOPICS)
    model.ownership = Ownership(author=AUTHOR, version=VERSION, license="MIT", license_text=runtime_license())
    model.experiment = EXPERIMENT
    folder = REFERENCES / model.name
    if (folder / f"{model.name}_ref.opt").exists():
        model.reference_runs = [ReferenceRun.read(folder, model.name, f"{model.name} alone, driven so that it acts")]
    model.parameter_sets = parameter_sets(folder / f"{model.name}_sets.csv")


def publish_in_space(model: Model, component: str) -> None:
    """Let a published page say what is so in space alone: the sensor needs to know x, how the plant's tip is turned.

    Parameters
    ----------
    component
        Name of the component, which is the plant or the sensor.
    """
    guide = model.guide
    place, known = [loop(component, also_measured=("x",))], {**guide.signals, "x": Signal(PLANT, [SENSOR])}
    model.guide = replace(guide, place=place, signals=known)


def group_signals(model: Model, further: Mapping[str, Sequence[str]] | None = None) -> None:
    """Give a model of this project its terminals, and further ones, once its inputs and outputs are declared."""
    signals = {variable.name.partition("[")[0] for variable in model.with_role(Role.INPUT, Role.OUTPUT)}
    present = {
        terminal: [name for name in names if name in signals]
        for terminal, names in (TERMINALS | dict(further or {})).items()
    }
    model.terminals = {terminal: names for terminal, names in present.items() if names}


def parameter_sets(path: Path) -> list[ParameterSet]:
    """Read the table of a model's parameter sets; none if there is no table.

    Parameters
    ----------
    path
        CSV file. The first column holds the parameters. The head of each other column names the runs that its values
        are for, separated by blanks; the first of them names the set. An empty field leaves a parameter at its start.
    """
    if not path.exists():
        return []
    (_, *heads), *rows = csv.reader(path.read_text(encoding="utf-8").splitlines())
    sets = []
    for column, head in enumerate(heads, 1):
        variants = head.split()
        values = {row[0]: float(row[column]) for row in rows if row[column]}
        description = f"Parameters of the paper's runs {', '.join(variants)}"
        sets.append(ParameterSet(variants[0], values, description, variants))
    return sets
