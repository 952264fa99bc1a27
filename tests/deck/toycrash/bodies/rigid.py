"""Toy body."""

from crashsolve.deck.card import Card, Vec3, quantity


class Rigid(Card):
    """Rigid body."""

    mass: float = quantity("kg", "mass", gt=0)
    inertia: Vec3 = quantity("kg m^2", "moments of inertia", gt=0)
