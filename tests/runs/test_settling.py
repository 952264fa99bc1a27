"""Bodies that begin on others without any depth, and positions of origins."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from quick import first_quick
from small_runs import last

from crashpost.results.result import Result

BOX = """
title: a box stands on the ground without any depth
control: {{end_time: 0.02, estimate: "off"{more}}}
bodies:
  a:
    mass: 10
    primitive: {{shape: box, size: [0.2, 0.2, 0.2]}}
    position: [0, 0, {z}]
    velocity: [0, 0, {v}]
surfaces: {{a: {{type: box, body: a, size: [0.2, 0.2, 0.2]}}, f: {{type: plane}}}}
contacts: {{c: {{a: [a], b: [f], normal: {{type: hertz, stiffness: 1.0e+8}}}}}}
loads: {{g: {{type: gravity}}}}
"""
ADVICE = "contact 'c' begins without penetration"


@pytest.mark.parametrize(
    ("z", "v", "more", "is_advised"),
    first_quick(
        [
            (0.1, 0, "", True),
            (0.1001, 0, "", False),
            (0.1, -1, "", False),
            (0.1, 0, ", start: equilibrium", False),
        ],
        2,
    ),
)
def test_a_start_without_any_depth_is_advised_of(
    z: float, v: float, more: str, is_advised: bool, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(BOX.format(z=z, v=v, more=more), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout
    assert (ADVICE in done.stdout) == is_advised
    if more:
        # what is advised helps: at rest it bears m g alone
        force = Result(tmp_path / "out").series("rcforc.c.force.z").values
        assert np.abs(force - 98.1).max() < 1e-6 * 98.1


SPUN = """
title: a body turns about its mass centre
control: {end_time: 0.5, estimate: "off"}
bodies:
  a:
    mass: 2
    inertia: [1, 1, 1]
    mass_centre: [0.3, 0, 0]
    position: [1, 2, 3]
    velocity: [0, -0.6, 0]
    angular_velocity: [0, 0, 2]
  b: {mass: 1, inertia: [1, 1, 1], position: [5, 5, 5]}
"""


def test_the_origin_of_a_body_has_its_channel(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(SPUN, "utf-8")
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    result = Result(tmp_path / "out")
    # the mass centre, 0.3 m ahead, does not move; after 1 rad the origin is behind it on a circle
    assert last(result, "rbdout.a.position.x") == pytest.approx(1.3, abs=1e-12)
    # round-off of steps of second order at a constant spin
    assert last(result, "rbdout.a.origin.x") == pytest.approx(1.3 - 0.3 * np.cos(1.0), abs=1e-9)
    assert last(result, "rbdout.a.origin.y") == pytest.approx(2.0 - 0.3 * np.sin(1.0), abs=1e-9)
    assert last(result, "rbdout.b.origin.z") == 5.0
