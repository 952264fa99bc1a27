"""Phase that ends in equilibrium: the motion is halted whenever its kinetic energy has a peak.

    v = 0   where   T = v . M v / 2   begins to fall

A vibration passes its equilibrium at the peak of its kinetic energy, so that a motion halted there
has come to its equilibrium and not beyond; the rest of several vibrations falls from halt to halt
(dynamic relaxation with kinetic damping). All laws are stepped as in motion: contacts close, metal
yields, friction holds. Loads without a curve rise from nothing, so that the path to the equilibrium
is near that of slow loads, the nearer the longer the phase. The energy and the momentum that are
taken away count as work and impulse from outside. Consequence to test: a mass set on a spring that
would yield under the peak of its vibration, twice the weight, does not yield; the motion that
follows stays below the tolerance.

References: Cundall (1976), Explicit finite-difference methods in geomechanics; Barnes (1999), Form
finding and analysis of tension structures by dynamic relaxation, International Journal of Space
Structures 14, 89-104.
"""

from math import ceil

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity
from crashsolve.phases import PhasedEngine
from crashsolve.phases._card import PhaseCard

# steps in which loads rise
STEPS = 200


class Equilibrium(PhaseCard):
    """Dynamic relaxation to equilibrium; initial velocities act after it."""

    tolerance: float = quantity(
        "1",
        "residual force on a body at the end, over the largest force of any law; moments over the "
        "model's size count as forces",
        default=1e-4,
        gt=0,
        lt=1,
    )
    rise: float | None = quantity(
        "s",
        "time over which loads without a curve rise from nothing, in 200 steps, where the run "
        "begins with this phase; half of the phase when absent",
        default=None,
        ge=0,
    )


def build(card: Equilibrium, scene: Scene) -> Columns:
    return {"tolerance": card.tolerance, "rise": card.rise}


def start(p: Columns, engine: PhasedEngine) -> None:
    engine.set_velocities(None)
    engine.raise_loads(0.0 if _rise(p, engine) > 0.0 else 1.0)


def _rise(p: Columns, engine: PhasedEngine) -> float:
    """Time over which loads rise [s]."""
    begun = float(engine.model.control[0]["start"])
    return 0.5 * (engine.phase.end - begun) if p["rise"] is None else p["rise"]


def begin(p: Columns, engine: PhasedEngine) -> None:
    engine.halt()


def after_step(p: Columns, engine: PhasedEngine) -> None:
    """Halt the motion where its kinetic energy falls. Writes: the State."""
    kinetic, memory = engine.kinetic(), engine.memory
    if kinetic < memory["kinetic"]:
        engine.halt()
        kinetic = 0.0
    memory["kinetic"] = kinetic
    if memory["share"] < 1.0:
        elapsed = float(engine.clock["time"]) - float(engine.model.control[0]["start"])
        engine.raise_loads(min(ceil(STEPS * elapsed / _rise(p, engine)) / STEPS, 1.0))


def end(p: Columns, engine: PhasedEngine) -> None:
    engine.halt()
    engine.require_equilibrium(p["tolerance"])
