"""The search: what is tried, counted and put to the proof, with costs that a formula gives in the place of runs."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any, cast

import numpy as np
import pytest

from orchestration.paper import calibrate
from orchestration.paper.calibrations import FIRST, Setting
from orchestration.paper.studies.calibration import search as module
from orchestration.paper.studies.calibration.keeping import Proof
from orchestration.paper.studies.calibration.search import SCREEN, SEEDS, Found, Plan, Tried, search
from orchestration.paper.studies.calibration.space import SEARCHED, rounded, setting_at
from orchestration.paper.studies.open_values import EARLIER

BEST = np.linspace(0.3, 0.7, len(SEARCHED))
PLAN = Plan(anywhere=8, around=4, offspring=8, generations=60, proved=3)
KNOWN: tuple[Setting, ...] = (EARLIER, FIRST.values)


def formula(_: Any, shares: np.ndarray, seeds: Sequence[int]) -> Tried:
    """A cost that is least at `BEST`, and larger with one seed than with all."""
    cost = float(10 * ((shares - BEST) ** 2).sum()) - 0.5
    return Tried(shares, cost if len(seeds) > 1 else 1.1 * cost, cheaper=cost < 1, visibly_worse=cost > 0.5)


def proof(_: Any, setting: Setting, __: Executor) -> Proof:
    """A proof that a setting with a larger Psi of algorithm 1 keeps more often."""
    kept = int(setting["Psi_1"]) % 30
    return Proof(setting, 90.0, (600.0, 600.0), -0.1, {}, 30, kept, {}, 30, kept, {})


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Found, list[str]]]:
    monkeypatch.setattr(module, "tried_at", formula)
    monkeypatch.setattr(module, "prove", proof)
    said: list[str] = []
    with ThreadPoolExecutor(2) as pool:
        yield search(cast("Any", None), KNOWN, pool, said.append, PLAN), said


def test_it_counts_what_it_tries(found: tuple[Found, list[str]]) -> None:
    result, said = found
    assert result.looked_at == 2 + 2 * 4 + 8
    assert len(result.first_costs) == module.REPEATED
    assert 2 + module.STARTS < result.tried <= 2 + module.STARTS + 8 * 60
    assert 0 < result.held < result.tried
    assert result.both <= min(result.cheaper, result.visibly_worse)
    assert result.all_visibly == 0, "the formula makes Fig. 6 visibly worse only where a sentence breaks"
    assert said[-1].startswith("put 5 settings to the proof")


def test_it_finds_the_least_cost_and_proves_the_best_that_differ(found: tuple[Found, list[str]]) -> None:
    result, said = found
    best = float(said[-2].rpartition(" ")[2])
    assert best == pytest.approx(-0.5, abs=0.05)
    settings = [one.setting for one in result.proofs]
    assert len(settings) == len(KNOWN) + 3
    assert all(rounded(setting) == setting for setting in settings if setting not in KNOWN)
    assert [one.kept for one in result.proofs] == sorted((one.kept for one in result.proofs), reverse=True)


def test_known_settings_are_put_to_the_proof_once_and_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "tried_at", formula)
    monkeypatch.setattr(module, "prove", proof)
    with ThreadPoolExecutor(2) as pool:
        found = search(cast("Any", None), (*KNOWN, dict(FIRST.values)), pool, lambda _: None, PLAN)
    settings = [dict(one.setting) for one in found.proofs]
    assert all(settings.count(dict(setting)) == 1 for setting in KNOWN)
    assert len(settings) == len(KNOWN) + PLAN.proved


def test_a_setting_that_is_bad_with_one_seed_is_not_tried_with_more(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def bad(_: Any, shares: np.ndarray, seeds: Sequence[int]) -> Tried:
        asked.append(len(seeds))
        return Tried(shares, SCREEN + 1)

    monkeypatch.setattr(module, "tried_at", bad)
    assert module._screened(cast("Any", None), BEST).cost == SCREEN + 1 + module.SCREENED
    assert asked == [1]
    monkeypatch.setattr(module, "tried_at", formula)
    assert module._screened(cast("Any", None), BEST).cost == pytest.approx(-0.5)
    assert len(SEEDS) > 1


def test_a_run_that_fails_costs_more_than_all_else() -> None:
    from orchestration.errors import SimulationError

    class Fails:
        def run(self, *_: object) -> None:
            msg = "It diverged."
            raise SimulationError(msg)

    assert module.tried_at(cast("Any", Fails()), BEST, [1]).cost == module.FAILED
    assert setting_at(BEST)["Psi_1"] > 0


def test_a_page_needs_a_record(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["calibrate", "--page", "--folder", str(tmp_path)])
    with pytest.raises(SystemExit, match=r"calibration\.json is not there; --search --prove makes it\."):
        calibrate.main()
