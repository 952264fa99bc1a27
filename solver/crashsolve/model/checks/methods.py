"""Families of laws that not every integrator can step, and the declarations of an integrator."""

from collections.abc import Iterator
from importlib import import_module
from types import ModuleType

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card
from crashsolve.deck.family import ANY, CHOSEN, Family, FamilyError, families
from crashsolve.deck.reading.deck import Deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.model import Model


def refuse_methods(scene: Scene) -> None:
    """Families that the integrator of the deck cannot step. Writes: scene.errors, methods."""
    limited_families = {f.folder: f for f in families().values() if f.integrators != ANY}
    kinds = scene.deck.entries.values() if limited_families else ()
    for entry in (entry for entries in kinds for entry in entries.values()):
        with scene.building(entry):
            for folder in _folders(entry.card):
                if folder in limited_families:
                    _refuse_method(scene, limited_families[folder])


def _refuse_method(scene: Scene, family: Family) -> None:
    method, known = scene.deck.control.integrator, " or ".join(family.integrators)
    if method not in CHOSEN and not family.supports(method):
        message = f"{family.name} cannot be stepped by {method}"
        raise scene.fail(f"{message}; set integrator: {known}")
    scene.methods = [m for m in scene.methods or family.integrators if family.supports(m)]
    if not scene.methods:
        message = f"no integrator can step {family.name}, known to {known}, with the others"
        raise scene.fail(message)


def _folders(card: Card) -> Iterator[str]:
    """Folders of the families of a card and of the laws within it."""
    yield type(card).__module__.partition(".")[2].rpartition(".")[0].replace(".", "/")
    for name in type(card).model_fields:
        value = getattr(card, name)
        for part in value if isinstance(value, tuple) else (value,):
            if isinstance(part, Card):
                yield from _folders(part)


def refuse_several(model: Model, deck: Deck) -> None:
    """Raises DeckErrors for springs among several bodies beside elements with blocks of their
    nodes.

    The matrix of all nodes has no blocks for the parts of one row.
    """
    method = import_module(f"crashsolve.integrators.{model.integrator}")
    has_blocks = bool(model.elements) or any(
        hasattr(g.module, "tangent_blocks") for g in model.groups
    )
    if not hasattr(method, "T") or not has_blocks:
        return
    some = {
        (g.keyword, g.type)
        for g in model.groups
        if g.joins_several and hasattr(g.module, "tangent")
    }
    errors = [
        deck.error(
            entry,
            None,
            f"acts on several bodies, which {model.integrator} cannot step beside beams or shells; "
            "set integrator: rattle",
        )
        for keyword, kind in some
        for entry in deck.entries[keyword].values()
        if entry.type == kind
    ]
    if errors:
        raise DeckErrors(errors)


# attributes of the file of a method, by stepper
DECLARED = {
    "_runge_kutta": ("STAGES", "EXTRA", "A", "C", "DENSE", "TERMS", "E", "ESTIMATES"),
    "_implicit": ("STAGES", "STAGE", "A", "T"),
    "": ("prepare_sample", "take_step"),
}


def refuse_incomplete_method(module: ModuleType) -> None:
    """Raises FamilyError for a method that lacks a constant of its stepper, or a part of its
    tableau.

    Compiled steps read a tableau up to its number of stages, for any size.
    """
    stepper = getattr(module, "STEPPER", "")
    if stepper not in DECLARED:
        known = ", ".join(word for word in DECLARED if word)
        raise FamilyError(f"{module.__name__}: STEPPER must be one of {known}, or left out")
    missing = [n for n in ("ORDER", *DECLARED[stepper]) if not hasattr(module, n)]
    if missing:
        raise FamilyError(f"{module.__name__} must declare {', '.join(missing)}")
    if stepper == "_runge_kutta":
        stages = module.STAGES + module.EXTRA
        shapes = {"A": (stages, stages), "C": (stages,), "DENSE": (module.TERMS, stages)}
        shapes["E"] = (module.ESTIMATES, module.STAGES)
        for name, shape in shapes.items():
            if np.shape(getattr(module, name)) != shape:
                message = f"{name} has the shape {np.shape(getattr(module, name))}, not {shape}"
                raise FamilyError(
                    f"{module.__name__}: {message} of STAGES, EXTRA, TERMS, ESTIMATES"
                )
