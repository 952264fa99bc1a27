"""Forces through a section of a shell: those of the cut elements on their corners in front.

    f = sum f_c,   m = sum t_c + (x_c - x) x f_c     over the corners in front of the plane

x is the mean of all corners of the cut elements. Which elements a plane cuts is found at the start
and stays. They are computed again at every sample, and cost no time in steps. Consequence to
test: f and m alone change the momenta of the part in front.
"""

from crashsolve.elements.shells.forces.corners import corner
from crashsolve.elements.shells.records import WORK
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, cross, put, scale, sub, vec

CUT_ELEMENT = Record("""
    part    index     row of the part
    kind    index     of the element, in KINDS
    first   index     numbers of its block
    corner  index     corners of its block
    lane    index     its position in the block
    cut     index     that it belongs to
    front   flag   4  whether a corner is in front
""")
CUT = Record("""
    force     N      3  on the part in front
    moment    N m    3  on the part in front, about `position`
    position  m      3  middle of the cut elements
    corners   count     of the cut elements
""")
OUTPUT = ("force", "moment", "position")


@kernel
def open_cuts(scene):
    """Clear the sums of all cuts. Writes: scene.cuts."""
    for i in range(scene.cuts.shape[0]):
        cut = scene.cuts[i]
        cut.corners = 0
        for k in range(3):
            cut.force[k] = cut.moment[k] = cut.position[k] = 0.0


@kernel
def add_cut_element(element_cut, scene):
    """Add the corner forces of a cut element of the present block. Writes: scene.cuts."""
    cut, work = scene.cuts[element_cut.cut], scene.work
    last = -1
    for c in range(4):
        point = scene.corners[element_cut.corner + LANES * c + element_cut.lane]
        # a triangle has one corner twice
        if point == last:
            continue
        x, last = vec(scene.points[point].r), point
        add_to(cut.position, x)
        cut.corners += 1
        if element_cut.front[c] == 1:
            f, t = (
                corner(work, WORK.force, c, element_cut.lane),
                corner(work, WORK.torque, c, element_cut.lane),
            )
            add_to(cut.force, f)
            add_to(cut.moment, add(t, cross(x, f)))


@kernel
def close_cuts(scene):
    """Refer the moments to the middles of the cuts. Writes: scene.cuts."""
    for i in range(scene.cuts.shape[0]):
        cut = scene.cuts[i]
        x = scale(1.0 / cut.corners, vec(cut.position))
        put(cut.position, x)
        put(cut.moment, sub(vec(cut.moment), cross(x, vec(cut.force))))
