"""Which pairs are looked at: all, or the near ones, and what happens when the list is renewed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_runs import last, run

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.model.contact import pairs
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.model import Model, State
from crashsolve.system.engine import Engine

LAW = "normal: {type: hunt_crossley, stiffness: 1e6, restitution: 0.8}"


def heap(
    folder: Path,
    count: int,
    sides: str = "a: [NAMES], b: [NAMES]",
    extra: str = "",
    step_max: float = 1e-3,
) -> Path:
    """Balls on a jittered lattice, moving towards the middle."""
    rng = np.random.default_rng(1)
    bodies, surfaces, names = "", "", []
    for i in range(count):
        x = 0.23 * (np.array([i % 4, i // 4 % 4, i // 16]) - 1.5) + rng.uniform(-0.01, 0.01, 3)
        bodies += (
            f"  s{i}: {{mass: 1, inertia: [0.01, 0.01, 0.01], position: {x.tolist()},"
            f" velocity: {(-3.0 * x).tolist()}}}\n"
        )
        surfaces += f"  s{i}: {{type: sphere, body: s{i}, radius: {0.08 + 0.02 * (i % 2)}}}\n"
        names.append(f"s{i}")
    sides = sides.replace("NAMES", ", ".join(names))
    path = folder / "heap.yaml"
    path.write_text(
        f"title: heap\ncontrol: {{end_time: 0.5, step_max: {step_max}}}\n"
        f"bodies:\n{bodies}surfaces:\n{surfaces}{extra}"
        f"contacts:\n  balls: {{{sides}, {LAW}}}\n",
        "utf-8",
    )
    return path


def built(path: Path) -> tuple[Model, State]:
    return build(read_deck(path))


def test_a_few_pairs_are_all_kept_and_each_counts_once(tmp_path: Path) -> None:
    model, _ = built(heap(tmp_path, 10))
    (group,) = model.contact_groups
    pairs = list(zip(group.parameters["a"], group.parameters["b"], strict=True))
    assert group.search is None
    assert sorted(pairs) == [(i, j) for i in range(10) for j in range(i + 1, 10)]


@pytest.mark.parametrize(
    "sides, count",
    [
        ("a: [s0, s1, s2], b: [s3, s4]", 6),
        ("a: [s0, s1, s2], b: [s2, s3]", 5),
        ("a: [s0, s1, s2], b: [s1, s2]", 3),
        ("a: [s0, s0], b: [s1]", 1),
    ],
)
def test_a_pair_named_in_both_orders_counts_once(tmp_path: Path, sides: str, count: int) -> None:
    model, _ = built(heap(tmp_path, 5, sides))
    rows = model.contact_groups[0].parameters
    assert len({frozenset(p) for p in zip(rows["a"], rows["b"], strict=True)}) <= count
    assert len(rows) == count


@pytest.mark.parametrize(
    "sides, order", [("a: [floor, s0], b: [s1]", [-1]), ("a: [s0, s1], b: [s2, floor]", [1, 1])]
)
def test_a_mixed_card_sorts_its_pairs_by_kernel_and_side(
    tmp_path: Path, sides: str, order: list[int]
) -> None:
    model, _ = built(heap(tmp_path, 3, sides, "  floor: {type: plane, at: [0, 0, -5]}\n"))
    groups = {group.word: group.parameters for group in model.contact_groups}
    assert set(groups) == {"sphere_plane_hunt_crossley", "sphere_sphere_hunt_crossley"}
    # the ball always stands first in the gap, and the card's side a is where the order says
    assert groups["sphere_plane_hunt_crossley"]["order"].tolist() == order
    assert set(groups["sphere_sphere_hunt_crossley"]["order"].tolist()) == {1}


def test_many_pairs_are_searched_for_the_near_ones(tmp_path: Path) -> None:
    model, state = built(heap(tmp_path, 48))
    (group,) = model.contact_groups
    r, radius = state.nodes["r"][1:], group.elements_a["radius"]
    gap = np.linalg.norm(r[:, None] - r, axis=2) - radius[:, None] - radius
    assert group.search is not None
    near = np.argwhere(np.triu(gap < group.search.margin, 1))
    pairs = np.stack([group.parameters["a"], group.parameters["b"]], axis=1)
    assert pairs.tolist() == near.tolist()
    assert len(pairs) < 48 * 47 / 4


def test_a_renewed_list_keeps_the_histories_of_its_pairs(tmp_path: Path) -> None:
    model, state = built(heap(tmp_path, 48))
    (group,) = model.contact_groups
    current = int(state.clock[0]["current"])
    old = group.parameters.copy()
    marks = group.history[current]
    marks["dissipated"], marks["friction_dissipated"] = np.arange(len(old)) + 1.0, 0.5
    state.nodes["r"][5] += [0.0, 0.0, 9.0]
    state.nodes["r"][6] += [0.02, 0.0, 0.0]
    pairs.renew(model.contact_groups, state)
    kept = {(p["a"], p["b"]): h["dissipated"] for p, h in _rows(group, current)}
    left = 0.0
    for p, mark in zip(old, np.arange(len(old)) + 1.0, strict=True):
        if 4 in (p["a"], p["b"]):
            assert (p["a"], p["b"]) not in kept
            left += mark
        elif (p["a"], p["b"]) in kept:
            assert kept[p["a"], p["b"]] == mark
        else:
            left += mark
    for side in (0, 1):
        assert state.card_history[side, 0]["left_dissipated"] == left
    assert len(group.output) == len(group.parameters)


def _rows(group: ContactGroup, current: int) -> Any:
    return zip(group.parameters, group.history[current], strict=True)


@pytest.mark.xdist_group("runs")
@pytest.mark.long
def test_a_searched_run_has_the_bits_of_one_that_looks_at_all_pairs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every pair that ever touches was in the list in time."""
    outcomes = []
    for above in (500, 10**9):
        monkeypatch.setattr(pairs, "SEARCH_ABOVE", above)
        model, state = built(heap(tmp_path, 48))
        assert (model.contact_groups[0].search is not None) == (above == 500)
        engine = Engine(model, state)
        engine.start()
        engine.advance(0.4)
        engine.sample()
        outcomes.append((state.nodes["r"].copy(), state.nodes["v"].copy(), engine.ledger.copy()))
        onsets = int(state.card_history[0, 0]["onsets"])
        assert onsets > 100
    for searched, full in zip(*(f[:2] for f in outcomes), strict=True):
        np.testing.assert_array_equal(searched, full)
    # sums over the list in another order: round-off of some hundred terms
    np.testing.assert_allclose(outcomes[0][2], outcomes[1][2], rtol=1e-10, atol=1e-10)


@pytest.mark.long
@pytest.mark.xdist_group("runs")
def test_no_step_is_so_long_that_a_body_outruns_the_list(tmp_path: Path) -> None:
    """A fast ball from afar, with steps as long as the automatic control would take."""
    model, state = built(heap(tmp_path, 48, step_max=0.5))
    state.nodes["v"][1:] = 0.0
    state.nodes["r"][48], state.nodes["v"][48] = [0.3, 0.3, -30.0], [0.0, 0.0, 100.0]
    # the list of the build does not know of the ball's new place
    pairs.renew(model.contact_groups, state)
    engine = Engine(model, state)
    engine.start()
    engine.advance(0.5)
    assert int(state.card_history[0, 0]["onsets"]) > 0
    assert state.nodes["v"][48, 2] < 99.0


def spread(speed: float) -> dict[str, object]:
    """34 balls a metre apart, all of which might touch; the first two meet, the others rest."""
    scene: dict[str, Any] = {"bodies": {}, "surfaces": {}, "contacts": {}}
    for k in range(34):
        scene["bodies"][f"s{k}"] = {"mass": 1, "inertia": [0.01] * 3, "position": [k, 0, 0]}
        scene["surfaces"][f"s{k}"] = {"type": "sphere", "body": f"s{k}", "radius": 0.1}
    scene["bodies"]["s1"] |= {"position": [0.2001, 0, 0], "velocity": [-speed, 0, 0]}
    names = list(scene["surfaces"])
    rubber = {"young_a": 1e7, "poisson_a": 0.49, "density_a": 1000.0}
    law = {"type": "hunt_crossley", "restitution": 0.95} | rubber
    scene["contacts"]["balls"] = {"a": names, "b": names, "normal": law}
    return scene


def test_what_pairs_met_that_left_the_list_is_still_known(tmp_path: Path) -> None:
    # faster than 1e-5 sqrt(E/rho) = 1e-3 m/s, and 0.2 m apart at the end
    result = run(tmp_path, spread(2.0), 0.1)
    assert last(result, "rcforc.balls.onsets") == 1.0
    assert "contact 'balls': impact faster than" in result.log
    # mean radius 0.1 m, half of it the margin: nothing is nearer than that
    assert last(result, "rcforc.balls.depth") == pytest.approx(-0.05, rel=1e-15)
    assert last(result, "rcforc.balls.peak_depth") > 0.0


@pytest.mark.xdist_group("runs")
def test_an_onset_in_the_first_step_of_a_new_list_is_located(tmp_path: Path) -> None:
    model, state = built(heap(tmp_path, 48, step_max=0.5))
    (group,) = model.contact_groups
    assert group.search is not None
    slack = float(group.search.slack[0])
    state.nodes["v"][1:] = 0.0
    state.nodes["r"][1:] += np.arange(48)[:, None] * [10.0, 0.0, 0.0]
    # just too far apart for the list of the build
    gap = 2.01 * slack
    state.nodes["r"][2] = state.nodes["r"][1] + [0.18 + gap, 0.0, 0.0]
    state.nodes["v"][1:3, 0] = 1.0, -1.0
    pairs.renew(model.contact_groups, state)
    assert len(group.parameters) == 0
    engine = Engine(model, state)
    engine.start()
    # each goes 0.69 of the slack, which is not yet far, then a step of 0.2, then it is looked again
    engine.advance(0.69 * slack)
    engine.advance(0.5 * gap + 1e-5)
    assert len(group.parameters) == 1
    assert engine.clock.located == 1
    # from the onset on the step suits the contact; unlocated, it begins 0.17 of the slack deep
    assert state.card_history["peak_depth"][engine.clock.current, 0] < 2.1e-5


def test_parts_of_shapes_are_followed_by_their_own_points(tmp_path: Path) -> None:
    """Corners of boxes: followed by the box's middle, a list would be renewed for ever."""
    boxes = range(140)
    names = ", ".join(f"b{k}" for k in boxes)
    path = tmp_path / "boxes.yaml"
    path.write_text(
        "control: {end_time: 1}\nbodies:\n"
        + "".join(
            f"  b{k}: {{mass: 1, inertia: [1, 1, 1], position: [{k}, 0, 0]}}\n" for k in boxes
        )
        + "surfaces:\n  floor: {type: plane, at: [0, 0, -0.06]}\n"
        + "".join(f"  b{k}: {{type: box, body: b{k}, size: [0.1, 0.1, 0.1]}}\n" for k in boxes)
        + f"contacts:\n  hit: {{a: [{names}], b: [floor], normal: {{type: hertz, stiffness: 1}}}}\n"
    )
    model, state = build(read_deck(path))
    group = model.contact_groups[0]
    assert group.search is not None
    group.search.update(state.nodes)
    points = state.nodes["r"][group.elements_a["node"]] + group.elements_a["point"]
    np.testing.assert_allclose(group.search.references[0]["r"], points, atol=1e-15)
