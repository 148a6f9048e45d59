"""Version, license and default experiment that all FMUs of this project state."""

from adaptimp_fmu import Experiment, Icon, Model, Ownership, present, runtime_license
from fmus import start

VERSION = "1"
STEP = 1e-4  # s, start of every sample_time and of the plant's dt_max
EXPERIMENT = Experiment(start_time=0.0, stop_time=start.PERIOD, step_size=STEP)


def publish(model: Model, icon: Icon, *modules: str) -> None:
    """Give a model of this project its icon, its documentation, its license and its default experiment.

    Parameters
    ----------
    modules
        Names of the modules whose docstrings hold the equations, the model's own module first.
    """
    present(model, icon, *modules)
    model.ownership = Ownership(version=VERSION, license="MIT", license_text=runtime_license())
    model.experiment = EXPERIMENT
