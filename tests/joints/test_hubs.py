"""Claims of hubs: which body becomes one, and that a scene moves as it does without."""

from pathlib import Path

import numpy as np
import pytest

from crashpost.results.result import Result
from crashsolve import run
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model import hubs
from crashsolve.model.build import build


def star(hub_mass: float = 50.0, ground: str = "") -> str:
    """A body with six others hinged to it, two of them with each other, thrown and spun."""
    bodies = f"  hub: {{mass: {hub_mass}, inertia: [3, 4, 5], angular_velocity: [1, 2, 3]}}\n"
    joints = ground
    for k in range(6):
        x, y = np.cos(k), np.sin(k)
        at = f"[{2 * x:.12f}, {2 * y:.12f}, 0]"
        v = f"[{-6 * y:.12f}, {6 * x:.12f}, {2 * y - 4 * x:.12f}]"
        bodies += (
            f"  b_{k}: {{mass: {k + 1}, inertia: [1, 1.1, 0.9], position: {at}, velocity: {v},"
            f" angular_velocity: [1, 2, 3]}}\n"
        )
        joints += (
            f"  j_{k}: {{type: revolute, a: hub, b: b_{k}, at: [{x:.12f}, {y:.12f}, 0],"
            f" axis: [{-y:.12f}, {x:.12f}, 0.3]}}\n"
        )
    return (
        "title: star\ncontrol: {end_time: 1, step: 1e-3, estimate: off}\n"
        f"bodies:\n{bodies}joints:\n{joints}"
        "  rod: {type: distance, a: b_0, b: b_1}\n"
    )


GROUND = "  held: {type: spherical, b: b_5, at: [0.567324370926, -1.917848549326, 0]}\n"


@pytest.mark.parametrize(
    "text, found", [(star(), 1), (star(hub_mass=5.0), 0), (star(ground=GROUND), 0)]
)
def test_the_heaviest_body_with_many_joints_and_no_ground_is_a_hub(
    tmp_path: Path, text: str, found: int
) -> None:
    deck = tmp_path / "star.yaml"
    deck.write_text(text, "utf-8")
    model, _ = build(read_deck(deck))
    assert int((model.saddle.columns["node"] > 0).sum()) == found
    assert model.saddle.rows() == 31 + 3 * ("held" in text)


def test_a_hub_changes_no_motion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    deck, found = tmp_path / "star.yaml", []
    deck.write_text(star(), "utf-8")
    for worth in (hubs.WORTH, 1000):
        monkeypatch.setattr(hubs, "WORTH", worth)
        result = Result(run(deck, tmp_path / str(worth)))
        names = ("rbdout.b_3.velocity.x", "rbdout.hub.position.z", "jntforc.j_2.force.y")
        found.append([result.series(name).values for name in names])
        assert np.abs(result.series("glstat.model.balance").values).max() < 1e-3
    for one, other in zip(*found, strict=True):
        # joints are closed to 1e-10 of 2 m, and forces are 1e6 times that, of some 100 N
        assert np.abs(one).max() > 1e-3
        np.testing.assert_allclose(one, other, atol=1e-6 * np.abs(other).max())
