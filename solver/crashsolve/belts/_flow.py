"""Webbing that flows through rings within a step, as far as friction lets it.

    T_high <= T_low exp(mu beta)   at every ring,   and where it flows, to the higher side, equality
    L_i = L_i(old) + q_i - q_(i+1),   q_j the webbing that passes fitting j in the step

The flows q are unknowns of the step, at its present geometry: results depend on the step only by
the order in which forces rise. Newton's method on the rings that slip, which are determined anew in
every iteration; the matrix is tridiagonal, with a dominant diagonal. Where it does not converge,
rings are settled one after the other, which is slow and robust. Residual elongation S = s L
passes with the webbing of the side it leaves, and is mixed into that of the other side, which is
exact for webbing that unloads by one slope.

Reference: OpenRadioss theory manual, slip ring elements.
"""

from math import exp

from crashsolve.belts._carry import carry_webbing
from crashsolve.belts._slack import take_up_slack
from crashsolve.belts._spool import (
    EMPTY,
    LOCKED,
    PULLING,
    choose_mode,
    spool_direction,
    spool_force,
    stroke_left,
    webbing_left,
)
from crashsolve.belts._webbing import elastic_force, segment_force
from crashsolve.foundation.kernels import kernel

# iterations in all, those of Newton's method at first, and every which one is of it later
ITERATIONS, FIRST, NEWTON_EVERY = 5000, 8, 4
# after so many, and again after as many, no further one is needed where forces are in balance
BALANCED_EVERY = 300
# iterations after which rings are solved one after the other alone
RINGS_ALONE = 100
# of a flow through one ring, over the webbing on both sides: less than their lengths resolve
ROUND_OFF = 1.1e-16
# of a flow, over the length of the belt: treated as zero
CLOSE = 1e-15
# the same after so many iterations, where round-off of tight segments keeps flows moving
NEARLY, MANY = 1e-13, 40
# too small to affect any result: a flow over the length of the belt, a force over its stiffness
SETTLED = 1e-10
# of a segment, that one iteration may take from it
MAX_WITHDRAWN = 0.8
# halvings and steps of the flow through one ring, and of the changes of all
HALVINGS, FLOW_HALVINGS = 60, 12


@kernel
def solve_flow(p, old, new, out, t, h, curves):
    """Flows, lengths and forces. Writes: new, out.

    The search begins with the flows of the last step: rings that slip go on to slip, so that the
    set of those that do is soon found. Slack has no place of its own, and stays where it is only if
    the search begins without flow.
    """
    choose_mode(p, old, new, t)
    carry_webbing(p, old, new)
    take_up_slack(p, old, new, out)
    for j in range(p.segments + 1):
        mu = p.friction_coefficient[j]
        new.grip[j] = exp(mu * out.angle[j]) if mu > 0.0 else 1.0
    begins_taut = h > 0.0 and p.segments > 1 and is_taut(p, old.tension)
    if not (begins_taut and find_flow(p, 1.0, old, new, out, curves)):
        find_flow(p, 0.0, old, new, out, curves)
    if p.spool == 1 and new.flow[0] > webbing_left(p, old):
        new.mode = EMPTY
        find_flow(p, 0.0, old, new, out, curves)
    if new.iterations >= ITERATIONS:
        record_imbalance(p, old, new, out, curves)
    for j in range(p.segments + 1):
        new.slip[j] = old.slip[j] + new.flow[j] + new.carried[j]


@kernel
def find_flow(p, share, old, new, out, curves):
    """Search from this share of the last flows through rings; whether there are some, and it ends,
    with all segments taut before and after. Writes: new, out.
    """
    new.flow[0] = webbing_left(p, old) if new.mode == EMPTY else 0.0
    new.flow[p.segments] = 0.0
    for j in range(1, p.segments):
        new.flow[j] = share * old.flow[j]
    fill(p, old, new, out, curves)
    if share > 0.0 and not is_taut(p, out.force):
        return False
    if p.segments > 1 or p.spool == 1:
        new.iterations, largest = ITERATIONS, 0.0
        for k in range(ITERATIONS):
            if k < FIRST or (k % NEWTON_EVERY == 0 and k < RINGS_ALONE):
                largest = correct(p, old, new, out, curves)
                if largest != 0.0:
                    fill(p, old, new, out, curves)
            else:
                largest = relax_rings(p, old, new, out, curves)
            if largest <= (CLOSE if k < MANY else NEARLY) * p.total:
                new.iterations = k + 1
                break
            # slack may pass between segments without end, and round-off keep flows moving
            if (k + 1) % BALANCED_EVERY == 0 and is_balanced(p, largest, old, new, out, curves):
                new.iterations = k + 1
                break
    return share > 0.0 and new.iterations < ITERATIONS and is_taut(p, out.force)


@kernel
def is_balanced(p, largest, old, new, out, curves):
    """Whether the last change of a flow [m] or the forces out of balance are negligible."""
    if largest <= SETTLED * p.total:
        return True
    return imbalance(p, old, new, out, curves) <= SETTLED * p.k


@kernel
def record_imbalance(p, old, new, out, curves):
    """Record flows that are not found. Writes: new."""
    missing = imbalance(p, old, new, out, curves)
    if missing > SETTLED * p.k:
        new.unbalanced = max(old.unbalanced, missing)
        new.unsettled = old.unsettled + 1


@kernel
def is_taut(p, force):
    """Whether all segments are: slack that has been taken up ends with forces next to nothing."""
    least = force[0]
    for i in range(1, p.segments):
        least = min(least, force[i])
    return least > SETTLED * p.k


@kernel
def imbalance(p, old, new, out, curves):
    """By how much a force is beyond friction or the spool, or within it where webbing flows [N]."""
    worst = 0.0
    if p.spool == 1 and new.mode != EMPTY:
        over = out.force[0] - spool_force(p, old, new.mode, new.flow[0], curves)[0]
        q = new.flow[0]
        if new.mode == LOCKED and q <= 0.0:
            over = max(over, 0.0)
        elif new.mode == PULLING and q >= 0.0:
            over = min(over, 0.0)
        worst = abs(over)
    for j in range(1, p.segments):
        T_a, T_b, c, q = out.force[j - 1], out.force[j], new.grip[j], new.flow[j]
        onwards, back = T_b - c * T_a, T_a - c * T_b
        if abs(q) <= SETTLED * p.total:
            worst = max(worst, onwards, back)
        else:
            worst = max(worst, abs(onwards if q > 0.0 else back))
    return worst


@kernel
def residual_elongation(p, new, j, q):
    """Residual elongation that passes fitting j with the webbing q [m]."""
    if j == 0 or j == p.segments:
        return 0.0
    i = j - 1 if q > 0.0 else j
    S = new.residual_0[i]
    return q * S / new.webbing_0[i] if S != 0.0 else 0.0


@kernel
def fill(p, old, new, out, curves):
    """Webbing, residual elongation and force of each segment after the flows. Writes: new, out."""
    for i in range(p.segments):
        if p.curve > 0:
            fill_one(p, i, old, new, out, curves)
        else:
            fill_elastic(p, i, old, new, out)


@kernel
def fill_elastic(p, i, old, new, out):
    """Those of segment i of webbing without a curve, and no residual elongation. Writes: new, out.

    It is part of the search, where a call of `fill_one` costs as much as its work.
    """
    L = new.webbing_0[i] + new.flow[i] - new.flow[i + 1]
    T, softens = elastic_force(p, max(out.length[i], p.shortest), L)
    new.webbing[i], new.residual[i], new.moved[i] = L, 0.0, 0.0
    new.softens[i], out.force[i] = softens, T


@kernel
def fill_one(p, i, old, new, out, curves):
    """Webbing, residual elongation and force of segment i. Writes: new, out."""
    q_in, q_out = new.flow[i], new.flow[i + 1]
    L = new.webbing_0[i] + q_in - q_out
    S = (
        new.residual_0[i]
        + residual_elongation(p, new, i, q_in)
        - residual_elongation(p, new, i + 1, q_out)
    )
    length = max(out.length[i], p.shortest)
    T, softens, moved = segment_force(p, length, L, S, curves)
    new.webbing[i], new.residual[i], new.moved[i] = L, S + moved, moved
    new.softens[i], out.force[i] = softens, T


@kernel
def relax_rings(p, old, new, out, curves):
    """Settles each ring between its neighbours as they are; the largest change of a flow [m].

    Slow and robust: the force of a segment falls with its own webbing alone. Writes: new, out.
    """
    largest = 0.0
    if p.spool == 1:
        before = new.flow[0]
        solve_spool(p, old, new, out, curves)
        largest = abs(new.flow[0] - before)
    for k in range(2 * p.segments - 2):
        j = k + 1 if k < p.segments - 1 else 2 * p.segments - 2 - k
        before = new.flow[j]
        solve_ring(p, j, old, new, out, curves)
        largest = max(largest, abs(new.flow[j] - before))
    return largest


@kernel
def apply_flow(p, j, q, old, new, out, curves):
    """Gives ring j the flow q. Writes: new, out."""
    new.flow[j] = q
    fill_one(p, j - 1, old, new, out, curves)
    fill_one(p, j, old, new, out, curves)


@kernel
def solve_ring(p, j, old, new, out, curves):
    """The flow through ring j at which it holds, or slips on the edge. Writes: new, out."""
    c, start = new.grip[j], new.flow[j]
    # all that either side can give
    low, high = start - new.webbing[j], start + new.webbing[j - 1]
    if low < 0.0 and high > 0.0:
        apply_flow(p, j, 0.0, old, new, out, curves)
        if out.force[j] > c * out.force[j - 1]:
            low = 0.0
        elif out.force[j - 1] > c * out.force[j]:
            high = 0.0
        else:
            return
        start = 0.0
    onwards = low >= 0.0
    q = min(max(start, low), high)
    for _ in range(HALVINGS):
        apply_flow(p, j, q, old, new, out, curves)
        T_a, T_b = out.force[j - 1], out.force[j]
        g_a, g_b = new.softens[j - 1], new.softens[j]
        excess = T_b - c * T_a if onwards else c * T_b - T_a
        slope = g_b + c * g_a if onwards else c * g_b + g_a
        if excess == 0.0:
            break
        if excess > 0.0:
            low = q
        else:
            high = q
        following = q + excess / slope if slope > 0.0 else 0.5 * (low + high)
        if not (low < following and following < high):
            following = 0.5 * (low + high)
        if abs(following - q) <= CLOSE * p.total:
            break
        q = following


@kernel
def pay_out(p, q, old, new, out, curves):
    """Lets q out: how far the force is over that of the spool [N]. Writes: new, out."""
    new.flow[0] = q
    fill_one(p, 0, old, new, out, curves)
    return out.force[0] - spool_force(p, old, new.mode, q, curves)[0]


@kernel
def solve_spool(p, old, new, out, curves):
    """The flow from the spool between its first ring and itself. Writes: new, out."""
    q = new.flow[0]
    if new.mode == EMPTY:
        return
    low, high = q - 0.99 * new.webbing[0], q + p.total
    if new.mode == PULLING:
        low, high = max(low, -stroke_left(p, old, curves)), 0.0
        if low > 0.0 or pay_out(p, 0.0, old, new, out, curves) >= 0.0:
            pay_out(p, 0.0, old, new, out, curves)
            return
    if new.mode == LOCKED:
        low = 0.0
        if pay_out(p, 0.0, old, new, out, curves) <= 0.0:
            return
    for _ in range(HALVINGS):
        q = 0.5 * (low + high)
        if pay_out(p, q, old, new, out, curves) > 0.0:
            low = q
        else:
            high = q


@kernel
def spool_row(p, old, new, out, curves):
    """Diagonal, upper and right side of the spool's equation. Writes: new."""
    F, slope = spool_force(p, old, new.mode, new.flow[0], curves)
    new.direction[0] = spool_direction(new, out, F)
    if new.direction[0] == 0:
        return 0.0, 0.0, 0.0
    g, T = new.softens[0], out.force[0]
    if g == 0.0:
        # slack: as much as makes it taut
        length = max(out.length[0], p.shortest)
        taut = (length - new.residual[0]) / (1.0 + F / p.k)
        change = taut - new.webbing[0]
        if new.mode == PULLING:
            change = max(change, -stroke_left(p, old, curves) - new.flow[0])
        return 1.0, 0.0, change
    return max(g + slope, 0.1 * g), -g, T - F


@kernel
def direction_of(new, out, j):
    """1 if webbing may pass ring j onwards, -1 back, 0 if it holds; 2 both, without friction."""
    T_a, T_b, c, q = out.force[j - 1], out.force[j], new.grip[j], new.flow[j]
    if c == 1.0:
        return 2
    if q > 0.0 or (q == 0.0 and T_b > c * T_a):
        return 1
    return -1 if q < 0.0 or T_a > c * T_b else 0


@kernel
def slack_of_segment(p, new, out, j, direction):
    """Length that a slack segment passes through ring j until it is taut, of the sign of the flow
    [m].
    """
    if direction == 0 or out.force[j] == out.force[j - 1]:
        return 0.0
    sign = 1.0 if out.force[j] > out.force[j - 1] else -1.0
    i = j - 1 if sign > 0.0 else j
    T = max(out.force[j], out.force[j - 1]) / new.grip[j]
    taut = (max(out.length[i], p.shortest) - new.residual[i]) / (1.0 + T / p.k)
    return sign * max(new.webbing[i] - taut, 0.0)


@kernel
def ring_row(new, out, j):
    """Row of ring j: three coefficients, and the force beyond friction [N]; zero where it holds."""
    c, direction = new.grip[j], new.direction[j]
    g_a, g_b = new.softens[j - 1], new.softens[j]
    T_a, T_b = out.force[j - 1], out.force[j]
    if direction > 0:
        return -c * g_a, g_b + c * g_a, -g_b, T_b - c * T_a
    if direction == -1:
        return -g_a, g_a + c * g_b, -c * g_b, c * T_b - T_a
    return 0.0, 0.0, 0.0, 0.0


@kernel
def rings_are_balanced(p, new, out):
    """Whether each ring holds, or would by itself pass no more than round-off. Writes: new."""
    balanced = True
    for j in range(1, p.segments):
        new.direction[j] = direction_of(new, out, j)
        _, diagonal, _, right = ring_row(new, out, j)
        least = ROUND_OFF * (new.webbing[j - 1] + new.webbing[j])
        balanced = balanced and abs(right) <= least * diagonal
    return balanced


@kernel
def correct(p, old, new, out, curves):
    """One iteration over all rings; the largest change of a flow [m]. Writes: new."""
    above, change = 0.0, 0.0
    if p.spool == 1:
        diagonal, upper, right = spool_row(p, old, new, out, curves)
        if diagonal > 0.0:
            above, change = upper / diagonal, right / diagonal
    if rings_are_balanced(p, new, out) and change == 0.0:
        return 0.0
    new.above[0], new.change[0] = above, change
    n, moves = p.segments, change != 0.0
    for j in range(1, n):
        lower, diagonal, upper, right = ring_row(new, out, j)
        pivot = diagonal - lower * above
        if pivot > 1e-9 * diagonal:
            above, change = upper / pivot, (right - lower * change) / pivot
        else:
            # a spool draws in slack webbing; friction may hold it
            above, change = 0.0, slack_of_segment(p, new, out, j, new.direction[j])
        new.above[j], new.change[j] = above, change
        moves = moves or change != 0.0
    new.above[n] = new.change[n] = 0.0
    return apply_changes(p, old, new) if moves else 0.0


@kernel
def apply_changes(p, old, new):
    """Flows after the elimination; the largest change of one [m]. Writes: new."""
    n, share, behind = p.segments, 1.0, 0.0
    for back in range(1, n + 1):
        j = n - back
        behind = new.change[j] - new.above[j] * behind
        new.change[j] = behind
    for i in range(n):
        taken = new.change[i + 1] - new.change[i]
        if taken > MAX_WITHDRAWN * new.webbing[i]:
            share = min(share, MAX_WITHDRAWN * new.webbing[i] / taken)
    # flows that stick in place of turning back leave those beside them alone
    for _ in range(FLOW_HALVINGS):
        if leaves_webbing(p, share, old, new):
            break
        share *= 0.5
    largest = 0.0
    for j in range(n):
        new.flow[j] = changed_flow(new, j, share)
        largest = max(largest, abs(share * new.change[j]))
    return largest


@kernel
def changed_flow(new, j, share):
    """The flow through ring j after a share of its change; one that would turn back sticks."""
    now = new.flow[j] + share * new.change[j]
    return 0.0 if now * new.direction[j] < 0.0 and new.direction[j] < 2 else now


@kernel
def leaves_webbing(p, share, old, new):
    """Whether a share of the changes leaves webbing in every segment, of what it has now."""
    least = 0.5 * (1.0 - MAX_WITHDRAWN)
    onwards = changed_flow(new, 0, share)
    for i in range(p.segments):
        before, onwards = onwards, 0.0
        if i < p.segments - 1:
            onwards = changed_flow(new, i + 1, share)
        if not new.webbing_0[i] + before - onwards > least * new.webbing[i]:
            return False
    return True
