"""Claim: shells that have passed through themselves are found and named, others are not."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from crashsolve.simulation.self_penetration import passed, shells_through_themselves

SIDE = 20


def strip(x: np.ndarray, z: np.ndarray, triangles: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """A strip of SIDE x SIDE elements along a curve, one metre wide, slightly oblique."""
    n = SIDE + 1
    across = np.linspace(0.0, 1.0, n)
    points = np.stack(
        [
            np.repeat(x, n) + 0.003 * np.tile(across, n),
            np.tile(across, n) + 0.001 * np.repeat(np.arange(n), n),
            np.repeat(z, n),
        ],
        axis=1,
    )
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    quads = np.stack([a, b, c, d], axis=1)
    if triangles:
        quads = np.concatenate([np.stack([a, b, c, c], 1), np.stack([a, c, d, d], 1)])
    return points, quads


def loop(half_width: float) -> tuple[np.ndarray, np.ndarray]:
    """The curve x = u^3 - w u, z = u^2, whose branches meet at u = +- sqrt(w) if w > 0."""
    u = np.linspace(-1.03, 1.0, SIDE + 1)
    return u**3 - half_width * u, u**2


@pytest.mark.parametrize("triangles", [False, True])
def test_a_strip_passes_through_itself_where_its_curve_does(triangles: bool) -> None:
    x, quads = strip(*loop(0.4), triangles)
    crossing = np.flatnonzero(passed(x, quads))
    assert len(crossing) >= 5
    # only elements at the height of the point where both branches meet, z = 0.4
    heights = x[quads[crossing]][:, :, 2]
    assert (heights.min(axis=1) < 0.4).all() and (heights.max(axis=1) > 0.4).all()
    x, quads = strip(*loop(-0.01), triangles)
    assert not passed(x, quads).any()


def test_a_spiral_whose_turns_do_not_touch_passes_through_nothing() -> None:
    angle = np.linspace(0.0, 12.0, SIDE + 1)
    x, quads = strip((1.0 + 0.1 * angle) * np.cos(angle), (1.0 + 0.1 * angle) * np.sin(angle))
    assert not passed(x, quads).any()


def engine(start: np.ndarray, now: np.ndarray, quads: np.ndarray, **changes: Any) -> Any:
    """What is read of a run with one part."""
    mesh = SimpleNamespace(points=start, quads=quads)
    group = SimpleNamespace(names=["wall"], output={"deleted": [changes.get("deleted", 0)]})
    contact = SimpleNamespace(
        is_self_contact=True, card="folds", arrays={"p": np.array([(0,)], [("first_own", int)])}
    )
    model = SimpleNamespace(
        elements=SimpleNamespace(parts={"wall": SimpleNamespace(mesh=mesh, first=0)}),
        element_groups=lambda: [group],
        nodal_groups=[contact] if changes.get("touches") else [],
    )
    return SimpleNamespace(model=model, state=SimpleNamespace(points={"r": now}))


def test_the_part_is_named_with_what_helps() -> None:
    flat, quads = strip(np.linspace(0.0, 3.0, SIDE + 1), np.zeros(SIDE + 1))
    crossed = strip(*loop(0.4))[0]
    (text,) = shells_through_themselves(engine(flat, crossed, quads))
    assert text.startswith("part 'wall': ") and "self_contact: true" in text
    (text,) = shells_through_themselves(engine(flat, crossed, quads, touches=True))
    assert "'folds' keeps its nodes from its faces" in text and "smaller elements" in text
    # as at the start, flat, and with elements that are gone
    assert not shells_through_themselves(engine(crossed, crossed, quads))
    assert not shells_through_themselves(engine(crossed, flat, quads))
    assert not shells_through_themselves(engine(flat, crossed, quads, deleted=3))
