"""Contacts that retain the face on which they began, and bodies that pass the middle of others.

Within a solid a point may leave by any face. The nearest is the right one only while the contact
is shallow: deeper than the distance to a side face, a pair has to retain the face n_0 on which it
began. It changes to the neighbour n where both are equally far and it slides more than it deepens,

    v . n > -v . n_0,   v the velocity of a over b,

so around an edge the depth is continuous. Beyond the middle of the struck body no face is the
right one: such a pair is marked with the time, and the run stops (`engine.py`). Consequence to
test: a deep box pushes back as a plane does.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import point_velocity
from crashsolve.foundation.vec3 import add, dot, put, sub, vec

# cosine between the normals of a touch in two steps: below the first it is another face, below the
# second the opposite one
SAME, OPPOSITE = 0.7, -0.5
# share of the distance to the middle of both that may be round-off: a touch so shallow has no
# reliable normal
SHALLOW = 1e-6
# a contact of round bodies beyond this share of the distance to the middle of both has no right
# face
MIDDLE = 0.8
# a contact that begins deeper than this share of it has not come from outside, since no step
# closes so large a gap; nor is a deeper one valid when its normal rotates in a step by more than
# that of a round body (60 deg), or of one with faces (a right angle)
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
def may_retain_face(old, v_a, v_b, n, kept):
    """Whether a pair retains its face, `kept`, though that with the normal n is nearer."""
    if kept[0] <= 0.0:
        return False
    return old.retains_face == 1 or dot(sub(v_a, v_b), add(n, kept[1])) <= 0.0


@kernel
def record_face(clock, h, p, old, new, retains_face, over, depth, n):
    """Store the face with which contact continues; `over` is how far beyond its middle. Writes:
    new.
    """
    new.retains_face = 1 if retains_face else 0
    is_beyond = over > SHALLOW * p.thick
    has_passed = is_beyond or is_opposite(p, old, depth, n) or has_jumped(p, old, depth, n, SQUARE)
    record_pass(clock, h, p, old, new, depth, n, has_passed)
    put(new.normal, n)


@kernel
def record_round(clock, h, p, old, new, depth, n):
    """Record a contact of shapes without faces to retain, and whether it is too deep.

    Writes: new.
    """
    new.retains_face = 0
    is_deep = depth > MIDDLE * p.thick
    has_passed = is_deep or is_opposite(p, old, depth, n) or has_jumped(p, old, depth, n, ROTATED)
    record_pass(clock, h, p, old, new, depth, n, has_passed)
    put(new.normal, n)


@kernel
def record_round_pair(clock, h, p, old, new, depth, n, x, m, w):
    """The same of two bodies, with the side from which one came. Writes: new."""
    record_round(clock, h, p, old, new, depth, n)
    record_side(old, new, m, w, n, x)


@kernel
def record_probe(clock, h, p, old, new, hit, retains_face, over):
    """The same for a node on the deepest of several shapes, which may have changed. Writes: new."""
    if old.active == 1 and old.face != hit.face:
        new.retains_face, new.pass_time = 0, old.pass_time
    else:
        record_face(clock, h, p, old, new, retains_face, over, hit.depth, vec(hit.normal))


@kernel
def record_round_probe(clock, h, p, old, new, hit):
    """The same for shapes without faces to retain. Writes: new."""
    if old.active == 1 and old.face != hit.face:
        new.retains_face, new.pass_time = 0, old.pass_time
    else:
        record_round(clock, h, p, old, new, hit.depth, vec(hit.normal))


@kernel
def is_opposite(p, old, depth, n):
    """Whether the normal has reversed, in a touch or through all of what is struck."""
    is_reliable = max(abs(depth), abs(old.depth)) > SHALLOW * p.thick
    return is_reliable and dot(n, vec(old.normal)) < OPPOSITE


@kernel
def has_jumped(p, old, depth, n, cosine):
    """Whether the normal of a deep touch has rotated too far in a step."""
    return max(depth, old.depth) > SUDDEN * p.thick and dot(n, vec(old.normal)) < cosine


@kernel
def record_pass(clock, h, p, old, new, depth, n, has_passed):
    """Record the time at which a pair first passed the middle, or began beyond it. Writes: new."""
    new.pass_time = old.pass_time
    if old.active == 0:
        has_passed = h > 0.0 and depth > SUDDEN * p.thick
    if has_passed and old.pass_time == 0.0:
        new.pass_time = max(clock.time + h, 1e-300)


@kernel
def record_side(old, new, m, w, n, x):
    """Negate the time at which a pair began too deep where it came from behind: where
    it moves out along the normal, as what comes from outside never does. Writes: new.
    """
    is_first = old.active == 0 and old.pass_time == 0.0 and new.pass_time > 0.0
    if is_first and dot(sub(velocity_at(m, x), velocity_at(w, x)), n) > 0.0:
        new.pass_time = -new.pass_time


@kernel
def released_energy(clock, h, old, n, stored):
    """Stored energy that is lost where a deep contact leaves its face sideways [J]."""
    if clock.closes == 0 or h == 0.0 or old.retains_face == 0 or dot(n, vec(old.normal)) >= SAME:
        return 0.0
    return stored
