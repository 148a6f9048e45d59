"""Tests of events that none of the project's FMUs provokes: the runtime never hangs (rule 11)."""

from collections.abc import Callable
from pathlib import Path

import casadi as ca

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


def test_11_events_at_one_instant_are_all_seen(tmp_path: Path, create: Create) -> None:
    """Three indicators cross zero at t = 0.25 s: two with the same bits, the third in the other direction."""
    model = ContinuousModel("Together", "Changes three modes at one instant", dt_max=1.0)
    x, y = model.state("x", 0.0), model.state("y", 0.0)
    rising, twice, falling = (model.event(f"e{i}", z) for i, z in enumerate((x - 0.25, 2 * x - 0.5, 0.25 - x)))
    model.derivative(x, ca.SX(1.0))
    model.derivative(y, 1.0 * rising + 10.0 * twice + 100.0 * falling)
    model.output("y", y, description="Sum of the times in the modes")
    fmu = Binary(build(model, tmp_path, cache=tmp_path / "cache"), tmp_path / "unpacked")
    instance = create(fmu).initialize()
    assert instance.step(1.0) == OK
    # 11 for 0.75 s and 100 for 0.25 s; the crossing is located to 4 EPS of the sub-step of 1 s.
    assert abs(instance.get("y")[0] - (0.75 * 11 + 0.25 * 100)) <= 111 * 8 * 2.0**-52
