"""Claim: over every range of the stability matrix a run ends within its bounds, or says why not."""

from pathlib import Path

import pytest
import yaml
from command import crashsolve
from extreme_cases import MATRIX
from long_chains import chain
from page import HEAD
from sweeps import Sweep, run

ROOT = Path(__file__).resolve().parents[2]
QUICK = [
    pytest.param(sweep, value, id=f"{sweep.name}-{value:g}")
    for sweep in MATRIX
    for value in sweep.quick
]
ALL = [
    pytest.param(sweep, method, id=f"{sweep.name}-{method}")
    for sweep in MATRIX
    for method in sweep.integrators
]


@pytest.mark.parametrize("sweep, value", QUICK)
def test_an_extreme_case_stays_within_its_bounds(
    sweep: Sweep, value: float, tmp_path: Path
) -> None:
    outcome = run(sweep, value, sweep.integrators[0], tmp_path, plain=True)
    assert not outcome.faults(sweep)


@pytest.mark.long
@pytest.mark.parametrize("sweep, method", ALL)
def test_a_range_stays_within_its_bounds(sweep: Sweep, method: str, tmp_path: Path) -> None:
    faults = {}
    for value in sweep.values:
        faults_of_run = run(sweep, value, method, tmp_path / f"{value:g}", plain=False).faults(
            sweep
        )
        if faults_of_run:
            faults[value] = faults_of_run
    assert not faults


@pytest.mark.long
def test_a_step_too_long_for_the_tension_of_a_chain_is_reported(tmp_path: Path) -> None:
    """No law states the automatic step of it, and the energy does not: the pull is wrong by 22
    %.
    """
    deck = tmp_path / "chain.yaml"
    deck.write_text(yaml.safe_dump(chain(300), sort_keys=False), "utf-8")
    # without `rattle` the default method chooses its steps by error, and has the right pull
    words = ["--set", "control.step=auto", "--set", "control.integrator=rattle"]
    done = crashsolve(deck, "-o", tmp_path / "out", *words)
    assert done.returncode == 0
    assert "the step may be too long for their forces" in done.stdout + done.stderr


def test_every_extreme_deck_is_in_the_matrix() -> None:
    decks = {path.stem for path in (ROOT / "decks" / "extreme").glob("*.yaml")}
    assert decks <= {sweep.path.stem for sweep in MATRIX}


def test_the_page_names_every_case_of_the_matrix() -> None:
    text = (ROOT / "solver" / "STABILITY.md").read_text("utf-8")
    missing = [sweep.case for sweep in MATRIX if f"| {sweep.case} |" not in text]
    assert not missing, "STABILITY.md is stale: make stability"
    assert text.startswith(HEAD)
