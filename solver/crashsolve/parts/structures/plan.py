"""Plan of a structure: its members in place, with their numbers, and the mass of their lengths."""

from dataclasses import dataclass
from math import tan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crashsolve.deck.building import Columns
from crashsolve.deck.expansion import Law, Problem, Steps
from crashsolve.foundation.orientation import perpendicular, quaternion_of

# directions closer than this are the same, in radians; so are positions, over a member's length
SAME = 1e-6
# joint [m]: as for sides of sections, squares of shorter ones vanish
SHORTEST = 1e-12


@dataclass
class Member:
    """A member in place: its number from 0, its name, and the ends of its deformable part.

    `T` has its axes as columns: along it, y and z of the section. `joints` are the lengths at its
    ends that belong to rigid joints.
    """

    number: int
    name: str
    ends: tuple[str, str]
    positions: tuple[np.ndarray, np.ndarray]
    T: np.ndarray
    section: Law
    material: Law
    constants: Columns
    divisions: int
    deformation: str
    joints: tuple[float, float] = (0.0, 0.0)

    @property
    def path(self) -> Steps:
        """Path of the member's entry in the structure's card."""
        return ("members", self.number)

    @property
    def along(self) -> np.ndarray:
        """Unit vector (3,) from its first to its second point."""
        return np.asarray(self.T[:, 0])

    @property
    def length(self) -> float:
        """Length of the deformable part [m]."""
        whole = float(np.linalg.norm(self.positions[1] - self.positions[0]))
        return whole - self.joints[0] - self.joints[1]

    @property
    def quaternion(self) -> list[float]:
        """Quaternion of the member's axes."""
        return [float(x) for x in quaternion_of(self.T)]

    def at(self, x: float) -> np.ndarray:
        """Position at a length from where it begins to deform [m]."""
        return self.positions[0] + (self.joints[0] + x) * self.along

    def rod(self, start: float, end: float) -> tuple[float, np.ndarray, np.ndarray]:
        """Mass, mass centre and inertia (3, 3) about it of a length of it, world axes."""
        s, rho = end - start, self.material.card.density
        mass = rho * self.constants["area"] * s
        I_y, I_z = self.constants["rotary" if "rotary" in self.constants else "second"]
        across = mass * s * s / 12.0
        J = np.diag([rho * s * (I_y + I_z), rho * s * I_y + across, rho * s * I_z + across])
        return mass, self.at(0.5 * (start + end)), self.T @ J @ self.T.T


@dataclass
class Plan:
    """A structure in place: its card, its name, its points by name, its members."""

    name: str
    card: Any
    points: dict[str, np.ndarray]
    members: list[Member]

    def body(self, point: str) -> str:
        """Name of the body at a point."""
        return f"{self.name}_{point}"

    def velocity(self, position: np.ndarray) -> list[float]:
        """Velocity (3,) of a position at the start [m/s]."""
        first = next(iter(self.points.values()))
        rotation = np.cross(self.card.angular_velocity, position - first)
        return [float(x) for x in np.asarray(self.card.velocity) + rotation]


def euler_load(member: Member) -> float:
    """pi^2 E I / L^2 between hinged ends, of the length that deforms [N]."""
    second = float(min(member.constants["second"]))
    return float(np.pi**2 * member.material.card.young * second / member.length**2)


def plan(name: str, card: Any, laws: dict[str, dict[str, Law]]) -> Plan:
    """The members in place; `laws` are sections and materials by keyword and name.

    Raises: Problem.
    """
    points: dict[str, np.ndarray] = {}
    for k, point in enumerate(card.points):
        if point.name in points:
            raise Problem(("points", k, "name"), f"point '{point.name}' is given twice")
        if point.joint is not None and not point.joint > SHORTEST:
            message = f"must be greater than {SHORTEST:g} m: the body at the point has its mass"
            raise Problem(("points", k, "joint"), message)
        points[point.name] = np.asarray(point.at)
    members = [_member(name, card, k, points, laws) for k in range(len(card.members))]
    _refuse_twice(members)
    _refuse_touching(points, members)
    _refuse_crossing(members)
    given = {point.name: point.joint for point in card.points}
    for k, point in enumerate(card.points):
        own = [m for m in members if point.name in m.ends]
        if not own:
            message = f"no member begins or ends at point '{point.name}'"
            raise Problem(("points", k), message, "take it out or join it")
        if given[point.name] is None:
            given[point.name] = joint_length(point.name, own)
    for member in members:
        start, end = (given[point] for point in member.ends)
        assert start is not None and end is not None
        member.joints = (start, end)
        if not member.length > 0.0:
            raise Problem(
                member.path,
                f"its rigid joints, {start:.4g} and {end:.4g} m, leave no length of it between "
                "them",
                "move the points apart, or give them a smaller joint",
            )
    return Plan(name, card, points, members)


def _member(
    name: str, card: Any, k: int, points: dict[str, np.ndarray], laws: dict[str, dict[str, Law]]
) -> Member:
    """A member in place, but for its joints. Raises Problem."""
    own, path = card.members[k], ("members", k)
    for word, point in (("from", own.from_), ("to", own.to)):
        if point not in points:
            known = f"(points: {', '.join(points)})"
            raise Problem((*path, word), f"unknown point '{point}'", known)
    positions = points[own.from_], points[own.to]
    along = positions[1] - positions[0]
    if not np.linalg.norm(along) > 0.0:
        raise Problem(path, "begins and ends in one position", "a member needs a length")
    laws_of = {}
    for keyword, word in (("sections", "section"), ("materials", "material")):
        given = getattr(own, word) or getattr(card, word)
        if given is None:
            raise Problem(path, f"has no {word}", f"give it one, or the structure a {word}")
        laws_of[word] = laws[keyword][given]
    constants = laws_of["section"].module.build(
        laws_of["section"].card, laws_of["material"].card.poisson
    )
    side = own.side if own.side is not None else card.side
    T = _axes(along / np.linalg.norm(along), side, constants, path)
    title = f"{name}_{own.name or f'member_{k + 1}'}"
    divisions = own.divisions or card.divisions
    deformation = own.deformation or card.deformation
    ends = (own.from_, own.to)
    return Member(
        k, title, ends, positions, T, laws_of["section"], laws_of["material"], constants, divisions,
        deformation,
    )  # fmt: skip


def _axes(along: np.ndarray, side: ArrayLike, constants: Columns, path: Steps) -> np.ndarray:
    """Axes of a member as columns. Raises Problem."""
    if side is None:
        I_y, I_z = constants["second"]
        if abs(I_y - I_z) > 1e-9 * I_z:
            message = (
                "its section has I_y and I_z that differ: give side, the direction of its y axis"
            )
            raise Problem(path, message)
        y = perpendicular(along)
    else:
        y = np.asarray(side, float) - along * float(along @ np.asarray(side, float))
        if not np.linalg.norm(y) > SAME * np.linalg.norm(side):
            raise Problem(path, "its side points along it; give a direction across it")
    y = y / np.linalg.norm(y)
    return np.column_stack([along, y, np.cross(along, y)])


def _refuse_twice(members: list[Member]) -> None:
    """Raises Problem for a member or a name given twice."""
    number_of: dict[str | frozenset[str], int] = {}
    for member in members:
        for key in (member.name, frozenset(member.ends)):
            if key in number_of:
                raise Problem(member.path, f"repeats member {number_of[key] + 1}")
            number_of[key] = member.number


def _refuse_touching(points: dict[str, np.ndarray], members: list[Member]) -> None:
    """Raises Problem for a member through a point where it does not end.

    It would look joined there and pass by; of two members in one line, or of two points at one
    position, one has such a point.
    """
    for member in members:
        start, end = member.positions
        reach = float(np.linalg.norm(end - start))
        for k, (point, position) in enumerate(points.items()):
            x = min(max(float((position - start) @ member.along), 0.0), reach)
            apart = float(np.linalg.norm(position - start - x * member.along))
            if point not in member.ends and apart <= SAME * reach:
                first, last = member.ends
                raise Problem(
                    ("points", k),
                    f"point '{point}' lies on the member from '{first}' to '{last}', which is not "
                    "joined to it",
                    "let that member end there and another continue, or move the point",
                )


def _refuse_crossing(members: list[Member]) -> None:
    """Raises Problem for two members whose axes meet between their points: they are not joined.

    Their axes are at e = a + s u and f = b + t v; n = u x v is common to all that lies across both.
    """
    for k, other in enumerate(members):
        for member in members[:k]:
            if set(member.ends) & set(other.ends):
                continue
            a, b, u, v = member.positions[0], other.positions[0], member.along, other.along
            n = np.cross(u, v)
            length = float(np.linalg.norm(n))
            # those in one line meet in a point, if they do
            if length <= SAME:
                continue
            s = float(np.cross(b - a, v) @ n) / length**2
            t = float(np.cross(b - a, u) @ n) / length**2
            reach, far = (float(np.linalg.norm(np.subtract(*m.positions))) for m in (member, other))
            apart = abs(float((b - a) @ n)) / length
            if 0.0 < s < reach and 0.0 < t < far and apart <= SAME * max(reach, far):
                first, last = member.ends
                raise Problem(
                    other.path,
                    f"crosses the member from '{first}' to '{last}' between their points, and is "
                    "not joined to it",
                    "let both end at a point there, or let one pass beside the other",
                )


def joint_length(point: str, members: list[Member]) -> float:
    """r [m] of the rigid joint at a point, by depths and angles of its members. Raises Problem."""
    depth = max(depth_of(member) for member in members)
    displacements = [m.along if m.ends[0] == point else -m.along for m in members]
    factor = 1.0
    for k, one in enumerate(displacements):
        for other in displacements[k + 1 :]:
            angle = float(np.arccos(np.clip(one @ other, -1.0, 1.0)))
            factor = max(factor, 1.0 / tan(0.5 * angle))
    return 0.5 * depth * factor


def depth_of(member: Member) -> float:
    """Greatest width of a section [m]. Raises Problem."""
    lacks = "has no shape, from which the rigid joints at its ends could take a length"
    return float(np.ptp(outline_of(member, lacks, "give both points a joint"), axis=0).max())


def outline_of(member: Member, lacks: str, advice: str) -> np.ndarray:
    """Points (n, 2) of the outer edge of its section, y and z [m].

    Raises Problem with the text `lacks` for a section without one.
    """
    law = member.section
    if not hasattr(law.module, "outline"):
        raise Problem(member.path, f"section '{law.name}' {lacks}", advice)
    points: np.ndarray = law.module.outline(law.card)
    return points
