"""Claim: a word of an earlier version is refused, and the message names the word of today."""

import pytest

from crashsolve.deck.laws import types_in
from crashsolve.deck.renamed import RENAMED
from crashsolve.deck.words import choices, nearest

SHELL = ("mesh", "thickness", "supports", "section_cuts", "impulses", "nodes", "welded")


@pytest.mark.parametrize("old", RENAMED)
def test_the_message_names_the_new_word(old: str) -> None:
    assert nearest(old, ["mass", RENAMED[old]]) == f"it is called '{RENAMED[old]}' now"
    # a word that this card does not know is not offered
    assert RENAMED[old] not in nearest(old, ["mass"])


def test_fields_and_types_are_answered_alike() -> None:
    assert choices("hold", SHELL, "fields").startswith("it is called 'supports' now (fields: mesh")
    assert nearest("turn_limit", types_in("springs")) == "it is called 'rotation_stop' now"


def test_every_new_type_exists() -> None:
    laws = {*types_in("springs"), *types_in("joints")}
    assert {new for new in RENAMED.values() if new.endswith(("_stop", "_driver"))} <= laws
