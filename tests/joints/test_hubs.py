"""Claims of hubs: which body becomes one, and that a scene moves as it does without."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model import hubs
from crashsolve.model.build import build
from crashsolve.model.ledger import IMBALANCE, LARGEST
from crashsolve.system.engine import Engine


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
    "text, hubs", [(star(), 1), (star(hub_mass=5.0), 0), (star(ground=GROUND), 0)]
)
def test_the_heaviest_body_with_many_joints_and_no_ground_is_a_hub(
    tmp_path: Path, text: str, hubs: int
) -> None:
    deck = tmp_path / "star.yaml"
    deck.write_text(text, "utf-8")
    model, _ = build(read_deck(deck))
    assert int((model.saddle.columns["node"] > 0).sum()) == hubs
    assert model.saddle.rows() == 31 + 3 * ("held" in text)


@pytest.mark.parametrize(
    "text",
    [
        star(),
        # a hub that turns easily, and one of 1e9 times the mass: neither may cost digits
        star().replace("inertia: [3, 4, 5]", "inertia: [1e-6, 1e-6, 1e-6]"),
        star(hub_mass=1e9),
        star() + "  again: {type: revolute, a: hub, b: b_0, at: [1, 0, 0], axis: [0, 1, 0.3]}\n",
    ],
    ids=["star", "light", "heavy", "redundant"],
)
def test_a_hub_changes_no_motion(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    deck, runs = tmp_path / "star.yaml", []
    deck.write_text(text, "utf-8")
    # in this process, where the bound on rows can be another
    for least in (hubs.LEAST_ROWS, 1000):
        monkeypatch.setattr(hubs, "LEAST_ROWS", least)
        model, state = build(read_deck(deck))
        assert (model.saddle.columns["node"] > 0).any() == (least < 1000)
        engine = Engine(model, state)
        engine.start()
        engine.advance(1.0)
        engine.sample(1.0)
        assert abs(engine.ledger[IMBALANCE]) < 1e-5 * engine.ledger[LARGEST]
        rows = engine.rows
        # what the joints bear: of redundant ones only the sum is determined
        forces = (rows["D"] * rows["reaction"][:, None]).sum(axis=0)
        runs.append((engine.nodes["r"].copy(), engine.nodes["v"].copy(), forces))
    for one, other in zip(*runs, strict=True):
        # joints are closed to 1e-10 of 2 m, and forces are 1e6 times that, of some 100 N
        assert np.abs(one).max() > 1e-3
        np.testing.assert_allclose(one, other, atol=1e-6 * np.abs(other).max())
