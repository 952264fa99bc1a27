"""Claim: a model drawn at random ends within its bounds, or says why not; never anything else."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from command import crashsolve
from quick import first_quick
from random_models import Table, masses_of, model
from sweeps import REFUSED, STOPPED, outcome

from crashpost.results.result import Result

FEW, MANY = range(8), range(8, 38)
METHODS = [
    "rattle",
    "dormand_prince_5",
    "dormand_prince_8",
    "generalized_alpha",
    "radau_iia_5",
    "auto",
]
# share of the largest energy at which a run stops itself, and error at which joints count as closed
ENERGY, CLOSED = 5.0, 1e-10
# error that a step may make, of the model's size and largest speed, unless a deck says otherwise
TOLERANCE = 1e-6
# of the impulse of all weights and momenta: round-off of some 1e5 steps
MOMENTUM = 1e-10


def check_end(seed: int, folder: Path, integrator: str = "rattle") -> int:
    """Run one model; returns its exit code."""
    deck = folder / "deck.yaml"
    drawn = model(seed, integrator)
    deck.write_text(yaml.safe_dump(drawn, sort_keys=False), "utf-8")
    done = crashsolve(deck, "-o", folder / "out")
    ended = outcome(done.returncode, done.stderr, folder / "out", {})
    assert "Traceback" not in done.stderr and "Warning:" not in done.stderr, done.stderr
    assert ended.is_finite
    if done.returncode == 0:
        assert ended.balance <= ENERGY
        assert ended.residual <= CLOSED
        lost, flow, reach = momentum(Result(folder / "out"), drawn)
        allowed = MOMENTUM * flow
        # joints and equations are closed to within the error that a step may make
        allowed += 0.0 if integrator == "rattle" else ended.steps * TOLERANCE * reach
        # generalized-alpha weighs forces by its own recursion, and the ledger by the
        # trapezoidal rule: they differ by what a step does not follow
        assert lost <= allowed or integrator == "generalized_alpha"
    else:
        pattern = {2: REFUSED, 4: STOPPED}[done.returncode]
        assert pattern.search(done.stderr), done.stderr
    return done.returncode


def momentum(result: Result, drawn: Table) -> tuple[float, float, float]:
    """What is not accounted for, the impulse of all weights and momenta, mass at largest speed."""
    masses = masses_of(drawn)
    speed = {b: length(result, f"rbdout.{b}.velocity") for b in masses}
    spin = max(length(result, f"rbdout.{b}.angular_velocity").max() for b in masses)
    moving = sum(mass * speed[b] for b, mass in masses.items())
    total = sum(masses.values())
    share = abs(result.series("glstat.model.momentum_error").values) * np.maximum.accumulate(moving)
    flow = moving.max() + 9.81 * total * drawn["control"]["end_time"]
    # models are a few metres large: a turn counts at their size
    fastest = max(v.max() for v in speed.values()) + spin
    return float(share.max()), float(flow), float(total * fastest)


def length(result: Result, channel: str) -> np.ndarray:
    """Length of a vector at every sample."""
    return np.hypot.reduce([result.series(f"{channel}.{c}").values for c in "xyz"])


@pytest.mark.parametrize("seed", first_quick(FEW))
def test_a_model_drawn_at_random_ends_or_says_why_not(seed: int, tmp_path: Path) -> None:
    check_end(seed, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("integrator", METHODS)
def test_many_models_drawn_at_random_end_or_say_why_not(integrator: str, tmp_path: Path) -> None:
    ends = []
    for seed in MANY:
        folder = tmp_path / str(seed)
        folder.mkdir()
        ends.append(check_end(seed, folder, integrator))
    # most models are sound: a check that refuses or stops them all would prove nothing
    assert ends.count(0) > len(ends) / 3
