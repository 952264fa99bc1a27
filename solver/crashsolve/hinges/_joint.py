"""What joints beneath hinges share: rows that failure frees, histories at the start, energies."""

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.joints._card import Framed, direction

LEDGER = "hinge"
# directions typed with six digits are square to this; a worse one is an error
SQUARE = 1e-5
COMMON = Record("""
    rate_factor  1     phi, on the static moment or force at yield
    energy       J     taken so far: stored and dissipated
    failed       flag  1 after failure
""")


def at_start(p: np.void, speed: float) -> Columns:
    """History of a hinge that has not moved; `speed` is that of the rate factor."""
    return {"x": -p["initial"], "latch": -1.0, "factor": 1.0, "speed": abs(speed)}


def across(card: Framed, field: str, scene: Scene) -> np.ndarray:
    """Direction in a field of the card, which must be at right angles to its axis, and made so.

    Raises DeckErrors where it is not.
    """
    axis, other = direction(card, scene, "axis"), direction(card, scene, field)
    cosine = float(axis @ other)
    if abs(cosine) > SQUARE:
        raise scene.fail(f"must be at right angles to axis; their cosine is {cosine:.3g}", field)
    return np.asarray(scene.unit(other - cosine * axis, field))


def motion_of(scene: Scene, p: np.void) -> tuple[np.ndarray, np.ndarray]:
    """Velocity (3,) [m/s] of b's joint point, spin (3,) [rad/s] of b, seen from a, world axes."""
    a, b = p["node_a"], p["node_b"]
    arms = [scene.matrix(node) @ p[f"point_{side}"] for side, node in (("a", a), ("b", b))]
    v = [scene.v[n] + np.cross(scene.w[n], d) for n, d in zip((a, b), arms, strict=True)]
    return v[1] - v[0], scene.w[b] - scene.w[a]


@kernel
def is_released(p, old):
    """Whether failure has freed the joint."""
    return old.failed == 1 and p.is_apart == 1


@kernel
def release_rows(p, old, rows, count):
    """Rows that hold nothing, where failure has freed the joint. Writes: rows.phi, D, nu, gamma."""
    if not is_released(p, old):
        return
    for k in range(p.first_row, p.first_row + count):
        rows[k].phi = rows[k].nu = rows[k].gamma = 0.0
        for j in range(12):
            rows[k].D[j] = 0.0


@kernel
def fails(p, old, x, y):
    """Whether the hinge has failed, by now or long ago, with these motions."""
    return old.failed == 1 or abs(x) >= p.failure[0] or abs(y) >= p.failure[1]


@kernel
def copy_history(old, new):
    """History of a hinge that has failed. Writes: new."""
    for c in range(2):
        new.x[c], new.plastic[c], new.flow[c] = old.x[c], old.plastic[c], old.flow[c]
        new.origin[c] = old.origin[c]
        new.plastic_flow[c], new.corner[c] = 0, 0.0
    for j in range(4):
        new.reached[j] = old.reached[j]


@kernel
def write_energies(p, old, new, out, stored, loss):
    """Energies of a hinge; at failure it releases its stored energy. Writes: out, new."""
    out.failed, out.rate_factor = new.failed, new.factor
    out.stored, out.power, out.loss = stored, 0.0, loss
    if new.failed == 1:
        out.stored, out.loss = 0.0, loss + stored
    out.energy = old.dissipated + out.stored + out.loss
