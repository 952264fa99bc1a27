"""Claim: in a battery of known answers, 95 % of the estimated errors are within a factor of 10."""

import sys
from pathlib import Path

import pytest

BATTERY = Path(__file__).resolve().parents[2] / "benchmarks" / "estimates"
# what the project promises of its estimates
RUNS, SHARE = 200, 0.95


@pytest.mark.long
def test_estimates_are_near_true_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BATTERY))
    for name in ("battery", "scenes", "closed_forms"):
        sys.modules.pop(name, None)
    import battery

    runs = battery.run_all()
    reported = battery.table(runs)
    print(reported)
    # a run counts when one of its numbers has an error above round-off
    counted = [run for run in runs if any(number.counts for number in run)]
    assert len(counted) >= RUNS
    assert battery.share([n for run in counted for n in run if n.counts]) >= SHARE, reported
    # and no method hides behind the others
    for method in {run[0].method for run in counted}:
        selected = [n for run in counted for n in run if n.counts and n.method == method]
        assert battery.share(selected) >= SHARE, reported
