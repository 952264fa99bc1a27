"""Many balls and the walls of a box: only the pairs near a wall at rest are looked at."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.model import State

LAW = "{type: hunt_crossley, stiffness: 1e6, restitution: 0.8}"


def boxed(folder: Path, count: int, body: str) -> tuple[ContactGroup, State]:
    """Balls of 0.1 m at random in a box of 4 m, whose walls are fixed in `body`."""
    rng = np.random.default_rng(1)
    lines = ["title: box", "control: {end_time: 1}", "bodies:"]
    lines.append("  cart: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}")
    for i in range(count):
        at = rng.uniform(-1.9, 1.9, 3).tolist()
        lines.append(f"  s{i}: {{mass: 1, inertia: [1, 1, 1], position: {at}}}")
    lines.append("surfaces:")
    lines += [f"  s{i}: {{type: sphere, body: s{i}, radius: 0.1}}" for i in range(count)]
    for k, (axis, sign) in enumerate([(0, 1), (0, -1), (1, 1), (1, -1), (2, 1)]):
        normal = [float(sign * (axis == c)) for c in range(3)]
        at = [-2.0 * x for x in normal]
        lines.append(f"  wall{k}: {{type: plane, body: {body}, at: {at}, normal: {normal}}}")
    balls = ", ".join(f"s{i}" for i in range(count))
    walls = ", ".join(f"wall{k}" for k in range(5))
    lines.append(f"contacts:\n  walls: {{a: [{walls}], b: [{balls}], normal: {LAW}}}")
    path = folder / "box.yaml"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    model, state = build(read_deck(path))
    return model.contact_groups[0], state


def test_the_pairs_are_those_whose_gap_is_below_the_margin(tmp_path: Path) -> None:
    group, state = boxed(tmp_path, 200, "ground")
    r = state.nodes["r"][group.elements_a["node"]]
    walls = group.elements_b
    gap = np.array([(r - w["point"]) @ w["normal"] for w in walls]).T - 0.1
    near = np.argwhere(gap < group.search.margin)
    pairs = np.stack([group.parameters["a"], group.parameters["b"]], axis=1)
    assert pairs.tolist() == near.tolist()
    # of 1000 possible ones
    assert 0 < len(pairs) < 250


@pytest.mark.parametrize(("count", "body"), [(200, "cart"), (36, "ground")])
def test_walls_that_move_and_few_balls_keep_all_pairs(
    tmp_path: Path, count: int, body: str
) -> None:
    group, _ = boxed(tmp_path, count, body)
    assert group.search is None
    assert len(group.parameters) == 5 * count
