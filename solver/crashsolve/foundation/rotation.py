"""Unit quaternions q = (w, x, y, z) and the rotation matrices that take body to world components.

The step uses the Cayley map, q_new = q * (1, h/2 Omega) / |...|: no trigonometry, and it is exactly
the rotation of the energy and momentum conserving midpoint rule (Simo and Wong 1991).
"""

from math import sqrt, tan

from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, cross, dot, scale, sub


@kernel
def rotate_by_cayley(q, half_angle, out):
    """Rotate quaternion q by the Cayley map of the body-frame vector h/2 Omega. Writes: out."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    a, b, c = half_angle
    nw = w - x * a - y * b - z * c
    nx = x + w * a + y * c - z * b
    ny = y + w * b + z * a - x * c
    nz = z + w * c + x * b - y * a
    # normalising with the actual length keeps |q| = 1 to round-off for ever
    s = 1.0 / sqrt(nw * nw + nx * nx + ny * ny + nz * nz)
    out[0] = nw * s
    out[1] = nx * s
    out[2] = ny * s
    out[3] = nz * s


@kernel
def rotate_by_vector(q, rotation, out):
    """Rotate quaternion q by a rotation vector in body axes [rad]. Writes: out."""
    angle = sqrt(dot(rotation, rotation))
    half = tan(0.5 * angle) / angle if angle > 1e-8 else 0.5
    rotate_by_cayley(q, scale(half, rotation), out)


@kernel
def write_matrix(q, A):
    """Rotation matrix of quaternion q, by rows. Writes: A."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    A[0] = 1.0 - 2.0 * (y * y + z * z)
    A[1] = 2.0 * (x * y - w * z)
    A[2] = 2.0 * (x * z + w * y)
    A[3] = 2.0 * (x * y + w * z)
    A[4] = 1.0 - 2.0 * (x * x + z * z)
    A[5] = 2.0 * (y * z - w * x)
    A[6] = 2.0 * (x * z - w * y)
    A[7] = 2.0 * (y * z + w * x)
    A[8] = 1.0 - 2.0 * (x * x + y * y)


@kernel
def write_world_tensor(A, body, world):
    """world = A body A^T for a symmetric body-frame tensor. Writes: world."""
    for j in range(3):
        t = matvec(body, (A[3 * j], A[3 * j + 1], A[3 * j + 2]))
        for k in range(3):
            world[3 * j + k] = A[3 * k] * t[0] + A[3 * k + 1] * t[1] + A[3 * k + 2] * t[2]


@kernel
def midpoint_spin(J, J_inv, p, h):
    """Body-frame Omega of the free body over a step: J Omega + h/2 Omega x J Omega = p.

    p is the body-frame angular momentum at the start [kg m^2/s]. Newton's method; the Jacobian
    J + h/2 ([Omega] J - [J Omega]) is regular while h |Omega| stays well below 2.
    """
    s = 0.5 * h
    W = matvec(J_inv, p)
    gyro = cross(W, p)
    # about a principal axis, as all bodies of a plane model, that is all
    if gyro[0] == 0.0 and gyro[1] == 0.0 and gyro[2] == 0.0:
        return W
    # it spares an iteration of Newton's method, which costs four times as much
    W = sub(W, scale(s, matvec(J_inv, gyro)))
    for _ in range(12):
        JW = matvec(J, W)
        f = sub(add(JW, scale(s, cross(W, JW))), p)
        if dot(f, f) <= 1e-31 * dot(p, p):
            break
        a = newton_column(J, W, JW, s, 0)
        b = newton_column(J, W, JW, s, 1)
        c = newton_column(J, W, JW, s, 2)
        bc = cross(b, c)
        det = dot(a, bc)
        W = sub(W, (dot(f, bc) / det, dot(f, cross(c, a)) / det, dot(f, cross(a, b)) / det))
    return W


@kernel
def newton_column(J, W, JW, s, k):
    """Column k of J + s ([W] J - [JW])."""
    j = (J[k], J[3 + k], J[6 + k])
    e = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
    return add(j, scale(s, sub(cross(W, j), cross(JW, e))))
