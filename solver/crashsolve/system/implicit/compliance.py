"""Linear equations of an implicit stage: springs as compliant constraint rows.

    dv = b + M^-1 D^T m,   dq = a + t dv,   D dv = D b for a joint, for a spring
    m = -t (k D dq + c (D dv + G dq)),   G = derivative of D v by the position

With B = D + c t G / (c + k t) in the place of D, and sigma = t (c + k t), these are

    (B M^-1 B^T + 1 / sigma) m = -B b - (k D + c G) a / (c + k t)

A joint is a spring with 1 / sigma = 0. Springs of any stiffness are thus solved with the joints in
one symmetric positive definite matrix, of the size of the rows and not of the bodies, by the
factorisation that joints have already. B^T for D^T on the side of the force, how a force turns with
the bodies and the gyroscopic torque are left to the iteration: they shrink with the step, however
stiff the spring.

Reference: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.saddle import assemble, eliminate
from crashsolve.system.constraints import weigh

# 1 / sigma of a row without stiffness or with a negative one: it takes no part
NO_PART = 1e150


@kernel
def linearise(rows, compliant, nodes, velocity, position):
    """D of the joints, and B and B M^-1 of the springs, at the present place. Writes: compliant."""
    joint_rows = rows.shape[0]
    for k in range(compliant.shape[0]):
        row = compliant[k]
        a, b = nodes[row.node_a], nodes[row.node_b]
        if k < joint_rows:
            for j in range(12):
                row.D[j] = rows[k].D[j]
        else:
            lean(row, velocity, position)
        weigh(row.D, row.X, 0, a)
        weigh(row.D, row.X, 6, b)


@kernel
def lean(row, velocity, position):
    """D becomes B, and G becomes (k D + c G) / (c + k t), t = position / velocity. Writes: row."""
    D, G, k, c = row.D, row.G, row.stiffness, row.damping
    ease = velocity * c + position * k
    for j in range(12):
        d, g = D[j], G[j]
        D[j] = d + c * position / ease * g if ease > 0.0 else d
        G[j] = velocity * (k * d + c * g) / ease if ease > 0.0 else 0.0


@kernel
def factor_compliant(saddle, compliant, joint_rows, position, velocity):
    """Factor of D M^-1 D^T + 1 / sigma, sigma = position k + velocity c. Writes: saddle."""
    assemble(saddle.pairs, saddle.blocks, compliant)
    columns, blocks = saddle.columns, saddle.blocks
    for p in range(columns.shape[0]):
        c = columns[p]
        if c.entry >= joint_rows:
            x = blocks[c.block].x
            for i in range(c.rows):
                x[7 * i] += give(compliant[c.entry + i], position, velocity)
    eliminate(saddle)


@kernel
def give(row, position, velocity):
    """1 / sigma of a row [1/kg]."""
    sigma = position * row.stiffness + velocity * row.damping
    return 1.0 / sigma if sigma > 1.0 / NO_PART else NO_PART
