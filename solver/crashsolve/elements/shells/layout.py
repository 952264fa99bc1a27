"""A shell part in place: nodes and their masses, supports, starts, and the blocks of its elements.

    m_node = sum of shares of rho t A,   J_node = sum of shares of m (A + t^2) / 12

A quadrilateral gives a quarter to each corner, a triangle a third. Consequence to test: mass and
momentum of the nodes are those of the elements.
"""

from __future__ import annotations

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.elements.damping import IMPLICIT, mass_factors, report_added_mass
from crashsolve.elements.shells import outputs
from crashsolve.elements.shells.cards import MOTIONS, ShellCard
from crashsolve.elements.shells.forces.triangle import rate_bound as triangle_bound
from crashsolve.elements.shells.geometry import (
    blocks_of,
    diagonals,
    in_lanes,
    nearest,
    quad_bound,
    rule,
    sides,
    sorted_mesh,
)
from crashsolve.elements.shells.outputs import PIECE
from crashsolve.elements.shells.records import (
    BLOCK,
    EROSION,
    VISCOUS,
)
from crashsolve.foundation.distinct import distinct
from crashsolve.foundation.point import ATTACHED, LANES

# points in the plane of a quadrilateral
POINTS = {"reduced": 1, "fully_integrated": 4, "triangles": 1}


class DiscretisedShell:
    """A shell part in place: its mesh, with the masses of its nodes."""

    def __init__(self, card: ShellCard, scene: Scene) -> None:
        self.law, self.material = scene.law("materials", card.material)
        self.card = card
        self.layer_rows = self.law.layer_rows(self.material)
        if self.law.LARGE_STRAIN and not card.thinning:
            raise scene.fail("must be true at large strain, where a shell gets thinner", "thinning")
        self.can_fail = getattr(self.material, "failure_strain", None) is not None
        if self.can_fail and not self.law.VON_MISES:
            message = f"material '{card.material}' has failure_strain, and no law that fails by it"
            raise scene.fail(message, "material")
        self._refuse_explicit(scene)
        self.rule = rule(card, scene)
        self.points = POINTS[card.element]
        self.mesh = sorted_mesh(scene.mesh(card), card.element == "triangles")
        self.quad_count = int((self.mesh.quads[:, 2] != self.mesh.quads[:, 3]).sum())
        x = self.mesh.points[self.mesh.quads]
        normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
        self.area = 0.5 * np.linalg.norm(normal, axis=1)
        self._refuse_bad(x, normal, scene)
        n, own = len(self.mesh.points), self.mesh.own
        corners = self.mesh.quads.ravel()
        self.first = 0  # of the mesh's points among all, once parts are numbered
        # points of its elements, and those that it moves: of a shared mesh not all
        self.used = np.arange(n) if own is None else distinct(corners)
        self.own = slice(0, n) if own is None else own
        self.is_damped = bool(card.damping or card.viscosity or card.mass_scaling)
        self.mass_factors = self._mass_factors(scene)
        share = np.full(x.shape[:2], 0.25)
        share[self.quad_count :] = [1 / 3, 1 / 3, 1 / 3, 0]
        mass = share * (self.mass_factors * self.weight)[:, None]
        inertia = mass * self.radius_2[:, None]
        self.mass = np.bincount(corners, mass.ravel(), n)
        self.J = np.bincount(corners, inertia.ravel(), n)
        # contribution of each corner, to be summed over the parts of a shared mesh
        self.lumps = None if own is None else (corners, mass.ravel(), inertia.ravel())
        near = self.mesh.points[self.used]
        self.named = [int(self.used[nearest(near, node)]) for node in card.nodes]
        self.traced = [int(self.used[nearest(near, node)]) for node in card.traces]
        self.gauged = [nearest(x.mean(axis=1), position) for position in card.gauges]
        self.cuts = [sides(x, cut, scene) for cut in card.section_cuts]
        self.fixed = self._fixed(scene)
        self.velocity, self.spin = self._motion(scene)
        self.momentum = self._momentum(x, normal, share, scene)

    @property
    def weight(self) -> np.ndarray:
        """Masses of the elements [kg]."""
        mass: np.ndarray = self.material.density * self.card.thickness * self.area
        return mass

    @property
    def radius_2(self) -> np.ndarray:
        """Squared radii of gyration of the mass that elements give to nodes [m^2]."""
        squared: np.ndarray = (self.area + self.card.thickness**2) / 12.0
        return squared

    def _refuse_explicit(self, scene: Scene) -> None:
        """Refuse features of explicit methods under another method."""
        control = scene.deck.control
        method = f"integrator {control.integrator}"
        if control.solution == "quasi_static":
            method = "solution quasi_static"
        elif control.integrator not in IMPLICIT:
            return
        given = {
            "drag": (self.card.drag > 0.0, "drag on shells"),
            "mass_scaling": (self.card.mass_scaling is not None, "added mass"),
            "material": (self.can_fail, "a material with a failure_strain"),
        }
        for field, (is_given, words) in given.items():
            if is_given:
                message = f"{words} is for explicit steps, and {method} has none"
                raise scene.fail(f"{message}; set integrator: rattle", field)

    def _refuse_bad(self, x: np.ndarray, normal: np.ndarray, scene: Scene) -> None:
        """Refuse elements that are not convex: all corners must have one sense of rotation."""
        for k in range(4):
            area = np.cross(x[:, (k + 1) % 4] - x[:, k], x[:, (k + 3) % 4] - x[:, k])
            is_flipped = (area * normal).sum(1) > 1e-6 * (normal**2).sum(1)
            # the third side of a triangle has no length
            is_flipped[self.quad_count :] |= k > 1
            bad = np.flatnonzero(~is_flipped)
            if len(bad):
                where = ", ".join(f"{value:.4g}" for value in x[bad[0], k])
                message = (
                    f"element {bad[0] + 1} is degenerate or folded over at its corner ({where}) m; "
                    "its corners must go round a convex quadrilateral"
                )
                raise scene.fail(message, "mesh")

    def _mass_factors(self, scene: Scene) -> np.ndarray:
        """Factors on the masses of the elements (m,) by mass scaling."""
        if self.card.mass_scaling is None:
            return np.broadcast_to(1.0, self.area.shape)
        flat = diagonals(self.mesh.points[self.mesh.quads]).transpose(0, 2, 1).reshape(-1, 4)
        squares = np.array([self._square(k, tuple(sides)) for k, sides in enumerate(flat)])
        factors: np.ndarray = mass_factors(self.card, squares, scene)
        report_added_mass(self.card, self.weight, factors, scene)
        return factors

    def _square(self, element: int, flat: tuple[float, ...]) -> float:
        """Bound of the largest squared frequency of an element with these diagonals [1/s^2]."""
        law, t = self.material, self.card.thickness
        area = self.area[element]
        size, light = (area, t, (area + t * t) / 12.0), law.young / law.density
        if element >= self.quad_count:
            return float(triangle_bound(flat, *size, light, law.poisson))
        x = self.mesh.points[self.mesh.quads[element]]
        axes = np.column_stack([x[2] - x[0], x[3] - x[1]]) @ np.linalg.inv(
            np.reshape(flat, (2, 2)).T
        )
        odd = x[0] - x[1] + x[2] - x[3]
        skew = odd @ axes
        z = 0.25 * np.sqrt(max(odd @ odd - skew @ skew, 0.0))
        light /= 1.0 - law.poisson**2
        hourglass = (float(skew[0]), float(skew[1]))
        return float(quad_bound(flat, hourglass, float(z), *size, light, law.poisson))

    def _fixed(self, scene: Scene) -> np.ndarray:
        """Bits (n,) of the motions that supports and welds prevent, by node."""
        fixed = np.zeros(len(self.mesh.points), np.uint8)
        for k, hold in enumerate(self.card.supports):
            own = self.set_of(hold.nodes, f"supports.{k}.nodes", scene)
            for motion in hold.motions:
                fixed[own] |= 1 << MOTIONS.index(motion)
        for node, index in zip(self.card.nodes, self.named, strict=True):
            if fixed[index]:
                message = (
                    f"node '{node.name}' is supported; use traces for its history alone, and "
                    "load it in its other directions by a nodal_force on a set of nodes"
                )
                raise scene.fail(message, "nodes")
        fixed[self.named] = ATTACHED
        for k, weld in enumerate(self.card.welded):
            self.set_of(weld.nodes, f"welded.{k}.nodes", scene)
            own = self.welded_points(k)
            if fixed[own].any() or not len(own):
                message = "some of these nodes are supported, welded or named already"
                raise scene.fail(message, f"welded.{k}.nodes")
            fixed[own] = ATTACHED
        return fixed

    def welded_points(self, k: int) -> np.ndarray:
        """Numbers (n,) of the nodes of weld k, without those that earlier ones hold to its body:
        sets at the sides of a mesh have its corners in common.
        """
        weld, sets = self.card.welded[k], self.mesh.sets
        earlier = [sets[w.nodes] for w in self.card.welded[:k] if w.to and w.to == weld.to]
        own: np.ndarray = sets[weld.nodes]
        return own[~np.isin(own, np.concatenate(earlier))] if earlier else own

    def set_of(self, name: str, field: str, scene: Scene) -> np.ndarray:
        """Numbers (n,) of a set of nodes; an error of the deck where there is none such."""
        if name not in self.mesh.sets:
            known = ", ".join(sorted(self.mesh.sets)) or "none"
            raise scene.fail(f"the mesh has no set of nodes '{name}' (sets: {known})", field)
        own: np.ndarray = self.mesh.sets[name]
        if not len(own):
            message = f"set '{name}' has no node of these elements"
            raise scene.fail(f"{message}; name another, or leave it out", field)
        return own

    def _motion(self, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
        """Velocities [m/s] and angular velocities [rad/s] of the nodes (n, 3), without impulses."""
        origin = self.mesh.points[0] if self.mesh.origin is None else self.mesh.origin
        arm = self.mesh.points - origin
        velocity = np.asarray(self.card.velocity) + np.cross(self.card.angular_velocity, arm)
        spin = np.tile(np.asarray(self.card.angular_velocity, float), (len(arm), 1))
        given = np.zeros(len(arm), int)
        for k, some in enumerate(self.card.velocities):
            own = self.set_of(some.nodes, f"velocities.{k}.nodes", scene)
            for other in set(given[own][given[own] > 0]):
                before = self.card.velocities[other - 1]
                if some.model_copy(update={"nodes": before.nodes}) != before:
                    message = f"set '{before.nodes}' gives some of these nodes another velocity"
                    raise scene.fail(message, f"velocities.{k}.nodes")
            given[own] = k + 1
            velocity[own], spin[own] = some.velocity, some.angular_velocity
        return velocity, spin

    def velocities(self) -> np.ndarray:
        """Velocities [m/s] at the start (n, 3), including those by impulses."""
        if not np.any(self.momentum):
            return self.velocity
        return self.velocity + self.momentum / self.mass[:, None]

    def _momentum(
        self, x: np.ndarray, normal: np.ndarray, share: np.ndarray, scene: Scene
    ) -> np.ndarray:
        """Momenta [N s] of the nodes (n, 3) by impulses on elements."""
        if not self.card.impulses:
            return np.zeros(3)
        hit_elements = np.zeros_like(self.mesh.points)
        middle = (x * share[:, :, None]).sum(axis=1)
        arm = normal / np.linalg.norm(normal, axis=1)[:, None]
        for k, impulse in enumerate(self.card.impulses):
            hit = ((middle > impulse.low) & (middle < impulse.high)).all(axis=1)
            if not hit.any():
                raise scene.fail("no element has its middle in the box", f"impulses.{k}")
            momentum = (impulse.speed * self.weight * hit)[:, None] * arm
            for corner, part in zip(self.mesh.quads.T, share.T, strict=True):
                np.add.at(hit_elements, corner, part[:, None] * momentum)
        return hit_elements

    def write_points(self, table: np.ndarray) -> None:
        """Rows of POINT at the start, of the points that the part moves. Writes: table."""
        own = self.own
        table["r"], table["v"] = self.mesh.points[own], self.velocities()[own]
        table["w"] = self.spin[own]
        table["mass_inv"], table["J_inv"] = 1.0 / self.mass[own], 1.0 / self.J[own]
        table["fixed"] = fixed = self.fixed[own]
        for k in range(3):
            table["v"][fixed >> k & 1 == 1, k] = 0.0
            table["w"][fixed >> (3 + k) & 1 == 1, k] = 0.0

    def sections(self) -> list[tuple[slice, int]]:
        """Elements of a kind, and the points in the plane of each, as blocks hold them."""
        n, m = self.quad_count, len(self.area)
        both = [(slice(0, n), self.points), (slice(n, m), 1)]
        return [(own, points) for own, points in both if own.stop > own.start]

    def write_blocks(self, numbers: np.ndarray, scene: Scene) -> None:
        """Values of the elements, block by block; the last block is filled up. Writes: numbers."""
        start = 0
        values = [np.full(len(self.area), self.card.thickness), *self._shape().T]
        for own, points in self.sections():
            size = blocks_of(own) * self.stride_of(points)
            table = numbers[start : start + size].reshape(blocks_of(own), -1, LANES)
            for row, column in (
                (BLOCK.thickness, values[0]),
                (BLOCK.gyration, self.radius_2),
                (BLOCK.mass, self.weight),
                *((BLOCK.inverse + k, column) for k, column in enumerate(values[1:])),
            ):
                table[:, row] = in_lanes(column[own])
            end = BLOCK.SIZE + points * self.card.layers * self.layer_rows
            for row, value in enumerate(self.law.initial_layer(self.material, scene)):
                if value != 0.0:
                    table[:, BLOCK.SIZE + row : end : self.layer_rows] = value
            if self.is_damped:
                row = table.shape[1] - EROSION.SIZE * self.can_fail - VISCOUS.SIZE
                table[:, row + VISCOUS.mass_factor] = in_lanes(self.mass_factors[own])
            start += size

    def corners(self) -> np.ndarray:
        """Points of the corners, (blocks, 4, lanes)."""
        quads = [self.mesh.quads[own] for own, _ in self.sections()]
        return np.concatenate([np.stack([in_lanes(c) for c in q.T], axis=1) for q in quads])

    def address(self, element: int) -> tuple[int, int, int, int]:
        """Kind of an element in KINDS, where the numbers and corners of its block begin, lane."""
        numbers = corners = 0
        for own, points in self.sections():
            if element < own.stop:
                break
            numbers += blocks_of(own) * self.stride_of(points)
            corners += blocks_of(own) * 4 * LANES
        block, lane = divmod(element - own.start, LANES)
        kind = 2 if own.start >= self.quad_count else list(POINTS.values()).index(points)
        return kind, numbers + block * self.stride_of(points), corners + block * 4 * LANES, lane

    def stride_of(self, points: int) -> int:
        """Numbers of a block of elements with so many points in their plane."""
        rows = BLOCK.SIZE + points * self.layer_rows * self.card.layers
        return LANES * (rows + VISCOUS.SIZE * self.is_damped + EROSION.SIZE * self.can_fail)

    @property
    def stride(self) -> int:
        """Numbers of a block of quadrilaterals."""
        return self.stride_of(self.points)

    @property
    def size(self) -> int:
        """Numbers of all blocks."""
        return sum(blocks_of(own) * self.stride_of(points) for own, points in self.sections())

    def gauge_values(self, blocks: np.ndarray, row: np.void) -> np.ndarray:
        """Values of FIELDS of the gauged elements, side by side (gauges, columns)."""
        values = outputs.values_of(self, blocks, row, np.array(self.gauged))
        return np.column_stack([values[name] for name in outputs.FIELDS])

    def all_fields(self, blocks: np.ndarray, row: np.void) -> dict[str, np.ndarray]:
        """Values of FIELDS of all elements, in single precision."""
        return outputs.values_of(self, blocks, row, np.arange(len(self.area)), np.float32)

    def _shape(self) -> np.ndarray:
        """Inverse of the diagonals in axes between them, by rows (m, 4)."""
        shape = np.empty((len(self.area), 4))
        # blocks exist already: additional arrays determine the peak of memory
        for start in range(0, len(shape), PIECE):
            x = self.mesh.points[self.mesh.quads[start : start + PIECE]]
            shape[start : start + PIECE] = np.linalg.inv(diagonals(x)).reshape(-1, 4)
        return shape
