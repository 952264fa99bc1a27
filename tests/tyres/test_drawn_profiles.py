"""Claim: pictures show the profile that wheels roll on, and frame what rolls on it."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.renders.drawing import Scene
from crashpost.renders.painting import Appearance
from crashpost.results.states import States

SPEED, END, RADIUS = 20.0, 0.1, 0.3
# a ramp of 0.2 m over 1 m, in a frame of its own: distances count from x = 5 m against x
DECK = f"""
control: {{end_time: {END}, step: 1.0e-3, estimate: "off"}}
curves: {{ramp: {{points: [[-10, 0], [6, 0], [7, 0.2], [40, 0.2]], INTERPOLATION}}}}
bodies:
  wheel: {{mass: 15, inertia: [0.5, 0.9, 0.5], position: [1, 2, 0.3],
    velocity: [{-SPEED}, 0, 0]}}
tyres:
  t: {{type: gim, wheel: wheel, profile: {{curve: ramp, at: [5, 0, 0], along: [-1, 0, 0]}},
    radius: {RADIUS}, stiffness: 2.0e5, friction_max: 0.9, slip_stiffness: 8.0e4,
    cornering_stiffness: 6.0e4}}
"""


@pytest.mark.parametrize("interpolation", ["linear", "smooth"])
def test_a_profile_is_drawn_as_far_as_its_wheels_may_get(
    interpolation: str, tmp_path: Path
) -> None:
    deck, out = tmp_path / "deck.yaml", tmp_path / "out"
    deck.write_text(DECK.replace("INTERPOLATION", f"interpolation: {interpolation}"), "utf-8")
    done = crashsolve(deck, "-o", out)
    assert done.returncode == 0, done.stdout + done.stderr
    states = States(out)
    x, y, z = states.blocks["roads"].points.T
    s = 5.0 - x
    t = np.clip(s - 6.0, 0.0, 1.0)
    # a monotone cubic is level where its neighbours are
    rise = t if interpolation == "linear" else t * t * (3.0 - 2.0 * t)
    np.testing.assert_allclose(z, 0.2 * rise, atol=1e-12)
    # from behind the wheel to where it is at the end, and beyond both
    assert s.min() == pytest.approx(4.0 - 8.0 * RADIUS)
    assert s.max() == pytest.approx(4.0 + SPEED * END + 8.0 * RADIUS)
    # a profile has no sides: half as far to either side
    aside = 8.0 * RADIUS + 0.5 * np.ptp(s)
    assert (y.min(), y.max()) == pytest.approx((2.0 - aside, 2.0 + aside))
    scene = Scene(states, Appearance())
    # the picture holds the wheel alone
    assert np.ptp(scene.extent(0)[:, 0]) < 2.5 * RADIUS
    assert any(len(one.corners) and "#d8d3c8" in one.colours for one in scene.at(0).surfaces)


def test_the_last_point_of_a_profile_has_its_height(tmp_path: Path) -> None:
    deck, out = tmp_path / "deck.yaml", tmp_path / "out"
    text = DECK.replace("[40, 0.2]], INTERPOLATION", "[7.2, 0.3]], extrapolate: hold")
    deck.write_text(text.replace(f"end_time: {END}", "end_time: 0.2"), "utf-8")
    done = crashsolve(deck, "-o", out)
    assert done.returncode == 0, done.stdout + done.stderr
    x, _, z = States(out).blocks["roads"].points.T
    assert 5.0 - x.min() == pytest.approx(7.2)
    np.testing.assert_allclose(z[x == x.min()], 0.3, atol=1e-12)
