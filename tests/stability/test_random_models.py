"""Claim: a model drawn at random ends within its bounds, or says why not; never anything else."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from command import crashsolve
from random_models import Table, model
from sweeps import REFUSED, STOPPED, outcome

from crashpost.result import Result

FEW, MANY = range(8), range(8, 308)
# share of the largest energy at which a run stops itself, and error at which joints count as closed
ENERGY, CLOSED = 5.0, 1e-10
# of the impulse of all weights and momenta: round-off of some 1e5 steps
MOMENTUM = 1e-10


def judge(seed: int, folder: Path, integrator: str = "rattle") -> int:
    """Run one model; returns its exit code."""
    deck = folder / "deck.yaml"
    drawn = model(seed, integrator)
    deck.write_text(yaml.safe_dump(drawn, sort_keys=False), "utf-8")
    done = crashsolve(deck, "-o", folder / "out")
    found = outcome(done.returncode, done.stderr, folder / "out", {})
    assert "Traceback" not in done.stderr and "Warning:" not in done.stderr, done.stderr
    assert found.is_finite
    if done.returncode == 0:
        assert found.balance <= ENERGY
        assert found.residual <= CLOSED
        assert momentum_error(Result(folder / "out"), drawn) <= MOMENTUM
    else:
        pattern = {2: REFUSED, 4: STOPPED}[done.returncode]
        assert pattern.search(done.stderr), done.stderr
    return done.returncode


def momentum_error(result: Result, drawn: Table) -> float:
    """Momentum not accounted for over the impulse of all weights and the largest momenta."""
    moving = sum(
        card["mass"]
        * np.hypot.reduce([result.series(f"rbdout.{b}.velocity.{c}").values for c in "xyz"])
        for b, card in drawn["bodies"].items()
    )
    weight = 9.81 * sum(card["mass"] for card in drawn["bodies"].values())
    share = abs(result.series("glstat.model.momentum_error").values) * np.maximum.accumulate(moving)
    return float(share.max() / (moving.max() + weight * drawn["control"]["end_time"]))


@pytest.mark.parametrize("seed", FEW)
def test_a_model_drawn_at_random_ends_or_says_why_not(seed: int, tmp_path: Path) -> None:
    judge(seed, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("integrator", ["rattle", "dormand_prince_5"])
def test_many_models_drawn_at_random_end_or_say_why_not(integrator: str, tmp_path: Path) -> None:
    ends = []
    for seed in MANY:
        folder = tmp_path / str(seed)
        folder.mkdir()
        ends.append(judge(seed, folder, integrator))
    # most models are sound: a check that refuses or stops them all would prove nothing
    assert ends.count(0) > len(ends) / 3
