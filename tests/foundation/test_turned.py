"""Rotation vectors between configurations: closed forms, also for no turn and for a sign of q."""

import numpy as np
import pytest

from crashsolve.foundation.orientation import products, rotated_by


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, np.pi / 2, 3.0])
def test_a_rotation_about_an_axis_is_found_again(angle: float) -> None:
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    rotation = np.array([[np.cos(angle / 2), *(np.sin(angle / 2) * axis)]])
    start = np.array([[0.5, 0.5, -0.5, 0.5]])
    after = products(rotation, start)
    # q and -q are the same configuration
    for q in (after, -after):
        np.testing.assert_allclose(rotated_by(q, start), [angle * axis], atol=1e-15)
