"""Claim: a contact that makes energy stops the run in every method, whatever else moves."""

from pathlib import Path

import numpy as np
import pytest
from quick import first_quick

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import SolverError
from crashsolve.foundation.rows import as_rows
from crashsolve.model.build import build
from crashsolve.model.contact.records import CARD_HISTORY
from crashsolve.model.ledger import IMBALANCE, LARGEST
from crashsolve.recording.engines import engine_of
from crashsolve.simulation.remarks import contacts_without_depth
from crashsolve.system.contact.advice import advice_on_gain
from crashsolve.system.contact.balance import contact_warnings, missing_energies
from crashsolve.system.contact.touches import card_with_friction_gain
from crashsolve.system.engine import Engine

DECKS = Path(__file__).parents[2] / "decks"
METHODS = (
    "rattle",
    "dormand_prince_5",
    "dormand_prince_8",
    "generalized_alpha",
    "radau_iia_5",
)
# a ball of 1 kg falls 0.3 m on a floor of 1e9 N/m^1.5; a contact takes 0.3 ms
DECK = """
control: {{end_time: {end}, step: {step}, integrator: {method}, estimate: "off"}}
bodies:
  ball: {{mass: 1, primitive: {{shape: sphere, radius: 0.1}}, position: [0, 0, {z} + 0.4]}}
  heavy: {{mass: 1000, inertia: [1, 1, 1], position: [0, 50, {z}], velocity: [{fast}, 0, 0]}}
surfaces:
  ball: {{type: sphere, body: ball, radius: 0.1}}
  floor: {{type: plane, at: [0, 0, {z}]}}
contacts: {{c: {{a: [ball], b: [floor], normal: {{type: hertz, stiffness: 1e9}}}}}}
loads: {{weight: {{type: gravity}}}}
"""

# 1 kg at 10 m/s draws a slack line tight, which throws it back within 3 ms; beside it 5e10 J move
LINE = """
control: {step: 2.5e-3, end_time: 0.2, estimate: "off"}
bodies:
  a: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0], velocity: [10, 0, 0]}
  heavy: {mass: 1000, inertia: [1, 1, 1], position: [0, 50, 0], velocity: [1e4, 0, 0]}
"""
LINES = {}
LINES["spring"] = """
springs: {line: {type: cable, stiffness: 1e6, length: 1.5, through: [{at: [0, 0, 0]}, {body: a}]}}
"""
LINES["belt"] = """
belts:
  line:
    type: belt
    webbing: {stiffness: 1.5e6}
    slack: 0.5
    route: [{anchor: {at: [0, 0, 0]}}, {anchor: {body: a}}]
"""


def fall(
    method: str, step: float, folder: Path, z: float = 0.0, fast: float = 0.0, end: float = 1.0
) -> Engine:
    path = folder / "deck.yaml"
    text = DECK.replace("{z} + 0.4", "{at!r}")
    path.write_text(
        text.format(method=method, step=step, z=z, at=z + 0.4, fast=fast, end=end), "utf-8"
    )
    deck = read_deck(path)
    engine = engine_of(deck, *build(deck))
    engine.start()
    for k in range(1, 101):
        engine.reach(end * k / 100)
        engine.sample(end * k / 100)
    return engine


def card_of(engine: Engine) -> tuple[np.ndarray, np.ndarray]:
    """What the card has exchanged, and its sums."""
    current = int(engine.clock["current"])
    return engine.state.card_history[current, 0], engine.state.cards[0]


@pytest.mark.parametrize(("z", "fast"), first_quick([(0.0, 0.0), (1e5, 0.0), (0.0, 1e4)]))
@pytest.mark.parametrize("method", first_quick(METHODS, 2))
def test_gains_stop_or_are_warned_of_in_any_frame(
    method: str, z: float, fast: float, tmp_path: Path
) -> None:
    # a step ten times as long as the contact
    try:
        engine = fall(method, 2.5e-3, tmp_path, z, fast)
    except SolverError as stop:
        # where nothing hides it, the balance of the whole may be broken before
        is_hidden = z > 0.0 or fast > 0.0
        assert is_hidden or "energy balance" in str(stop) or "J more than it took" in str(stop)
        assert not is_hidden or "contact 'c'" in str(stop)
        return
    # no more than control.energy_limit of what was exchanged was made; more lost is a warning
    now, out = card_of(engine)
    (_, lack, largest_energy), _ = missing_energies(now, out)
    assert now["work"] <= 0.05 * now["exchanged"]
    warned = contact_warnings(engine.model, engine.state, engine.ledger)
    # of a ledger of kilometres 1e-5 is more than the ball has: there it alters nothing reported
    seen = 1e-5 * float(engine.ledger[LARGEST])
    assert bool(warned) == (abs(lack) > max(0.02 * largest_energy, seen))


@pytest.mark.parametrize("method", first_quick(METHODS))
def test_the_work_of_a_contact_is_stored_and_dissipated(method: str, tmp_path: Path) -> None:
    engine = fall(method, 1e-5, tmp_path, 1e5, 1e4, end=0.4)
    now, out = card_of(engine)
    (_, lack, _), _ = missing_energies(now, out)
    # it takes and gives m g 0.3 m; 30 steps a contact: (pi / 30)^2 / 12 of it by methods of order 2
    assert now["exchanged"] == pytest.approx(2 * 9.81 * 0.3, rel=5e-3)
    assert abs(lack) < 1e-3 * 9.81 * 0.3


def test_friction_that_gives_more_than_it_took_is_found() -> None:
    table = np.zeros((2, 2), CARD_HISTORY.dtype)
    card = table[0, 1]
    card["exchanged"], card["peak_normal"] = 100.0, 1000.0
    # took 10 J, gave 12 J
    card["friction_work"], card["friction_exchanged"] = 2.0, 22.0
    history = as_rows(table)
    assert card_with_friction_gain(0, 0.05, 0.0, history) == 1
    assert card_with_friction_gain(0, 0.10, 0.0, history) == -1
    # 1000 N over the round-off of positions do as much
    assert card_with_friction_gain(0, 0.05, 2.1e-3, history) == -1
    # what friction takes is no gain
    card["friction_work"] = -2.0
    assert card_with_friction_gain(0, 0.05, 0.0, history) == -1


@pytest.mark.parametrize("entry", first_quick(LINES))
def test_a_line_that_makes_energy_is_named_whatever_else_moves(entry: str, tmp_path: Path) -> None:
    with pytest.raises(SolverError) as stop:
        draw_tight(entry, tmp_path, 3.9e-3)
    assert f"{entry} 'line'" in str(stop.value)
    assert "its force has created energy" in str(stop.value)
    now, stored = draw_tight(entry, tmp_path, 1.2e-4)
    # the mass gives and takes back its 50 J
    assert now["exchanged"] == pytest.approx(2 * 50.0, rel=0.01)
    # (omega h)^2 / 4 of it, by where in a step the line becomes tight
    assert abs(now["work_done"] + stored) < 0.004 * 50.0


def test_a_line_that_is_slack_after_one_step_does_not_stop_the_run(tmp_path: Path) -> None:
    # half of 30 N act over the first step, of 1 mm, where the stretch is 20 um: 15 mJ for 0.3 mJ,
    # beside 50 J of motion
    path = tmp_path / "deck.yaml"
    text = (LINE + LINES["belt"]).replace("velocity: [10,", "velocity: [-10,")
    text = text.replace("slack: 0.5", "slack: -2e-5").replace("2.5e-3", "1e-4")
    path.write_text(text, "utf-8")
    deck = read_deck(path)
    engine = engine_of(deck, *build(deck))
    engine.start()
    for k in range(1, 21):
        engine.reach(1e-3 * k)
        engine.sample(1e-3 * k)
    (group,) = [g for g in engine.model.force_groups() if g.is_watched]
    now = group.history[int(engine.clock["current"]), 0]
    # it gave more than it had
    assert now["work_done"] > 1.05 * now["initially_stored"] > 0.0


def draw_tight(entry: str, folder: Path, step: float) -> tuple[np.void, float]:
    """What the line has given and taken after its first pull, and what it stores [J]."""
    path = folder / "deck.yaml"
    path.write_text((LINE + LINES[entry]).replace("2.5e-3", repr(step)), "utf-8")
    deck = read_deck(path)
    engine = engine_of(deck, *build(deck))
    engine.start()
    for time in (0.04, 0.07):
        engine.reach(time)
        engine.sample(time)
    (group,) = [g for g in engine.model.force_groups() if g.is_watched]
    current = int(engine.clock["current"])
    return group.history[current, 0], float(group.output[0]["stored"])


@pytest.mark.parametrize(
    ("deck", "contact", "words"),
    [
        ("verification/contact/faces", "ball", ""),
        ("benchmark/tube_crush", "folds", "ring: 1 of its faces"),
        ("benchmark/tube_crush", "wall", ""),
    ],
)
def test_advice_on_a_gain_is_what_helps(deck: str, contact: str, words: str) -> None:
    model, _ = build(read_deck(DECKS / f"{deck}.yaml"))
    advice = advice_on_gain(model, model.contacts.index(contact))
    assert words in advice and bool(words) == bool(advice)


# a head form of 110 mm in a helmet of 140 mm with a liner of 27 mm, both at 7.5 m/s
HELMET = """
control: {end_time: 4.0e-3, safety: 0.9, estimate: "off"}
materials: {abs: {type: elastic, young: 2.0e+9, poisson: 0.37, density: 1050}}
bodies:
  head:
    mass: 5
    primitive: {shape: sphere, radius: 0.11}
    position: [0, 0, 0.1415]
    velocity: [0, 0, -7.5]
parts:
  shell:
    type: shell
    mesh: {type: sphere, centre: [0, 0, 0.143], radius: 0.14, elements: 8}
    thickness: 4.0e-3
    material: abs
    velocity: [0, 0, -7.5]
surfaces:
  skin: {type: sphere, body: head, radius: 0.11}
  liner: {LINER}
  outside: {type: nodes, part: shell, radius: 2.0e-3}
  anvil: {type: plane}
contacts:
  inside: {PAIR, normal: {type: penalty, stiffness: STIFFNESS}}
  blow: {a: [outside], b: [anvil], normal: {type: penalty}}
loads: {weight: {type: gravity}}
"""


def helmet(folder: Path, liner: str, pair: str, stiffness: str) -> Engine:
    text = HELMET.replace("LINER", liner).replace("PAIR", pair).replace("STIFFNESS", stiffness)
    (folder / "deck.yaml").write_text(text)
    deck = read_deck(folder / "deck.yaml")
    return engine_of(deck, *build(deck))


def test_a_ball_in_a_hollow_of_faces_is_named_with_what_helps(tmp_path: Path) -> None:
    faces = helmet(
        tmp_path, "type: faces, part: shell, thickness: 0.054", "a: [skin], b: [liner]", "1.0e+6"
    )
    faces.start()
    with pytest.raises(SolverError) as caught:
        faces.advance(4.0e-3)
    assert "contact 'inside'" in str(caught.value)
    assert "name the nodes of the shell on one side" in str(caught.value)
    # which it does
    nodes = helmet(
        tmp_path, "type: nodes, part: shell, radius: 0.027", "a: [liner], b: [skin]", "2.0e+4"
    )
    nodes.start()
    nodes.advance(4.0e-3)
    nodes.sample()
    assert nodes.state.cards[0]["stored"] > 1.0
    # 0.02 % here, at the longest stable step
    assert abs(nodes.ledger[IMBALANCE]) < 2e-3 * nodes.ledger[LARGEST]
    # neither contact touches at the start, and none is said to begin without depth
    assert (
        contacts_without_depth(
            helmet(tmp_path, "type: faces, part: shell", "a: [skin], b: [liner]", "1e6")
        )
        == []
    )
