"""Models drawn at random, written down in any frame of the world, mirrored, or in another order.

    x' = M x + t,   R' = M R S,   b' = S b      M = Q S, S a reflection of the body's axes or none

x are points of the world, b points of a body, R its orientation and Q a rotation. Axial vectors
(angular velocities, axes of rotation) take det(M) M, or det(S) S in a body. The answer must be the
same motion, moved alike.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

Table = dict[str, Any]
MIRROR = np.diag([1.0, 1.0, -1.0])
# corners and faces of a double pyramid
GEM = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1.2], [0, 0, -0.9]])
GEM_FACES = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]


@dataclass(frozen=True)
class Frame:
    """A motion of the world, with a reflection or without, and the order of cards."""

    Q: np.ndarray = field(default_factory=lambda: np.eye(3))
    t: np.ndarray = field(default_factory=lambda: np.zeros(3))
    S: np.ndarray = field(default_factory=lambda: np.eye(3))
    order: int | None = None  # seed of a permutation of all cards
    swaps: bool = False  # sides of contacts

    @property
    def M(self) -> np.ndarray:
        return self.Q @ self.S

    @property
    def sign(self) -> float:
        """-1 of a reflection."""
        return float(np.linalg.det(self.S))

    def point(self, x: np.ndarray) -> list[float]:
        return _plain(self.M @ x + self.t)

    def polar(self, x: np.ndarray) -> list[float]:
        return _plain(self.M @ x)

    def axial(self, x: np.ndarray) -> list[float]:
        return _plain(self.sign * self.M @ x)

    def own(self, b: Any) -> list[float]:
        """A point of a body, in its axes."""
        return _plain(self.S @ np.asarray(b, float))

    def own_axial(self, b: Any) -> list[float]:
        return _plain(self.sign * self.S @ np.asarray(b, float))

    def rotation(self, R: np.ndarray) -> Table:
        return {"quaternion": _plain(quaternion(self.M @ R @ self.S))}


def _plain(x: np.ndarray) -> list[float]:
    return [float(v) for v in x]


def quaternion(R: np.ndarray) -> np.ndarray:
    """Unit quaternion, scalar first, of a rotation."""
    K = np.array(
        [
            [R[0, 0] + R[1, 1] + R[2, 2], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]],
            [0, R[0, 0] - R[1, 1] - R[2, 2], R[0, 1] + R[1, 0], R[0, 2] + R[2, 0]],
            [0, 0, R[1, 1] - R[0, 0] - R[2, 2], R[1, 2] + R[2, 1]],
            [0, 0, 0, R[2, 2] - R[0, 0] - R[1, 1]],
        ]
    )
    K = K + np.triu(K, 1).T
    return np.linalg.eigh(K)[1][:, -1]


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Q * np.linalg.det(Q)


def written(model: "Drawn", frame: Frame) -> Table:
    """The deck of a model in a frame."""
    deck = model.deck(frame)
    if frame.swaps:
        for card in deck.get("contacts", {}).values():
            card["a"], card["b"] = card["b"], card["a"]
    if frame.order is not None:
        rng = np.random.default_rng(frame.order)
        for section in ("bodies", "surfaces", "contacts", "joints", "springs", "loads", "curves"):
            names = list(deck.get(section, {}))
            rng.shuffle(names)
            if names:
                deck[section] = {name: deck[section][name] for name in names}
    return deck


class Drawn:
    """Numbers of a model; `deck` writes them down in a frame."""

    def __init__(self, seed: int, integrator: str, end: float) -> None:
        self.rng = np.random.default_rng(seed)
        self.integrator, self.end = integrator, end
        self.drawn: dict[str, Any] = {}

    def number(self, low: float, high: float) -> float:
        return float(np.exp(self.rng.uniform(np.log(low), np.log(high))))

    def vector(self, size: float) -> np.ndarray:
        return self.rng.uniform(-size, size, 3)

    def body(self, mass: float, size: float, r: np.ndarray, v: np.ndarray, w: np.ndarray) -> Table:
        """A body of a mass, in any orientation, with moments of inertia that differ."""
        moments = 0.4 * mass * size**2 * self.rng.uniform(0.8, 1.2, 3)
        products = 0.05 * mass * size**2 * self.rng.uniform(-1.0, 1.0, 3)
        return {
            "mass": mass,
            "moments": moments,
            "products": products,
            "centre": self.vector(0.1 * size),
            "r": r,
            "R": random_rotation(self.rng),
            "v": v,
            "w": w,
        }

    def control(self) -> Table:
        return {
            "control": {"end_time": self.end, "integrator": self.integrator, "estimate": "off"},
            "output": {"history": {"interval": self.end}, "states": {"interval": self.end}},
        }


def rigid(frame: Frame, b: Table) -> Table:
    """Card of a body. Products of inertia change their signs where one of two axes is reflected."""
    s = np.diag(frame.S)
    pairs = np.array([s[0] * s[1], s[0] * s[2], s[1] * s[2]])
    return {
        "mass": b["mass"],
        "inertia": _plain(b["moments"]),
        "products": _plain(b["products"] * pairs),
        "mass_centre": frame.own(b["centre"]),
        "position": frame.point(b["r"]),
        "rotation": frame.rotation(b["R"]),
        "velocity": frame.polar(b["v"]),
        "angular_velocity": frame.axial(b["w"]),
    }


class Thrown(Drawn):
    """Solids of five shapes thrown on a plane, a box and a ball of the ground, with five laws."""

    def __init__(self, seed: int, integrator: str = "rattle") -> None:
        super().__init__(seed, integrator, 0.12)
        self.size = {name: float(self.rng.uniform(0.06, 0.12)) for name in self.names}
        self.bodies = {
            name: self.body(
                self.number(0.3, 3.0),
                self.size[name],
                np.array([0.6 * i, float(self.rng.uniform(-0.2, 0.2)), 0.25]),
                np.array([*self.rng.uniform(-1.5, 1.5, 2), -self.number(1.0, 4.0)]),
                self.vector(8.0),
            )
            for i, name in enumerate(self.names)
        }
        self.stiffness = {name: self.number(3e5, 3e6) for name in self.names}
        self.rotation = random_rotation(self.rng)

    names = ("ball", "brick", "can", "egg", "gem")

    def deck(self, frame: Frame) -> Table:
        size, k = self.size, self.stiffness
        skins: Table = {
            "ball": {"type": "sphere", "radius": size["ball"]},
            "brick": {"type": "box", "size": [2 * size["brick"] * x for x in (1.0, 0.8, 0.6)]},
            "can": {"type": "cylinder", "radius": size["can"], "length": 1.5 * size["can"]},
            "egg": {"type": "ellipsoid", "semi_axes": [size["egg"] * x for x in (1.0, 0.8, 0.6)]},
            "gem": {
                "type": "mesh",
                "vertices": [frame.own(size["gem"] * x) for x in GEM],
                "faces": [f if frame.sign > 0 else f[::-1] for f in GEM_FACES],
            },
        }
        skins = {name: skin | {"body": name} for name, skin in skins.items()}
        up = np.array([0.0, 0.0, 1.0])
        floors: Table = {
            "plane": {"type": "plane", "at": frame.point(0 * up), "normal": frame.polar(up)},
            "slab": {
                "type": "box",
                "at": frame.point(np.array([1.0, 0.0, -0.1])),
                "rotation": frame.rotation(np.eye(3)),
                "size": [9.0, 9.0, 0.2],
            },
            "hill": {"type": "sphere", "at": frame.point(np.array([0, 0, -2.0])), "radius": 2.0},
        }
        laws: Table = {
            "ball": {"type": "hertz", "stiffness": 30 * k["ball"]},
            "brick": {"type": "kelvin_voigt", "stiffness": k["brick"], "restitution": 0.6},
            "can": {"type": "lankarani_nikravesh", "stiffness": 30 * k["can"], "restitution": 0.8},
            "egg": {"type": "exact_restitution", "stiffness": 30 * k["egg"], "restitution": 0.5},
            "gem": {"type": "hunt_crossley", "stiffness": 30 * k["gem"], "restitution": 0.9},
        }
        regularised = {"type": "coulomb", "friction_coefficient": 0.3}
        regularised |= {"none_below": 0.0, "full_above": 0.2}
        peaked = {"type": "stribeck", "static": 0.5, "dynamic": 0.3}
        peaked |= {"stribeck_speed": 0.3, "smoothing_speed": 0.05}
        frictions: Table = {"ball": regularised, "brick": peaked, "egg": peaked}
        on = {"ball": "hill", "brick": "slab", "can": "plane", "egg": "slab", "gem": "plane"}
        contacts = {
            f"{name}_{on[name]}": {"a": [name], "b": [on[name]], "normal": laws[name]}
            | ({"friction": frictions[name]} if name in frictions else {})
            for name in self.names
        }
        return self.control() | {
            "bodies": {name: rigid(frame, b) for name, b in self.bodies.items()},
            "surfaces": skins | floors,
            "contacts": contacts,
            "loads": {"weight": {"type": "gravity", "acceleration": frame.polar(-9.81 * up)}},
        }


class Linked(Drawn):
    """A chain of five joints on the ground with springs, a driver, a hinge that yields, and a load.

    It begins at rest, as far as joints bind it.
    """

    def __init__(self, seed: int, integrator: str = "rattle") -> None:
        super().__init__(seed, integrator, 0.4)
        self.at = [np.array([0.5 * i, 0.0, 0.0]) + self.vector(0.1) for i in range(6)]
        self.axis = [self.vector(1.0) for _ in range(6)]
        self.second = [np.cross(a, self.vector(1.0)) for a in self.axis]
        zero = np.zeros(3)
        self.bodies = {
            f"b{i}": self.body(
                self.number(0.5, 2.0), 0.2, 0.5 * (self.at[i] + self.at[i - 1]), zero, zero
            )
            for i in range(1, 6)
        }
        self.bodies["free"] = self.body(1.0, 0.2, np.array([2.5, 1.0, 0.0]), zero, self.vector(3.0))
        self.arm = [self.vector(0.1) for _ in range(6)]
        self.k = [self.number(100.0, 1000.0) for _ in range(6)]
        self.force, self.largest_angle = self.vector(20.0), float(self.rng.uniform(-2.0, 2.0))

    def deck(self, frame: Frame) -> Table:
        at, axis, k, arm = self.at, self.axis, self.k, self.arm
        down = frame.polar(np.array([0.0, 0.0, -9.81]))
        joints: Table = {
            "driven": {"type": "revolute", "b": "b1", "axis": frame.axial(axis[0])},
            "hook": {"type": "universal", "a": "b1", "b": "b2", "axis": frame.axial(axis[1])},
            "ball": {"type": "spherical", "a": "b2", "b": "b3"},
            "slider": {"type": "prismatic", "a": "b3", "b": "b4", "axis": frame.polar(axis[3])},
        }
        joints["hook"]["second_axis"] = frame.axial(self.second[1])
        for i, name in enumerate(list(joints)):
            joints[name]["at"] = frame.point(at[i])
        joints["motor"] = {"type": "rotation_driver", "joint": "driven", "curve": "angle"}
        springs: Table = {
            "coil": {"type": "linear", "a": "b3", "b": "b4", "stiffness": k[0], "damping": 5.0},
            "rod": {"type": "linear", "b": "free", "at_a": frame.point(at[5]), "stiffness": k[1]},
            "mount": {"type": "bushing", "a": "b5", "b": "free", "stiffness": [k[2]] * 3},
            "twist": {"type": "torsional", "a": "b2", "b": "b3", "stiffness": 0.1 * k[3]},
        }
        springs["coil"] |= {"at_a": frame.own(arm[0]), "at_b": frame.own(arm[1]), "length": 0.3}
        springs["mount"] |= {"at_a": frame.own(arm[2]), "at_b": frame.own(arm[3])}
        springs["mount"] |= {"damping": [2.0] * 3, "rotational_stiffness": [0.1 * k[4]] * 3}
        springs["twist"] |= {"axis": frame.own_axial(axis[4])}
        bend = {"type": "bending", "a": "b4", "b": "b5", "at": frame.point(at[4])}
        bend |= {"axis": frame.axial(axis[4]), "curve": {"name": "yielding"}}
        loads: Table = {
            "weight": {"type": "gravity", "acceleration": down},
            "push": {"type": "force", "body": "b5", "at": frame.own(arm[4])},
        }
        loads["push"]["force"] = frame.polar(self.force)
        # as the bodies, it begins at rest
        points = [[0, 0], [0.1 * self.end, 0], [0.5 * self.end, self.largest_angle], [self.end, 0]]
        return self.control() | {
            "bodies": {name: rigid(frame, b) for name, b in self.bodies.items()},
            "joints": joints,
            "springs": springs,
            "hinges": {"bend": bend},
            "loads": loads,
            "curves": {
                "angle": {"points": points, "interpolation": "smooth"},
                "yielding": {"points": [[0, 0], [0.02, 2], [3, 5]]},
            },
        }


class Struck(Drawn):
    """A cantilever of beam elements, one of fibres and a plate of shells, each struck by a ball."""

    def __init__(self, seed: int, integrator: str = "rattle") -> None:
        super().__init__(seed, integrator, 0.01)
        self.speed = [self.number(1.0, 5.0) for _ in range(3)]
        self.mass = [self.number(0.05, 0.5) for _ in range(3)]
        self.side = self.rng.uniform(-0.5, 0.5, 3)

    def deck(self, frame: Frame) -> Table:
        x, y, z = np.eye(3)
        parts: Table = {}
        for i, kind in enumerate(("beam", "fibre_beam")):
            at = 0.5 * i * y
            mesh = {"shape": "line", "from": frame.point(at), "to": frame.point(at + 0.4 * x)}
            parts[kind] = {
                "type": kind,
                "mesh": mesh | {"elements": 4},
                "section": "flat",
                "material": "nylon" if kind == "beam" else "lead",
                "side": frame.polar(y),
            }
        plate = {"type": "grid", "at": frame.point(np.array([0.0, 1.0, 0.0]))}
        plate |= {"along": frame.polar(0.4 * x), "across": frame.polar(0.2 * y)}
        parts["plate"] = {
            "type": "shell",
            "mesh": plate | {"elements": [8, 4]},
            "thickness": 3e-3,
            "material": "lead",
            "supports": [{"nodes": "u0"}],
        }
        spots = [np.array([0.4, 0.0, 0.026]), np.array([0.4, 0.5, 0.026])]
        spots.append(np.array([0.35, 1.1 + 0.05 * self.side[2], 0.022]))
        bodies, surfaces, contacts = {}, {}, {}
        for i, part in enumerate(parts):
            name = f"ball_{i}"
            bodies[name] = {
                "mass": self.mass[i],
                "inertia": [1e-4] * 3,
                "position": frame.point(spots[i]),
                "velocity": frame.polar(-self.speed[i] * z + [0.0, self.side[i], 0.0]),
            }
            surfaces[name] = {"type": "sphere", "body": name, "radius": 0.02}
            kind = "faces" if part == "plate" else "nodes"
            surfaces[f"of_{part}"] = {"type": kind, "part": part}
            if kind == "nodes":
                surfaces[f"of_{part}"]["radius"] = 5e-3
            law = {"type": "kelvin_voigt", "stiffness": 1e5, "damping": 5.0}
            contacts[name] = {"a": [name], "b": [f"of_{part}"], "normal": law}
        nylon = {"type": "elastic", "young": 2e9, "poisson": 0.3, "density": 1150}
        lead = {"type": "elastoplastic", "young": 16e9, "poisson": 0.4, "density": 11300}
        foot = {"type": "weld", "at": frame.point(np.zeros(3))}
        return self.control() | {
            "materials": {"nylon": nylon, "lead": lead | {"yield_stress": 1e7, "hardening": 1e8}},
            "sections": {"flat": {"type": "rectangle", "width": 0.02, "height": 0.01}},
            "parts": parts,
            "bodies": bodies,
            "joints": {
                "foot": foot | {"b": "beam_start"},
                "root": foot | {"b": "fibre_beam_start", "at": frame.point(0.5 * y)},
            },
            "surfaces": surfaces,
            "contacts": contacts,
        }


FAMILIES = {"thrown": Thrown, "linked": Linked, "struck": Struck}
