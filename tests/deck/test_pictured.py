"""Claim: a scene that names what the model lacks is refused before the run."""

from pathlib import Path

import pytest
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.recording.pictured import look_up_pictured

DECK = """
control: {end_time: 1}
bodies: {ball: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 0.2]}}
surfaces: {skin: {type: sphere, body: ball, radius: 0.1}, floor: {type: plane}}
contacts: {touch: {a: [skin], b: [floor], normal: {type: hertz, stiffness: 1e9}}}
"""


def problems(folder: Path, scene: dict[str, object]) -> list[str]:
    """What is refused of a scene."""
    deck = folder / "deck.yaml"
    output = {"output": {"report": {"scenes": [{"title": "Impact"} | scene]}}}
    deck.write_text(DECK + yaml.safe_dump(output), "utf-8")
    read = read_deck(deck)
    model, _ = build(read)
    try:
        look_up_pictured(read, model)
    except DeckErrors as errors:
        return [error.message for error in errors.errors]
    return []


def test_names_that_pictures_would_not_find_are_refused_all_at_once(tmp_path: Path) -> None:
    wrong = {"show": ["b*", "bxl*"], "follow": "b*", "close_up": "tuch:1 m", "arrows": "rcforc.x"}
    assert problems(tmp_path, wrong) == [
        "show: nothing is called 'bxl*'",
        "follow: nothing is called 'b*'",
        "close_up: nothing is called 'tuch'",
        "arrows: nothing is called 'x'",
    ]


@pytest.mark.parametrize("name", ["touch", "ball:20 mm"])
def test_names_of_the_model_are_found(name: str, tmp_path: Path) -> None:
    right = {"show": ["b*"], "follow": "ball", "close_up": name, "arrows": "rcforc.t*"}
    assert problems(tmp_path, right) == []
