"""Tangents of the contact pairs of one group: of the normal force, of tilting, of friction."""

from crashsolve.foundation.kernels import stage
from crashsolve.foundation.motion import no_tangent, point_tangent
from crashsolve.foundation.vec3 import cross
from crashsolve.system.contact import areas, touches


@stage
def contact_tangents(group, first, clock, nodes, curves, compliant, scene):
    """Tangents of all pairs. Writes: compliant, from row `first` on."""
    params, history = group.parameters, group.history
    for i in range(params.shape[0]):
        p, old, at = params[i], history[clock.current, i], first + group.tangent_rows * i
        if old.active == 0:
            for j in range(group.tangent_rows):
                no_tangent(compliant[at + j])
            continue
        a, b = group.elements_a[p.a], group.elements_b[p.b]
        depth, n, x = group.narrow.gap(a, b, nodes, group.data)
        if group.keeps_faces and old.retains_face == 1:
            depth, n, x, _ = group.narrow.gap_by(a, b, nodes, group.data, old.normal)
        depth = max(depth, 0.0)
        m, w = nodes[a.node], nodes[b.node]
        rate, slip, d_a, d_b = touches.closing_motion(m, w, x, n)
        mob_a, mob_b = touches.pair_mobility(m, w, d_a, d_b, n)
        mass = 1.0 / (mob_a + mob_b)
        k, c = group.normal.normal_tangent(p, old, depth, rate, mass, curves)
        if group.has_shares:
            k, c = a.share * k, a.share * c
        point_tangent(compliant[at], n, d_a, d_b, k, c)
        if group.friction or group.is_flat:
            f, _, _, _, _, _ = group.normal.normal_force(
                p, old, history[1 - clock.current, i], 0.0, depth, rate, mass, curves
            )
            if group.has_shares:
                f = a.share * f
        if group.is_flat:
            count, radius = group.narrow.patch(a, b, nodes, group.data, n, x)
            if group.has_radius:
                radius = max(radius, p.torsion_radius)
            spots, tilt = group.data[0], 3.0 * f / (a.edge + b.edge)
            areas.tilt_tangents(compliant[at + 1], compliant[at + 2], spots, count, n, x, tilt, c)
        elif group.has_radius:
            radius = p.torsion_radius
        if group.resists_spin:
            row = at + 3 if group.is_flat else at + 1
            slip = areas.combined_slip(m, w, slip, n, radius)
            c, c_across = group.friction.friction_tangent(p, f, slip)
            u = touches.unit_slip((0.0, 0.0, 0.0), slip, n)
            u_1, u_2 = areas.tangents(u)
            areas.friction_tangent_row(compliant[row], u, n, radius, d_a, d_b, c)
            areas.friction_tangent_row(compliant[row + 1], u_1, n, radius, d_a, d_b, c_across)
            areas.friction_tangent_row(compliant[row + 2], u_2, n, radius, d_a, d_b, c_across)
        elif group.friction:
            c, c_across = group.friction.friction_tangent(p, f, slip)
            u = touches.unit_slip((0.0, 0.0, 0.0), slip, n)
            point_tangent(compliant[at + 1], u, d_a, d_b, 0.0, c)
            point_tangent(compliant[at + 2], cross(n, u), d_a, d_b, 0.0, c_across)
