"""An adaptation that diverges ends in an error that says where, with all rows before it, every one finite."""

import re
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from orchestration import SimulationError
from orchestration.cli.app import app
from tests.scenarios.adaptive import run, system

# Start values that diverge for every m2 within 1e-6 kg of 2.5 that was tried. At 1000 times its Gamma Fig. 5
# does so for three of four such starts: its sliding term F_c, or limits as in Fig. 7, may keep useless
# signals finite.
DIVERGENT = {
    "fig5-first": {"controller.Gamma[2]": 5e4},
    "spong-ortega-first": {"controller.Gamma[2]": 5e3},
}
# Component; time and step; the output or state that is no longer finite.
MESSAGE = re.compile(
    r"(?P<component>plant|controller): fmi2DoStep returned fmi2Error at t = (?P<time>\S+) s"
    r" \(step (?P<step>\d+)\); its last message:"
    r' "(Output|State) \w+(\[\d\])? is \S+ at t = .*"\.'
)
SIGNAL = re.compile(
    r"(?P<component>\w+)\.(?P<signal>\w+(\[\d\])?) is \S+ at t = (?P<time>\S+) s"
    r" \(row (?P<step>\d+)\); the run has diverged\."
    r" With allow_nan, --allow-nan, a run goes on\."
)


@pytest.mark.parametrize("name", DIVERGENT)
def test_a_thousand_times_the_gain_ends_in_an_error(name: str) -> None:
    given = system(name, DIVERGENT[name])
    with pytest.raises(SimulationError) as caught:
        run(given)
    match = MESSAGE.fullmatch(str(caught.value)) or SIGNAL.fullmatch(str(caught.value))
    assert match, str(caught.value)
    partial = caught.value.result
    assert partial is not None
    assert np.isfinite(partial.rows).all()
    assert partial.time.size > 100  # it ran for a while
    assert float(match["time"]) == pytest.approx(partial.time[-1], abs=1.5 * given.run_step())
    assert partial.rows.shape[0] == int(match["step"]) + ("row" not in match.re.pattern)
    assert np.abs(partial["controller.p_hat[2]"]).max() > 50  # kg: the rows show why


def test_an_estimate_without_inertia_is_named() -> None:
    """Projection onto p_min = 0 lets 1000 times the gain take m2 away altogether: H_hat is singular."""
    given = system("fig5-first", {"controller.Gamma[2]": 5e3, "controller.projection": 1})
    with pytest.raises(
        SimulationError, match=r"controller: .* at t = \S+ s \(step \d+\); .*H_hat is singular"
    ) as caught:
        run(given)
    partial = caught.value.result
    assert partial is not None
    assert np.isfinite(partial.rows).all()
    assert 0 < partial["controller.p_hat[2]"].min()  # the next one is zero
    # With a bound above zero the same gain is survived.
    bounded = run(given.set({"controller.p_min[2]": 0.1, "controller.p_max[2]": 5.0}))
    m2 = bounded["controller.p_hat[2]"]
    assert m2.min() == 0.1
    assert m2.max() <= 5.0


def test_the_file_of_a_diverged_run_has_no_nan(tmp_path: Path) -> None:
    settings = [f"--set={path}={value!r}" for path, value in DIVERGENT["fig5-first"].items()]
    out = tmp_path / "run.csv"
    finished = CliRunner().invoke(app, ["run", "fig5-first", "--out", str(out), *settings])
    assert finished.exit_code != 0
    kept = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert kept
    for path in kept:
        assert np.isfinite(np.genfromtxt(path, delimiter=",", skip_header=1)).all()


def test_limits_keep_a_wild_adaptation_finite() -> None:
    """Fig. 7 at 1000 times its gain: useless, but every row is finite and the torque within its limits."""
    given = system("fig7-first", {"controller.Gamma[2]": 4e3})
    limit = given.component("actuator").start["tau_max[1]"]
    result = run(given)
    assert np.isfinite(result.rows).all()
    assert np.abs(result["controller.p_hat[2]"]).max() > 50
    assert np.abs(result["actuator.tau[1]"]).max() == limit
