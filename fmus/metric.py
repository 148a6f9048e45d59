"""The length L that turns radians into metres, as a parameter of FMUs whose task has angles."""

from adaptimp_fmu import POSITIVE, SampledModel
from fmus.mechanics.task import Metric, Task

LENGTH = 0.15  # m, assumed: about the size of what a hand holds


def declare_metric(model: SampledModel, task: Task) -> Metric:
    """Declare the parameter ``L`` if the task has angles; returns the metric.

    Examples
    --------
    >>> from adaptimp_fmu import SampledModel
    >>> from fmus.mechanics.task import Task
    >>> model = SampledModel("Sensor", "A sensor of forces and a moment")
    >>> metric = declare_metric(model, Task(positions=2, angles=1))
    >>> [variable.name for variable in model.variables], metric.L
    (['sample_time', 'L'], SX(L))
    """
    if not task.angles:
        return Metric(task)
    text = "Length that turns radians into metres, and moments into forces, in all norms"
    return Metric(task, model.parameter("L", LENGTH, unit="m", limits=POSITIVE, tunable=True, description=text))
