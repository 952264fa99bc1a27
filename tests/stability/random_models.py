"""Whole models drawn at random: masses over eight decades, stiffness over 12, speeds over nine.

All hold the same kinds of joints, springs, beams, contacts and loads, in any number, so that one
compiled step serves them all.
"""

from typing import Any

import numpy as np

Vector = list[float]
Table = dict[str, Any]
# steps of the stiffest spring that a run may take
STEPS = 4000


def model(seed: int, integrator: str = "rattle") -> Table:
    """A deck of one to six bodies and one or two beams."""
    return _Draw(seed).deck(integrator)


def masses_of(drawn: Table) -> dict[str, float]:
    """Masses of all bodies of a deck, the nodes of beams among them [kg]."""
    masses = {name: card["mass"] for name, card in drawn["bodies"].items()}
    for name, part in drawn["parts"].items():
        mesh, section = part["mesh"], drawn["sections"][part["section"]]
        count = mesh["elements"]
        area = section["width"] * section["height"]
        share = drawn["materials"][part["material"]]["density"] * area
        share *= float(np.linalg.norm(np.subtract(mesh["to"], mesh["from"]))) / count
        masses |= {f"{name}_{k}": share for k in range(1, count)}
        masses |= {f"{name}_{k}": 0.5 * share for k in ("start", "end")}
    return masses


class _Draw:
    """Draws one deck; the stiffest part bounds the duration."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.fastest = 1.0
        self.count = int(self.rng.integers(1, 7))
        self.names = [f"b{i}" for i in range(self.count)]
        self.mass = dict(zip(self.names, self.decades(-4, 4, self.count), strict=True))
        self.radius = {name: float(self.rng.uniform(0.05, 0.3)) for name in self.names}
        # two rows, mostly clear of each other; now and then anywhere
        self.position = {
            name: self.vector(1.0) if self.rarely() else self.row(i)
            for i, name in enumerate(self.names)
        }
        self.jointed: set[str] = set()
        self.beams = [self.beam(i) for i in range(int(self.rng.integers(1, 3)))]

    def rarely(self) -> bool:
        return bool(self.rng.random() < 0.05)

    def row(self, i: int) -> Vector:
        return [0.8 * (i % 3) - 0.8, 0.8 * (i // 3), float(self.rng.uniform(-1.0, 0.0))]

    def decades(self, low: float, high: float, count: int = 1) -> list[float]:
        """Numbers spread evenly over powers of ten."""
        return [float(x) for x in 10.0 ** self.rng.uniform(low, high, count)]

    def vector(self, size: float) -> Vector:
        return [float(x) for x in self.rng.uniform(-size, size, 3)]

    def body(self) -> str:
        """A body, or a node of a beam: every name that has a mass."""
        return str(self.rng.choice(list(self.mass)))

    def other(self, body: str) -> str:
        """A second body, or the ground."""
        return str(self.rng.choice(["ground", *(n for n in self.mass if n != body)]))

    def some(self) -> range:
        return range(int(self.rng.integers(1, 4)))

    def stiffness(self, low: float, high: float, lightest: float) -> float:
        """A stiffness; notes the frequency of the lightest body on it."""
        (k,) = self.decades(low, high)
        self.fastest = max(self.fastest, (k / lightest) ** 0.5)
        return k

    def deck(self, integrator: str) -> Table:
        joints = self.joints()
        parts = {
            "bodies": {name: self.rigid(name) for name in self.names},
            "parts": {f"beam_{i}": self.part(i) for i in range(len(self.beams))},
            "materials": {f"stuff_{i}": beam["stuff"] for i, beam in enumerate(self.beams)},
            "sections": {f"section_{i}": beam["section"] for i, beam in enumerate(self.beams)},
            "joints": joints,
            "springs": self.springs(),
            "surfaces": self.surfaces(),
            "contacts": self.contacts(),
            "loads": {"weight": {"type": "gravity"}},
        }
        end = min(0.5, STEPS * 0.1 / self.fastest)
        direction = 0.1 * end * float(self.rng.integers(0, 2))
        points = [[0, 0], [0.1 * end, 0], [end, direction]]
        parts["curves"] = {"displacement": {"points": points, "interpolation": "smooth"}}
        # a run of more steps than this is stopped, and has to say so
        control = {"end_time": end, "integrator": integrator, "step_min": 1e-7 * end}
        output = {"history": {"interval": end / 20}, "states": {"interval": end}}
        return {"title": "drawn at random", "control": control, "output": output} | parts

    def beam(self, i: int) -> Table:
        """A straight beam above the bodies, from rubber to steel; notes its nodes' masses."""
        count = int(self.rng.integers(1, 5))
        (young,), (density,), (width,) = (self.decades(*x) for x in ((6, 12), (2.5, 4), (-2.5, -1)))
        direction = self.vector(0.5)
        direction[0] += 1.0
        length = float(np.linalg.norm(direction)) / count
        section = {"type": "rectangle", "width": width, "height": width * self.rng.uniform(0.5, 2)}
        section = {k: v if k == "type" else float(v) for k, v in section.items()}
        share = density * section["width"] * section["height"] * length
        for name in (f"beam_{i}_{k}" for k in ("start", *range(1, count), "end")):
            self.mass[name] = share * (0.5 if name.endswith(("start", "end")) else 1.0)
        # of an element without its neighbours, along it and in bending with rotary inertia
        thin = min(section["width"], section["height"])
        self.fastest = max(self.fastest, (young / density) ** 0.5 * 2.0 / min(length, thin))
        stuff = {"type": "elastic", "young": young, "poisson": 0.3, "density": density}
        begin = [-0.5, -0.8 * (i + 1), 1.0]
        mesh = {
            "shape": "line",
            "from": begin,
            "to": [a + b for a, b in zip(begin, direction, strict=True)],
            "elements": count,
        }
        return {"stuff": stuff, "section": section, "mesh": mesh}

    def part(self, i: int) -> Table:
        """What hangs on a joint begins at rest, as bodies do."""
        is_free = not any(name.startswith(f"beam_{i}_") for name in self.jointed)
        (speed,) = self.decades(-6, 2)
        return {
            "type": "beam",
            "mesh": self.beams[i]["mesh"],
            "section": f"section_{i}",
            "material": f"stuff_{i}",
            "side": [0, 0, 1],
            "damping": 0.1 / self.fastest if self.rng.random() < 0.5 else 0.0,
            "velocity": self.vector(speed) if is_free else [0.0, 0.0, 0.0],
        }

    def rigid(self, name: str) -> Table:
        """A ball, nearly uniform, or now and then an inertia that no solid has."""
        moment = 0.4 * self.mass[name] * self.radius[name] ** 2
        moments = [moment * float(x) for x in self.rng.uniform(0.7, 1.3, 3)]
        if self.rarely() and self.rarely():
            moments[0] *= -1.0
        (speed,) = self.decades(-6, 3)
        # what hangs on a joint must not break it at the start
        is_free = name not in self.jointed or self.rarely()
        return {
            "mass": self.mass[name],
            "inertia": moments,
            "position": self.position[name],
            "velocity": self.vector(speed) if is_free else [0.0, 0.0, 0.0],
        }

    def joints(self) -> Table:
        """Joints anywhere: loops, doubles and contradictions are wanted too."""
        cards: Table = {}
        for kind in ("spherical", "revolute"):
            for i in self.some():
                b = self.body()
                card = {"type": kind, "a": self.other(b), "b": b, "at": self.vector(1.0)}
                self.jointed |= {str(card["a"]), b}
                if kind == "revolute":
                    card["axis"] = self.vector(1.0)
                cards[f"{kind}_{i}"] = card
        driven = self.body()
        self.jointed.add(driven)
        cards["driver"] = {
            "type": "point_driver",
            "body": driven,
            "axis": self.vector(1.0),
            "curve": "displacement",
        }
        return cards

    def springs(self) -> Table:
        cards: Table = {}
        for kind in ("linear", "bushing"):
            for i in self.some():
                b = self.body()
                a = self.other(b)
                k = self.stiffness(0, 12, min(self.mass[n] for n in (a, b) if n != "ground"))
                # a thin beam has next to no inertia to hold an arm with
                at = self.vector(0.5 if a in self.names or a == "ground" else 0.0)
                card = {"type": kind, "a": a, "b": b, "at_a": at, "stiffness": k}
                cards[f"{kind}_{i}"] = card if kind == "linear" else card | {"stiffness": [k] * 3}
        return cards

    def surfaces(self) -> Table:
        skins = {
            name: {"type": "sphere", "body": name, "radius": self.radius[name]}
            for name in self.names
        }
        walls = {"wall": {"type": "sphere", "at": [0, 0, -2], "radius": 0.6}}
        return {"floor": {"type": "plane", "at": [0, 0, -1.4]}} | skins | walls

    def contacts(self) -> Table:
        lightest = min(self.mass.values())
        law = {
            "type": "exact_restitution",
            "stiffness": self.stiffness(3, 7, lightest),
            "restitution": float(self.rng.uniform(0.1, 1.0)),
        }
        friction = {
            "type": "coulomb",
            "friction_coefficient": float(self.rng.uniform(0, 1)),
            "none_below": 0,
            "full_above": 0.1,
        }
        card = {"a": self.names, "normal": law, "friction": friction}
        return {
            "floor": card | {"b": ["floor"]},
            "balls": card | {"b": ["wall", *self.names]},
        }
