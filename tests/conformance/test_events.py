"""Events of the runtime that no FMU of ours provokes: checklist 11, never a hang."""

from collections.abc import Callable
from pathlib import Path

from adaptimp_fmu import ContinuousModel, build
from tests.conformance.binary import ERROR, OK, Binary, Instance

Create = Callable[..., Instance]


def relay(tmp_path: Path) -> Binary:
    """The law x' = u - 2 m with m = 1 while x > 0: for 0 < u < 2 it slides along x = 0, an event after the other."""
    model = ContinuousModel("Relay", "Slides along its switching line", dt_max=1e-3)
    u = model.input("u", 1.0, description="Drive")
    x = model.state("x", -0.5)
    mode = model.event("switch", x)
    model.derivative(x, u - 2 * mode)
    model.output("x", x, description="State")
    return Binary(build(model, tmp_path, cache=tmp_path / "cache"), tmp_path / "unpacked")


def test_11_a_model_that_chatters_is_an_error_not_a_hang(tmp_path: Path, create: Create) -> None:
    instance = create(relay(tmp_path)).initialize()
    assert instance.step(0.4) == OK
    assert instance.step(0.4) == ERROR
    assert "chatters" in instance.last


def test_11_as_many_events_as_a_step_may_have(tmp_path: Path, create: Create) -> None:
    """Two events in a step are nothing: up through zero at u = 3, down again at u = -1."""
    instance = create(relay(tmp_path)).initialize()
    for u in (3.0, -1.0, 3.0):
        assert instance.set({"u": u}) == OK
        assert instance.step(0.5) == OK
