"""Checks that the model has the bodies, parts and contacts that the scenes of a report name."""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase

from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.run_cards.output import Scene
from crashsolve.deck.words import choices
from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.model.model import Model


def look_up_pictured(deck: Deck, model: Model) -> None:
    """Refuse names that pictures of the run could not find. Raises DeckErrors."""
    report = deck.output.report
    diagnostics = [
        DeckError(str(deck.path), None, None, f"output: report: scene '{scene.title}'", *problem)
        for scene in (report.scenes if report else ())
        for problem in _problems_of(scene, deck, model)
    ]
    if diagnostics:
        raise DeckErrors(diagnostics)


def _problems_of(scene: Scene, deck: Deck, model: Model) -> Iterator[tuple[str, str]]:
    """Errors of the names of a scene, with advice."""
    whole = [*model.bodies[1:], *deck.entries["parts"]]
    for word in scene.show:
        yield from _unknown("show", word, whole, "bodies and parts")
    if scene.follow and scene.follow not in whole:
        yield from _unknown("follow", scene.follow, whole, "bodies and parts", has_globs=False)
    name = scene.close_up.partition(":")[0].strip()
    if name:
        known = [*model.contacts, *whole]
        yield from _unknown("close_up", name, known, "contacts, bodies and parts", has_globs=False)
    family, _, card = scene.arrows.partition(".")
    if family == "rcforc" and card:
        yield from _unknown("arrows", card, model.contacts, "contacts")


def _unknown(
    field: str, word: str, known: Sequence[str], what: str, has_globs: bool = True
) -> Iterator[tuple[str, str]]:
    """The problem of a word that matches none of the known names."""
    if not any(fnmatchcase(name, word) if has_globs else name == word for name in known):
        yield f"{field}: nothing is called '{word}'", choices(word, known, what)
