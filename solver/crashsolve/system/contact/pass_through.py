"""Touches that keep the face by which they began, and bodies that pass the middle of others.

Within a solid every face is an exit. The nearest is the right one only as long as a touch is
shallow: deeper than the next side face is far, a pair has to continue with its own face. It moves
to the neighbour n from its own face n_0 where they are equally far and it slides more than it
deepens,

    v . n > -v . n_0,   v the velocity of a over b,

so round an edge the depth is continuous. Beyond the middle of what is struck no exit is
the right one: such a pair is marked with the time, and the run stops (`engine.py`). Consequence to
test: a deep box pushes back as a plane does.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import point_velocity
from crashsolve.foundation.vec3 import add, dot, put, sub, vec

# cosine between the normals of a touch in two steps: below the first it is another face, below the
# second the opposite one
SAME, OPPOSITE = 0.7, -0.5
# a touch of round bodies beyond this share of the distance to the middle of both is one with no
# exit
MIDDLE = 0.8
# a touch that begins deeper than this share of it has not come from outside, since no step brings
# two sides that are apart so far; nor does one that is deeper keep its exit when its normal
# turns farther in a step than that of a round body (60 deg), or of one with faces (a right angle)
SUDDEN, ROTATED, SQUARE = 0.25, 0.5, -0.1


@kernel
def is_another_face(old, depth, n, radius):
    """Whether the centre of a touching ball is inside, and nearest to another face than before."""
    return old.active == 1 and depth > radius and dot(n, vec(old.normal)) < SAME


@kernel
def velocity_at(body, x):
    """Velocity of a body at the position x."""
    return point_velocity(body, sub(x, vec(body.r)))


@kernel
def keeps_face(old, v_a, v_b, n, kept):
    """Whether contact keeps its own face, `kept`, though that with the normal n is nearer."""
    if kept[0] <= 0.0:
        return False
    return old.held == 1 or dot(sub(v_a, v_b), add(n, kept[1])) <= 0.0


@kernel
def note_face(clock, h, p, old, new, held, over, depth, n):
    """Store the face with which contact continues; `over` is how far beyond its middle. Writes:
    new.
    """
    new.held = 1 if held else 0
    astray = over > 0.0 or is_opposite(old, n) or has_leapt(p, old, depth, n, SQUARE)
    mark(clock, h, p, old, new, depth, n, astray)
    put(new.normal, n)


@kernel
def note_escape(clock, h, p, old, new, depth, n):
    """Record that contact ends without its surface, for shapes without faces to be kept.

    Writes: new.
    """
    new.held = 0
    is_deep = depth > MIDDLE * p.thick
    astray = is_deep or is_opposite(old, n) or has_leapt(p, old, depth, n, ROTATED)
    mark(clock, h, p, old, new, depth, n, astray)
    put(new.normal, n)


@kernel
def note_probe(clock, h, p, old, new, hit, held, over):
    """The same of a node on the deepest of several shapes, which may be another. Writes: new."""
    if old.active == 1 and old.face != hit.face:
        new.held, new.passed = 0, old.passed
    else:
        note_face(clock, h, p, old, new, held, over, hit.depth, vec(hit.normal))


@kernel
def note_round_probe(clock, h, p, old, new, hit):
    """The same of shapes without faces to be kept. Writes: new."""
    if old.active == 1 and old.face != hit.face:
        new.held, new.passed = 0, old.passed
    else:
        note_escape(clock, h, p, old, new, hit.depth, vec(hit.normal))


@kernel
def is_opposite(old, n):
    """Whether the normal has reversed."""
    return dot(n, vec(old.normal)) < OPPOSITE


@kernel
def has_leapt(p, old, depth, n, cosine):
    """Whether the normal of a deep touch has rotated too far in a step."""
    return max(depth, old.depth) > SUDDEN * p.thick and dot(n, vec(old.normal)) < cosine


@kernel
def mark(clock, h, p, old, new, depth, n, astray):
    """The time at which a pair has first passed the middle, or begun beyond it. Writes: new.

    Negative where it has begun at the back of an open mesh, out of which the normal was before.
    """
    new.passed = old.passed
    if old.active == 0:
        astray = h > 0.0 and depth > SUDDEN * p.thick
    if astray and old.passed == 0.0:
        time = max(clock.time + h, 1e-300)
        new.passed = -time if old.active == 0 and is_opposite(old, n) else time


@kernel
def released_energy(clock, h, old, n, stored):
    """Stored energy that is lost where a deep touch leaves its own face sideways [J]."""
    if clock.closes == 0 or h == 0.0 or old.held == 0 or dot(n, vec(old.normal)) >= SAME:
        return 0.0
    return stored
