"""Transient phase: motion, as in a run without phases.

    M v_dot = g + D^T lambda,   v(t_0) nearest to the v of the deck with D v = nu

The first transient phase begins with the velocities of the deck, in the configuration that the
phase before has left; where joints stand otherwise there, with the nearest velocities that they
allow, by the kinetic energy of the difference. Later ones continue from the present state.
Consequence to test: a car that has settled on its springs begins with the speed of the deck and
does not pitch.
"""

from crashsolve.deck.building import Columns, Scene
from crashsolve.phases import PhasedEngine
from crashsolve.phases._card import PhaseCard


class Transient(PhaseCard):
    """Transient motion; the first such phase begins with the velocities of the deck."""


def build(card: Transient, scene: Scene) -> Columns:
    return {}


def start(p: Columns, engine: PhasedEngine) -> None:
    engine.memory["launched"] = 1


def begin(p: Columns, engine: PhasedEngine) -> None:
    engine.launch()


def end(p: Columns, engine: PhasedEngine) -> None:
    """No condition at the end of the phase."""
