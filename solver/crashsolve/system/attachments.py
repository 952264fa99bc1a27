"""Attached nodes: nodes that move with a rigid body, and transfer the forces on them to it.

    r = r_body + A s,   q = q_body q_s,   v = v_body + w x A s,   w = w_body
    v_dot = v_dot_body + w_dot x A s + w x (w x A s),   w_dot = w_dot_body
    f_body += f,   tau_body += tau + A s x f

Ambrosio (2003), Eq. 9-10: the forces on the nodes welded to a rigid part act on it. The chapter
prints the couples of Eq. 8 with the opposite sign, and Eq. 10 as if it were another Eq. 9.
Consequence to test: a free body of rigid and flexible parts keeps its angular momentum.
"""

from crashsolve.foundation.angles import times
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, point_at, point_velocity
from crashsolve.foundation.rotation import write_matrix
from crashsolve.foundation.vec3 import add, cross, put, vec


@kernel
def move_nodes(attached_nodes, nodes):
    """Configuration and velocity of every attached node from its body's. Writes: nodes."""
    for i in range(attached_nodes.shape[0]):
        attached_node = attached_nodes[i]
        body, node = nodes[attached_node.body], nodes[attached_node.node]
        d = arm(body, vec(attached_node.arm))
        put(node.r, point_at(body, d))
        put(node.v, point_velocity(body, d))
        put(node.w, vec(body.w))
        q = times(
            (body.q[0], body.q[1], body.q[2], body.q[3]),
            (
                attached_node.rotation[0],
                attached_node.rotation[1],
                attached_node.rotation[2],
                attached_node.rotation[3],
            ),
        )
        for k in range(4):
            node.q[k] = q[k]
        write_matrix(node.q, node.A)


@kernel
def set_accelerations(attached_nodes, nodes):
    """Accelerations of every attached node from its body's. Writes: nodes.v_dot, w_dot."""
    for i in range(attached_nodes.shape[0]):
        attached_node = attached_nodes[i]
        body, node = nodes[attached_node.body], nodes[attached_node.node]
        d, w = arm(body, vec(attached_node.arm)), vec(body.w)
        spin = add(cross(vec(body.w_dot), d), cross(w, cross(w, d)))
        put(node.v_dot, add(vec(body.v_dot), spin))
        put(node.w_dot, vec(body.w_dot))


@kernel
def transfer_forces(attached_nodes, nodes):
    """Forces and torques on attached nodes go to their bodies. Writes: nodes."""
    for i in range(attached_nodes.shape[0]):
        attached_node = attached_nodes[i]
        body, node = nodes[attached_node.body], nodes[attached_node.node]
        f = vec(node.force)
        add_to(body.force, f)
        add_to(body.torque, add(vec(node.torque), cross(arm(body, vec(attached_node.arm)), f)))
        put(node.force, (0.0, 0.0, 0.0))
        put(node.torque, (0.0, 0.0, 0.0))
        # its share of the body's inertia serves what acts on the body too; dampers there, most of
        # them of contacts, are counted as between two bodies that move: against the ground half is
        # exact
        node.stiffness += body.stiffness
        node.damping += 0.5 * body.damping
