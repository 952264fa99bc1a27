"""Webbing that a surface carries along as it rotates under the belt.

A material point of the surface divides an arc between the segments before and behind it. A point
that comes to an end of the arc leaves the belt: from there on the end of the arc divides it, and
the webbing that goes with the surface passes to the other segment at the strain that it has. The
surface works on it by the difference of the forces, over the length that passes.
Consequence to test: a drum that rotates under a belt for many turns takes from one side what it
brings to the other, and the energy closes.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, dot, scale, sub, triple


@kernel
def divide_arc(k, j, arc, middle, lies, old, new):
    """Division of the arc on surface k, fitting j; `middle` and `lies` in axes of the body.
    Writes: new.
    """
    wanted = old.split[k] if old.touches[k] == 1 else 0.0
    if arc.touches == 1 and old.touches[k] == 1:
        mean = scale(0.5, add(lies, triple(old.lies, k)))
        wanted += dot(sub(middle, triple(old.middle, k)), mean)
    half = 0.5 * arc.length if arc.touches == 1 else 0.0
    new.split[k] = max(-half, min(half, wanted))
    new.excess[k] = wanted - new.split[k]
    if new.excess[k] != 0.0:
        i = j if new.excess[k] > 0.0 else j - 1
        stretch = max(old.straight[i] / old.webbing[i], 1.0)
        new.carried[j] = -new.excess[k] / stretch


@kernel
def carry_webbing(p, old, new):
    """Webbing and residual elongation of each segment, before any flow. Writes: new."""
    for i in range(p.segments):
        new.webbing_0[i] = old.webbing[i]
        new.residual_0[i] = old.residual[i]
    for j in range(1, p.segments):
        w = new.carried[j]
        if w != 0.0:
            S = carried_residual(old, j, w)
            new.webbing_0[j - 1] -= w
            new.webbing_0[j] += w
            new.residual_0[j - 1] -= S
            new.residual_0[j] += S


@kernel
def carried_residual(old, j, w):
    """Residual elongation that passes fitting j with the webbing w [m]."""
    i = j - 1 if w > 0.0 else j
    return w * old.residual[i] / old.webbing[i]
