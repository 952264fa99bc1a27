"""Claim: an onset is where sides overlap; those with a gap of exactly nothing have not met."""

import pytest

from crashsolve.system.onset import narrow_bracket, new_bracket

STEP = 1e-4


@pytest.mark.parametrize("parted", [-1e-9, 0.0])
def test_a_search_ends_beyond_the_onset(parted: float) -> None:
    # before 0.6 of the step sides are apart, or with a gap of exactly nothing: two bodies that move
    # on side by side, to whom a third comes. To end there is to search again for ever
    def gap(trial: float) -> float:
        return max(parted, 10.0 * (trial - 0.6 * STEP))

    early, late, _, _, _, count = new_bracket(STEP)
    allowed = 1e-9
    bracket = early, late, parted, gap(STEP), allowed, count
    trial, is_located = STEP, False
    for _ in range(100):
        tried = trial
        bracket, trial, is_located = narrow_bracket(bracket, STEP, tried, gap(tried))
        if is_located:
            break
    assert is_located
    assert 0.0 < gap(tried) <= allowed
