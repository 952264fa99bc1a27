"""Claim: a contact that names a structure stops what strikes a member, in every description."""

from pathlib import Path

import pytest
from quick import first_quick

from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.scripting import run

DECK = Path(__file__).parents[2] / "decks/verification/parts/struck_member.yaml"
DESCRIPTIONS = ["rigid", "shells", "hinges", "segments", "beams"]
ROUND = (
    '{type: rectangular_tube, width: "50 mm", height: "50 mm", thickness: "2 mm"}',
    "{type: tube, radius: 25 mm, thickness: 2 mm}",
)
BALL = (
    "{type: box, body: bar, size: [0.04, 0.02, 0.02]}",
    "{type: sphere, body: bar, radius: 10 mm}",
)
DEFORMATION = "deformation: rigid"
# of the deck: mass, speed and stiffness
M, V, K = 0.02, 20.0, 5.0e6


def written(description: str, folder: Path, *changes: tuple[str, str]) -> Path:
    """The deck with another description, and texts replaced by others."""
    text = DECK.read_text("utf-8")
    for old, new in ((DEFORMATION, f"deformation: {description}"), *changes):
        assert old in text
        text = text.replace(old, new)
    path = folder / "deck.yaml"
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize(
    ("description", "changes"),
    first_quick(
        [(word, ()) for word in DESCRIPTIONS]
        + [(word, (ROUND, BALL)) for word in DESCRIPTIONS]
        + [("shells", (BALL,))],
        1,
    ),
)
def test_a_bar_bounces_off_a_member(
    description: str, changes: tuple[tuple[str, str], ...], tmp_path: Path
) -> None:
    result = Result(run(written(description, tmp_path, *changes), tmp_path / "out"))
    # what one spring stores at most is the energy of the bar; the bar comes back
    deepest = result.value("rcforc.blow.peak_depth", "final")
    assert 0.0 < deepest <= 1.01 * V * (M / K) ** 0.5
    assert result.value("rbdout.bar.velocity.z", "final") > 0.0


def test_a_member_whose_point_is_part_of_a_body_is_struck(tmp_path: Path) -> None:
    post = (
        "  bar: {mass",
        "  post: {mass: 1.0e+3, inertia: [9, 9, 9], position: [0.5, 0.2, 0]}\n  bar: {mass",
    )
    foot = ("{name: foot, at: [0, 0, 0]}", "{name: foot, at: [0, 0, 0], part_of: post}")
    held = (
        "wall: {type: weld, b: frame_foot, at: [0, 0, 0]}",
        "wall: {type: weld, b: post, at: [0, 0, 0]}",
    )
    # over the half of the first element, which belongs to the point
    over = (
        "bar: {mass: 0.02, inertia: [1.0e-5, 1.0e-5, 1.0e-5], position: [0.12",
        "bar: {mass: 0.02, inertia: [1.0e-5, 1.0e-5, 1.0e-5], position: [0.05",
    )
    guide = ("at: [0.12, 0, 0.037], axis", "at: [0.05, 0, 0.037], axis")
    deck = written("beams", tmp_path, post, foot, held, over, guide)
    result = Result(run(deck, tmp_path / "out"))
    # a rigid body returns all that the spring has stored
    deepest = result.value("rcforc.blow.peak_depth", "final")
    assert deepest == pytest.approx(V * (M / K) ** 0.5, rel=1e-3)
    assert result.value("rbdout.bar.velocity.z", "final") == pytest.approx(V, rel=1e-3)


def surfaces_of(deck: Path) -> dict[str, str]:
    """Names and types of all surfaces of a deck."""
    return {name: entry.type for name, entry in read_deck(deck).entries["surfaces"].items()}


def test_balls_meet_faces_and_others_nodes(tmp_path: Path) -> None:
    with_box = surfaces_of(written("shells", tmp_path))
    assert with_box["frame_arm_outline_nodes"] == "nodes"
    with_ball = surfaces_of(written("shells", tmp_path, BALL))
    assert with_ball["frame_arm_outline_faces"] == "faces"
    assert not {"frame_arm_outline_nodes", "frame_arm_outline_faces"} <= set(with_ball)


def test_outlines_cover_the_member_once(tmp_path: Path) -> None:
    """Their lengths sum to that of the member, in all descriptions of rigid lengths."""
    for description in ("rigid", "hinges", "segments", "beams"):
        deck = read_deck(written(description, tmp_path))
        cards = [e.card for name, e in deck.entries["surfaces"].items() if "outline" in name]
        assert sum(card.size[0] for card in cards) == pytest.approx(0.4, rel=1e-12)
        assert {card.size[1:] for card in cards} == {(0.05, 0.05)}


@pytest.mark.parametrize(
    ("text", "other", "message"),
    [
        (
            "a: [nose]",
            "a: [frame]",
            "'frame' is on both sides: its name does not define contact with itself",
        ),
        ("surfaces:", "surfaces:\n  floor: {type: plane}", "shells of 'frame' touch balls"),
        ("b: [frame]", "b: [frme]", "unknown surface 'frme'"),
    ],
)
def test_what_cannot_be_named_is_refused(
    text: str, other: str, message: str, tmp_path: Path
) -> None:
    also = [("a: [nose]", "a: [nose, floor]")] if "floor" in other else []
    path = written("shells", tmp_path, BALL, (text, other), *also)
    with pytest.raises(DeckErrors, match=message):
        read_deck(path)
