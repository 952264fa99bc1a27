"""Claim: many pairs in pieces act as pairs one by one, to the same bits on one thread or more."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from command import check_restart_after_signal, crashsolve, differences, gone_on, results

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.contact import pieces, records
from crashsolve.system.bounds import stiffest
from crashsolve.system.compose import compose
from crashsolve.system.engine import Engine
from crashsolve.threads.worker import MAX_PIECES

# a worker compiles the scene once
pytestmark = pytest.mark.xdist_group("threads")

ROOT = Path(__file__).parents[2] / "decks"
# two sleds of 33 x 32 points on a plane, which rubs on one and holds the other by bristles, under a
# third that is thrown onto four balls: a list of near pairs that is renewed
DECK = """
title: Sleds of points
control: {{threads: 2, end_time: 4e-3, step: 2e-5, check_every: 10}}
parameters: {{k: 2e4}}
bodies:
{bodies}
surfaces:
  floor: {{type: plane}}
{surfaces}
contacts:
  rubs:
    a: [slides]
    b: [floor]
    normal: {{type: kelvin_voigt, stiffness: "${{k}}", damping: 5}}
    friction: {{type: coulomb, friction_coefficient: 0.3, full_above: 0.1, none_below: 0.01}}
  holds:
    a: [sticks]
    b: [floor]
    normal: {{type: kelvin_voigt, stiffness: "${{k}}", damping: 5}}
    friction: {{type: bristle, stiffness: "${{k}}", static: 0.35, dynamic: 0.3}}
  rolls: {{a: {balls}, b: [flies], normal: {{type: hertz, stiffness: 1e7}}}}
loads: {{weight: {{type: gravity}}}}
output:
  history: {{interval: 2e-4}}
  states: {{interval: 1e-3}}
  restart: {{every: 1e-3}}
"""
POINTS = [[0.01 * i, 0.01 * j, -0.05] for i in range(-16, 17) for j in range(-16, 16)]


def deck_text() -> str:
    """The deck; its points are no matter of taste alone: one is lower than its neighbours."""
    sleds = {"slides": (0, 0.0512, 2), "sticks": (1, 0.0512, 0.2), "flies": (3, 0.2745, 3)}
    bodies = [
        f"  {name}: {{mass: 5, inertia: [0.02, 0.02, 0.03], position: [{x}, 0, {z}],\n"
        f"    velocity: [{v}, 0.3, -1], angular_velocity: [0.1, 0.2, 3]}}"
        for name, (x, z, v) in sleds.items()
    ]
    points = [[x, y, z - 1e-3 * (abs(x) < 0.001)] for x, y, z in POINTS]
    surfaces = [f"  {name}: {{type: point_set, body: {name}, points: {points}}}" for name in sleds]
    balls = [f"ball_{k}" for k in range(4)]
    for k, name in enumerate(balls):
        x, y = 2.9 + 0.2 * (k % 2), -0.1 + 0.2 * (k // 2)
        bodies.append(
            f"  {name}: {{primitive: {{shape: sphere, radius: 0.08, density: 3000}},\n"
            f"    position: [{x}, {y}, {0.14 + 5e-4 * k}]}}"
        )
        surfaces.append(f"  {name}: {{type: sphere, body: {name}, radius: 0.08}}")
    return DECK.format(bodies="\n".join(bodies), surfaces="\n".join(surfaces), balls=balls)


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The deck, and its results with two threads."""
    folder = tmp_path_factory.mktemp("pairs")
    deck = folder / "sleds.yaml"
    deck.write_text(deck_text(), "utf-8")
    done = crashsolve(deck, "-o", folder / "two")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "threads" in done.stdout
    return deck, folder / "two"


@pytest.mark.long
def test_all_contacts_of_the_scene_touch_and_their_pairs_are_many(two: tuple[Path, Path]) -> None:
    content = results(two[1])
    assert (content["history.h5:rcforc/peak_normal"].max(axis=0) > 0.0).all()
    model, _ = build(read_deck(two[0]))
    assert len(model.contact_groups) == 3
    assert all(group.in_pieces for group in model.contact_groups)
    assert [group.search is not None for group in model.contact_groups] == [False, False, True]
    assert all(len(group.pieces) > 1 for group in model.contact_groups[:2])
    # what a dump holds is another list than that of the start
    searched = model.contact_groups[2]
    assert len(content[f"dump:arrays/pairs/{searched.word}"]) > len(searched.parameters)


# beyond two, more than this machine has cores
@pytest.mark.parametrize("threads", [1, 3, 4, 8])
@pytest.mark.long
def test_any_number_of_threads_gives_the_same_bits(
    two: tuple[Path, Path], threads: int, tmp_path: Path
) -> None:
    deck, folder = two
    done = crashsolve(deck, "-o", tmp_path, "--set", f"control.threads={threads}")
    assert done.returncode == 0, done.stderr
    assert differences(tmp_path, folder) == []


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.long
def test_a_restart_with_other_threads_has_the_same_bits(
    two: tuple[Path, Path], threads: int, tmp_path: Path
) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(deck_text().replace("threads: 2", f"threads: {threads}"), "utf-8")
    assert "with other control.threads" in gone_on(other, two[1], tmp_path / "again")


@pytest.mark.long
def test_threads_stop_at_a_signal_and_continue(two: tuple[Path, Path], tmp_path: Path) -> None:
    threads = ("--set", "control.threads=3")
    check_restart_after_signal(*two, tmp_path / "cut", *threads)


@pytest.mark.long
def test_a_run_out_of_balance_stops_any_number_of_threads_alike(
    two: tuple[Path, Path], tmp_path: Path
) -> None:
    reported = set()
    for threads in "13":
        # what these steps miss is some thousand times more
        words = ("--set", "control.energy_limit=1e-9", "--set", f"control.threads={threads}")
        done = crashsolve(two[0], "-o", tmp_path / threads, *words)
        assert done.returncode == 4
        reported.add(done.stderr.replace(str(tmp_path / threads), ""))
    assert len(reported) == 1


# decks whose pairs are few, done in pieces of three pairs and two bodies: all shapes and laws
# of friction, sides that keep their faces, areas, onsets that cut steps
BATTERY = {
    "verification/contact/drops": 200,
    "verification/contact/edged_shapes": 60,
    "verification/contact/flat_on_flat": 60,
    "verification/contact/kept_face": 200,
    "verification/friction/bristle": 200,
    "verification/friction/coulomb": 200,
    "benchmark/box_stack": 40,
}


def after(deck: str, steps: int, threads: int) -> tuple[Any, list[str]]:
    """State of a deck after some steps, and what acts the stiffest on each of its bodies."""
    model, state = build(read_deck(ROOT / f"{deck}.yaml", {"control.threads": str(threads)}))
    engine = Engine(model, state)
    engine.start()
    engine._steps_per_call = steps
    clock = state.clock[0]
    clock["goal"], clock["pause"] = model.control[0]["end"], steps
    engine._advance(float(model.control[0]["end"]), False, engine._present)
    assert clock["cycle"] == steps
    return engine.state, [stiffest(engine, at) for at in range(1, len(model.bodies))]


# of the battery in the suite: friction with a history
FEW = ("verification/friction/bristle",)


@pytest.mark.long
@pytest.mark.parametrize(
    "deck", [pytest.param(d, marks=() if d in FEW else pytest.mark.long) for d in BATTERY]
)
def test_pieces_change_no_more_than_the_order_of_sums(
    deck: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps = BATTERY[deck]
    whole, causes = after(deck, steps, 1)
    monkeypatch.setattr(pieces, "MANY", 1)
    monkeypatch.setattr(pieces, "PAIRS", 3)
    monkeypatch.setattr(pieces, "BODIES", 2)
    (one, causes_of_one), (three, causes_of_three) = (after(deck, steps, n) for n in (1, 3))
    assert causes_of_one == causes_of_three == causes
    for name in ("nodes", "cards", "card_history", "clock"):
        assert getattr(one, name).tobytes() == getattr(three, name).tobytes(), name
    # what rests does so to the round-off of weights, which are worth so much speed a step
    still = 9.81 * float(one.clock[0]["step"])
    for name in ("r", "v", "w"):
        a, b = one.nodes[name], whole.nodes[name]
        # some hundred units in the last place for every step: many contacts add to one body
        assert np.abs(a - b).max() <= 1e-13 * steps * max(np.abs(b).max(), still), name
    for name in ("onsets", "touches"):
        assert (one.card_history[name] == whole.card_history[name]).all(), name


def test_few_pairs_are_not_cut_into_pieces() -> None:
    model, _ = build(read_deck(ROOT / "verification/friction/coulomb.yaml"))
    assert not any(group.in_pieces for group in model.contact_groups)
    assert "pair_forces_piece" not in compose(model)


def group_of(cards: list[int], nodes: list[tuple[int, int]]) -> Any:
    """What `cut` asks of a group."""
    rows = np.zeros(len(cards), records.PARAMETERS.dtype)
    rows["card"], rows["a"], rows["b"] = cards, range(len(cards)), range(len(cards))
    sides = [np.zeros(len(cards), [("node", int)]) for _ in "ab"]
    for side, numbers in zip(sides, zip(*nodes, strict=True), strict=True):
        side["node"] = numbers
    return SimpleNamespace(parameters=rows, elements_a=sides[0], elements_b=sides[1])


def test_every_pair_is_in_one_piece_of_its_card_and_every_load_on_one_body() -> None:
    rng = np.random.default_rng(1)
    cards = sorted(rng.integers(0, 4, 1000).tolist())
    nodes = [tuple(two) for two in rng.integers(0, 50, (1000, 2)).tolist()]
    group = group_of(cards, nodes)
    pieces.cut(group)
    pairs = [
        (k, piece["card"]) for piece in group.pieces for k in range(piece["first"], piece["end"])
    ]
    assert pairs == list(enumerate(cards))
    assert (group.pieces["end"] - group.pieces["first"] <= pieces.PAIRS).all()
    assert len(group.pieces) <= MAX_PIECES
    body = {at: b["node"] for b in group.loaded_bodies for at in range(b["first"], b["end"])}
    assert [body[at] for at in group.load_rows] == [node for two in nodes for node in two]
    assert sorted(group.load_rows) == list(range(2000))
    for b in group.loaded_bodies:
        # those of a body in the order of the pairs
        own = [load for load, at in enumerate(group.load_rows) if b["first"] <= at < b["end"]]
        assert [group.load_rows[load] for load in own] == list(range(b["first"], b["end"]))


def test_no_list_of_pairs_has_more_pieces_than_a_job_can(monkeypatch: pytest.MonkeyPatch) -> None:
    assert 2 * pieces.MAX_PIECES <= MAX_PIECES
    monkeypatch.setattr(pieces, "MAX_PIECES", 3)
    group = group_of([0] * 700 + [4] * 300, [(k, 7) for k in range(1000)])
    pieces.cut(group)
    # a third of all pairs, and no two cards in one piece
    assert group.pieces["first"].tolist() == [0, 334, 668, 700]
    assert group.pieces["end"].tolist() == [334, 668, 700, 1000]
    assert len(group.ranges) == 3


def test_threads_with_few_pairs_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "few.yaml"
    text = (ROOT / "tutorial/bouncing_ball.yaml").read_text("utf-8")
    path.write_text(text.replace("control: {", "control: {threads: 2, ", 1), "utf-8")
    with pytest.raises(DeckErrors, match=r"few.yaml:\d+.*threads: share .*leave it out"):
        build(read_deck(path))
