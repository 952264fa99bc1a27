"""Slack that is taken up within a step.

Where one segment is slack none has a force, since T_high <= T_low exp(mu beta): slack passes rings
without resistance until the whole belt is straight. Friction begins there, at the share of the step
    theta = (sum (L + S) - sum l_old) / (sum l_new - sum l_old)
with the webbing L_i + S_i = l_i(theta) in every segment.
Consequence to test: forces behind rings with friction do not depend on the step in which the slack
ends, and converge with its square.
"""

from crashsolve.belts._spool import LOCKED
from crashsolve.foundation.kernels import kernel


@kernel
def take_up_slack(p, old, new, out):
    """Lets slack that ends in the step pass before any flow with friction. Writes: new."""
    if old.tension[0] > 0.0 or p.segments < 2 or (p.spool == 1 and new.mode != LOCKED):
        return
    free = before = after = 0.0
    for i in range(p.segments):
        free += new.webbing_0[i] + new.residual_0[i]
        before += old.straight[i]
        after += max(out.length[i], p.shortest)
    if not (before < free and free < after):
        return
    theta = (free - before) / (after - before)
    for i in range(p.segments - 1):
        length = old.straight[i] + theta * (max(out.length[i], p.shortest) - old.straight[i])
        # what is too long passes the next fitting, with its residual elongation
        surplus = new.webbing_0[i] + new.residual_0[i] - length
        giver = i if surplus > 0.0 else i + 1
        residual = new.residual_0[giver] / new.webbing_0[giver]
        w = surplus / (1.0 + residual)
        new.webbing_0[i] -= w
        new.residual_0[i] -= w * residual
        new.webbing_0[i + 1] += w
        new.residual_0[i + 1] += w * residual
        new.carried[i + 1] += w
