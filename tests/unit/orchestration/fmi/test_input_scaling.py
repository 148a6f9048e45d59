"""Evidence for connections that scale: every algorithm gives what an FMU in other units gives.

`FineDecay` is `Decay` in units of 2**-10 m. Every conversion is a power of two, so a run with it is
the run without it, bit for bit, also where tolerances, iterations, polynomials and Jacobians are at
work: all of them see numbers in the unit of the source.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import Connection, Options, PowerBond, System, SystemDescriptionError, ledger, simulate
from orchestration.fmi.units import Unit, UnitDefinition, conversion
from orchestration.master.algorithm import DIRECTIONAL, NEWTON, PARALLEL, Algorithm, Correction, StepControl, Tolerance
from tests.unit.orchestration.small_models import H, mixed, system

FINE = 2.0**10  # fine units in a metre
LOOP = "a.y -> b.u\nb.y -> a.u"
ACCURATE = Tolerance(1e-9, {"m": 1e-9, "fine": 1e-9 * FINE})
ALGORITHMS = {
    "gauss-seidel": Algorithm("gauss-seidel"),
    "jacobi": Algorithm("jacobi", PARALLEL),
    "gauss-seidel of order 2": Algorithm("second", order=2),
    "jacobi of order 1": Algorithm("first", PARALLEL, order=1),
    "iterative": Algorithm("iterative", PARALLEL, correction=Correction(tolerance=ACCURATE)),
    "newton": Algorithm("newton", PARALLEL, order=1, correction=Correction(NEWTON, ACCURATE)),
    "directional": Algorithm("direct", PARALLEL, correction=Correction(NEWTON, ACCURATE, jacobian=DIRECTIONAL)),
    "adaptive": Algorithm("adaptive", order=1, control=StepControl(Tolerance(1e-4, {"m": 1e-4, "fine": 1e-4 * FINE}))),
}


def pair(fmus: dict[str, Path], second: str, factor: float | None = None) -> System:
    """Two decaying FMUs in a loop; the second one's state and output are made the same length."""
    coupled = system(fmus, {"a": "Decay", "b": second}, LOOP)
    start = 3.0 * (FINE if second.startswith("Fine") else 1.0)
    back = Connection("b", "y", "a", "u", None if factor is None else factor / FINE)
    there = Connection("a", "y", "b", "u", None if factor is None else factor * FINE)
    return replace(coupled.set({"b.z_start": start}), connections=(there, back))


@pytest.mark.parametrize("algorithm", list(ALGORITHMS))
def test_every_algorithm_sees_the_same_signals(strange: dict[str, Path], algorithm: str) -> None:
    plain = simulate(pair(strange, "Decay"), 2.0, H, ALGORITHMS[algorithm])
    fine = simulate(pair(strange, "FineDecay"), 2.0, H, ALGORITHMS[algorithm])
    np.testing.assert_array_equal(fine["a.y"], plain["a.y"])
    np.testing.assert_array_equal(fine["b.y"], FINE * plain["b.y"])
    assert np.ptp(plain["a.y"]) > 1  # m


def test_the_unit_behind_a_scale_is_the_unit_itself(strange: dict[str, Path]) -> None:
    """Offset and factor: u = 3 y + 1, against the same done by an FMU in between."""
    line = replace(
        system(strange, {"a": "Decay", "b": "Decay"}),
        connections=(Connection("a", "y", "b", "u", 3.0, 1.0),),
    )
    with pytest.warns(UserWarning, match=r"a\.u"):
        result = simulate(line, 1.0, H)
    z = 8.0  # z_start of b; explicit: y = z + u / 4
    assert result["b.y"][0] == z + (3 * result["a.y"][0] + 1) / 4
    assert str(line.connections[0]) == "a.y -> b.u (factor 3.0, offset 1.0)"


def test_a_linear_verdict_sees_the_same_loop(strange: dict[str, Path]) -> None:
    plain, fine = (pair(strange, second).stability(H).radius for second in ("Decay", "FineDecay"))
    assert fine == pytest.approx(plain, rel=1e-9)  # identification moves inputs by amounts relative to them
    stronger = pair(strange, "FineDecay", factor=1.5).stability(H).radius
    assert abs(stronger - plain) > 1e-3


def test_a_system_without_scales_runs_the_units_own_functions(small: dict[str, Path]) -> None:
    from orchestration.master.initialization import opened

    with opened(mixed(small)) as instances:
        assert [instance.scaled for instance in instances] == [None] * 4


@pytest.mark.parametrize(
    ("connection", "message"),
    [
        (Connection("source", "n", "relay", "n", 2.0), r"source\.n -> relay\.n .*n is of type Integer; only Reals"),
        (Connection("source", "even", "relay", "even", 1.0, 1.0), "even is of type Boolean; only Reals"),
        (Connection("source", "u", "relay", "u", float("inf")), "factor and offset must be finite"),
        (Connection("source", "u", "relay", "u", 1.0, float("nan")), "factor and offset must be finite"),
    ],
)
def test_scales_that_make_no_sense_are_refused(small: dict[str, Path], connection: Connection, message: str) -> None:
    plain = system(small, {"source": "Source", "relay": "Relay"})
    with pytest.raises(SystemDescriptionError, match=message):
        replace(plain, connections=(connection,))


K, CELSIUS = UnitDefinition("K", Unit((("K", 1),))), UnitDefinition("degC", Unit((("K", 1),), 1.0, 273.15))
FAHRENHEIT = UnitDefinition("degF", Unit((("K", 1),), 5 / 9, 273.15 - 32 * 5 / 9))
M, MM = UnitDefinition("m", Unit((("m", 1),))), UnitDefinition("mm", Unit((("m", 1),), 1e-3))


@pytest.mark.parametrize(
    ("source", "target", "relative", "found"),
    [
        (MM, M, False, (1e-3, 0.0)),
        (M, MM, False, (1 / 1e-3, 0.0)),
        (CELSIUS, K, False, (1.0, 273.15)),
        (CELSIUS, K, True, (1.0, 0.0)),
        (M, K, False, None),
        (M, UnitDefinition("m", None), False, (1.0, 0.0)),
        (M, UnitDefinition("metre", None), False, None),
        (M, UnitDefinition("metre", M.meaning), False, (1.0, 0.0)),
        (M, UnitDefinition("m", MM.meaning), False, (1 / 1e-3, 0.0)),
        (None, M, False, (1.0, 0.0)),
    ],
)
def test_conversions(
    source: UnitDefinition | None, target: UnitDefinition | None, relative: bool, found: tuple[float, float] | None
) -> None:
    assert conversion(source, target, relative=relative) == found


def test_a_conversion_with_factor_and_offset() -> None:
    """Water boils at 100 degC, which is 212 degF: to the rounding of numbers near 373 K."""
    factor, offset = conversion(CELSIUS, FAHRENHEIT) or (0, 0)
    assert factor * 100 + offset == pytest.approx(212, abs=4 * 373 * 2.3e-16 * 9 / 5)


def test_options_are_those_of_any_run(strange: dict[str, Path]) -> None:
    result = simulate(pair(strange, "FineDecay"), 1.0, H, options=Options(record=("b.y",)))
    assert result.names == ("b.y",)
    assert result.units["b.y"] == "fine"


def test_power_through_a_gain_is_not_counted(strange: dict[str, Path]) -> None:
    doubled = pair(strange, "FineDecay", factor=2.0)
    with pytest.raises(SystemDescriptionError, match=r"a\.y -> b\.u \(factor 2048\.0, offset 0\.0\) changes the value"):
        ledger(simulate(doubled, 1.0, H), PowerBond("a.y", "b.y"), doubled)
