"""The broad phase finds exactly the pairs that comparing all with all finds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crashsolve.contact.broad import near_pairs


def brute(c: np.ndarray, r: np.ndarray, margin: float, c_b: np.ndarray, r_b: np.ndarray) -> set:
    gaps = np.linalg.norm(c[:, None] - c_b, axis=2) - r[:, None] - r_b
    return set(zip(*(index.tolist() for index in np.nonzero(gaps < margin)), strict=True))


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(0, 60),
    count_b=st.integers(0, 40),
    flat=st.sampled_from([(1.0, 1.0, 1.0), (10.0, 0.1, 1.0), (1.0, 0.0, 0.0)]),
    largest=st.sampled_from([0.02, 0.3, 3.0]),
)
def test_the_pairs_are_those_of_a_full_comparison(
    seed: int, count: int, count_b: int, flat: tuple[float, ...], largest: float
) -> None:
    rng = np.random.default_rng(seed)
    c, c_b = (rng.uniform(-1, 1, (n, 3)) * flat - 5.0 for n in (count, count_b))
    r, r_b = (rng.uniform(0, largest, n) for n in (count, count_b))
    margin = rng.uniform(0, 0.2)
    two_sets = near_pairs(c, r, margin, c_b, r_b)
    assert set(map(tuple, two_sets.tolist())) == brute(c, r, margin, c_b, r_b)
    one_set = near_pairs(c, r, margin)
    expected = {(i, j) for i, j in brute(c, r, margin, c, r) if i < j}
    assert set(map(tuple, one_set.tolist())) == expected
    for pairs in (one_set, two_sets):
        assert pairs.tolist() == sorted(pairs.tolist())


@pytest.mark.parametrize("spread", (1e-9, 1.0, 1e9))
def test_any_scale_of_space_will_do(spread: float) -> None:
    rng = np.random.default_rng(1)
    c, r = rng.uniform(-1, 1, (50, 3)) * spread, np.full(50, 0.1)
    pairs = near_pairs(c, r, 0.05)
    assert {tuple(p) for p in pairs.tolist()} == {
        (i, j) for i, j in brute(c, r, 0.05, c, r) if i < j
    }
