"""Pairs that are left alone until they may have met: the same results as without, bit for bit."""

import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.recording.changing import changing
from crashsolve.recording.histories import Histories
from crashsolve.recording.resampling import Resampling
from crashsolve.system.engine import Engine

SHAPES = {
    "box": {"type": "box", "size": [0.2, 0.12, 0.08]},
    "egg": {"type": "ellipsoid", "semi_axes": [0.1, 0.06, 0.05]},
    "ball": {"type": "sphere", "radius": 0.07},
}

# of a run, each of which looks for the deepest pair of every card
SAMPLES = 40
# sums over pairs of a card, in an order that depends on which of them are left alone
LOSSES = ("dissipated", "friction_dissipated")
# times of a card that follow from its releases [s]
TIMED = ("last_release", "lasted", "duration")


def tumbling(folder: Path, seed: int, count: int = 9) -> Path:
    """Bodies of three shapes fall on a floor and on each other, spinning fast."""
    rng = np.random.default_rng(seed)
    bodies, surfaces = {}, {"floor": {"type": "plane"}}
    for k in range(count):
        shape = list(SHAPES)[k % len(SHAPES)]
        bodies[f"b{k}"] = {
            "mass": 1.0,
            "inertia": [2e-3, 4e-3, 5e-3],
            "position": [float(0.05 * rng.normal()), float(0.05 * rng.normal()), 0.3 + 0.3 * k],
            "velocity": [0.0, 0.0, float(-4.0 * rng.random())],
            "angular_velocity": [float(w) for w in rng.normal(0.0, 20.0, 3)],
        }
        # some off the mass centre
        surfaces[f"s{k}"] = SHAPES[shape] | {"body": f"b{k}", "at": [0.02 * (k // 3), 0.0, 0.0]}
    names = [f"s{k}" for k in range(count)]
    law = {"type": "exact_restitution", "stiffness": 1e6, "restitution": 0.6}
    slip = {"type": "coulomb", "friction_coefficient": 0.3, "none_below": 0.0, "full_above": 0.05}
    deck = {
        "title": "Tumbling",
        "control": {"end_time": 0.5, "energy_limit": "off", "estimate": "off"},
        "bodies": bodies,
        "surfaces": surfaces,
        "contacts": {
            "floor": {"a": names, "b": ["floor"], "normal": law, "friction": slip},
            "each_other": {"a": names, "b": names, "normal": law, "friction": slip},
        },
        "loads": {"weight": {"type": "gravity"}},
    }
    path = folder / f"tumbling_{seed}.yaml"
    path.write_text(yaml.safe_dump(deck))
    return path


NUMBER = re.compile(r"-?\d+\.?\d*(?:e[-+]\d+)?")


def outcome(path: Path) -> tuple[dict[str, bytes | str], np.ndarray, np.ndarray, np.ndarray]:
    """What bodies, energies, touches and contact cards come to; depths of all
    pairs [m]; TIMED; LOSSES.
    """
    deck = read_deck(path, {})
    model, state = build(deck)
    engine = Engine(model, state)
    engine.start()
    sampled = []
    for k in range(1, SAMPLES + 1):
        engine.advance(deck.control.end_time * k / SAMPLES)
        engine.sample()
        sampled.append(state.cards.copy())
    outcome_of_tables = {name: state.nodes[name].tobytes() for name in ("r", "q", "v", "L")}
    # the deepest pair is looked for where a pair touches, so a release is timed by that pair alone
    exact = [c for c in state.card_history.dtype.names if c not in ("deepest", *TIMED)]
    kept = state.card_history[exact]
    cards = np.array(sampled)
    bits = [name for name in cards.dtype.names if name not in LOSSES]
    outcome_of_tables |= {"cards": repr(cards[bits].tolist()), "card_history": repr(kept.tolist())}
    losses = np.array([cards[name] for name in LOSSES])
    times = np.array([state.card_history[name] for name in TIMED])
    depths = []
    for group in model.contact_groups:
        outcome_of_tables[f"{group.word}.force"] = group.output["force"].tobytes()
        for name in ("active", "dissipated", "friction_dissipated"):
            outcome_of_tables[f"{group.word}.{name}"] = group.history[name].tobytes()
        depths.append((group.history["depth"] + moved_since(group)).ravel())
    outcome_of_tables |= {"ledger": state.ledger.tobytes(), "clock": state.clock.tobytes()}
    return outcome_of_tables, np.concatenate(depths), times, losses


def assert_same(one: dict[str, bytes | str], other: dict[str, bytes | str]) -> None:
    """Equal, but for round-off: code that differs may contract other products (COMPILER.md).

    Some twenty impacts of tumbling bodies multiply 1e-16 by up to 1e5; 2e-12 is seen.
    """
    assert one.keys() == other.keys()
    for name, value in one.items():
        if name.endswith(".active"):
            assert value == other[name], name
        else:
            a, b = numbers(value), numbers(other[name])
            np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-11 * np.abs(a).max(), err_msg=name)


def numbers(value: bytes | str) -> np.ndarray:
    """Numbers of a table, of its bytes or as they are written."""
    if isinstance(value, bytes):
        return np.frombuffer(value)
    return np.array([float(word) for word in NUMBER.findall(value)])


def moved_since(group: ContactGroup) -> np.ndarray:
    """How far the bodies of each pair have approached each other since its depth was noted [m]."""
    both = group.body_pairs
    if both is None:
        return np.zeros(len(group.parameters))
    return np.repeat(both["skipped"] * both["approached"], both["end"] - both["first"])


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2])
def test_pairs_of_two_bodies_rest_together_as_each_would(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tumbling(tmp_path, seed)
    together, bounds, *_ = outcome(path)
    monkeypatch.setattr("crashsolve.model.build.find_body_pairs", lambda groups: None)
    apart, depths, *_ = outcome(path)
    assert_same(together, apart)
    assert (bounds != depths).any()


@pytest.mark.long
def test_pairs_left_alone_change_round_off_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tumbling(tmp_path, 1)
    state, bounds, times, losses = outcome(path)
    monkeypatch.setattr(ContactGroup, "skips", property(lambda group: False))
    looked_at, depths, same_times, same_losses = outcome(path)
    assert_same(state, looked_at)
    # nine bodies on a floor and on each other: a sum of some forty pairs in another order
    np.testing.assert_allclose(losses, same_losses, rtol=40 * 2.0**-52)
    # a release is known to a part of a step, of 1e-4 s
    np.testing.assert_allclose(times, same_times, rtol=0.0, atol=1e-5)
    # of some pairs no more is known than a bound, which is one; round-off of its sum
    assert (bounds >= depths - 1e-12).all()
    assert (bounds > depths).any()


def eggs(folder: Path, speeds: tuple[float, float] = (0.0, 0.0)) -> Path:
    """Two eggs over a table, 0.95 m above it, that spin and fall at given speeds [m/s]."""
    bodies = {
        f"b{k}": {
            "mass": 1.0,
            "inertia": [1, 1, 1],
            "position": [k, 0, 1],
            "velocity": [0, 0, -speed],
            "angular_velocity": [20.0 * speed, 5.0 * speed, 0],
        }
        for k, speed in enumerate(speeds)
    }
    shapes = {f"s{k}": SHAPES["egg"] | {"body": f"b{k}"} for k in (0, 1)}
    table = {"type": "box", "size": [9.0, 9.0, 1.0], "at": [0.0, 0.0, -0.5]}
    card = {"a": ["s0", "s1"], "b": ["table"], "normal": {"type": "hertz", "stiffness": 1e6}}
    deck = {
        "title": "Two eggs over a table",
        "control": {"end_time": 1.0},
        "bodies": bodies,
        "surfaces": shapes | {"table": table},
        "contacts": {"card": card},
    }
    path = folder / "eggs.yaml"
    path.write_text(yaml.safe_dump(deck))
    return path


def test_a_sample_of_other_positions_trusts_no_bound_of_these(tmp_path: Path) -> None:
    """The search for an equilibrium at the start moves bodies without steps."""
    path = eggs(tmp_path)
    model, state = build(read_deck(path, {}))
    engine = Engine(model, state)
    engine.start()
    # the second, which was as far as the first, is put into the table
    nodes = state.nodes.copy()
    nodes["r"][2, 2] = 0.04
    engine.sample_of(nodes)
    # faces of a box are rounded, this one by 1.6e-6 m there
    np.testing.assert_allclose(state.cards["depth"], 0.01, atol=1e-5)
    assert state.cards["touching"] == 1.0


def test_a_snapshot_without_skipped_pairs_is_the_whole_state(tmp_path: Path) -> None:
    """Histories of skipped pairs are copied where they change: an interval is run again from
    them, to the same bits.
    """
    # spins make bounds loose: samples evaluate pairs that steps skip
    engine = Engine(*build(read_deck(eggs(tmp_path, (1.6, 1.5)), {})))
    kept = Histories(engine).kept
    resampling, skipped = Resampling(engine, kept, True, lambda *what: None), []
    engine.start()
    (group,) = engine.model.contact_groups
    snapshot = resampling.march.snapshot
    assert snapshot is not None and group.body_pairs is not None
    for k in range(1, SAMPLES + 1):
        time = k / SAMPLES
        engine.reach(time)
        if k > 1:
            reached = bits_of(engine)
            snapshot.restore_copy()
            engine.reach(time)
            assert bits_of(engine) == reached
        engine.sample(time)
        resampling.begin_interval()
        resampling.march.take_snapshot()
        assert {name: a.tobytes() for name, a in snapshot.arrays().items() if a.size} == bits_of(
            engine
        )
        skipped.append(group.body_pairs["skipped"].tolist())
    assert [0, 1] in skipped and [1, 1] in skipped and [1, 0] in skipped


def bits_of(engine: Engine) -> dict[str, bytes]:
    """All that changes in a run."""
    return {name: array.tobytes() for name, array in changing(engine).items() if array.size}


@pytest.mark.long
def test_an_exit_that_is_followed_is_the_one_that_a_search_finds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same steps and onsets; positions and velocities but for the round-off of depths.

    Each impact amplifies 1e-15 by some factor: 40 of them make it 4e-9. Another exit would change
    a depth by 1e-3 m.
    """
    path = tumbling(tmp_path, 1)
    followed = bodies_and_onsets(path, 0.5)
    monkeypatch.setattr(ContactGroup, "follows_exit", property(lambda group: False))
    searched = bodies_and_onsets(path, 0.5)
    assert followed[1:] == searched[1:]
    assert sum(followed[2]) > 30
    np.testing.assert_allclose(followed[0], searched[0], rtol=0.0, atol=1e-7)
    assert (followed[0] != searched[0]).any()


def bodies_and_onsets(path: Path, end: float) -> tuple[np.ndarray, int, list[int]]:
    """Positions and velocities of bodies, steps, and onsets of the cards."""
    model, state = build(read_deck(path, {}))
    engine = Engine(model, state)
    engine.start()
    engine.advance(end)
    onsets = state.card_history[int(engine.clock["current"])]["onsets"].tolist()
    return np.hstack([state.nodes["r"], state.nodes["v"]]), int(engine.clock["cycle"]), onsets
