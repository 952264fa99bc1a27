"""Points of a material by themselves: sixteen layers of a shell, and fibres of a beam.

Also by hand, for a new material:

    python tests/materials/one_layer.py '{type: elastic, young: 2e5, poisson: 0.3, density: 8}'
"""

import sys
import tempfile
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.elements.beams import fibres
from crashsolve.elements.shells.layers import reset_growth, through_thickness
from crashsolve.elements.shells.records import BLOCK, WORK
from crashsolve.elements.shells.resultants import clear_resultants
from crashsolve.elements.shells.tangents.layers import layers_and_tangent
from crashsolve.elements.shells.tangents.records import ACROSS_OUT, POINT_ROWS, SIDE
from crashsolve.foundation.point import LANES
from crashsolve.foundation.rows import Rows, as_rows
from crashsolve.materials._von_mises import LAYER
from crashsolve.model.build import build

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable

Example = dict[str, Any]
DECK: dict[str, Any] = {
    "control": {"end_time": 1},
    "parts": {
        "s": {
            "type": "shell",
            "mesh": {"type": "grid", "along": [1, 0, 0], "across": [0, 1, 0], "elements": [4, 4]},
            "thickness": 1.0,
            "layers": 1,
            "thinning": True,
            "material": "m",
        }
    },
}
BEAM: dict[str, Any] = {
    "type": "fibre_beam",
    "mesh": {"shape": "line", "from": [0, 5, 0], "to": [1, 5, 0], "elements": 1},
    "section": "square",
    "fibres": [2, 2],
    "material": "m",
}
SQUARE = {"type": "rectangle", "width": 1.0, "height": 1.0}


def model_of(folder: Path, example: Example, has_beam: bool) -> Any:
    """A shell of the material, and a fibre beam; `curve` in the example is a table of points."""
    material, deck = dict(example), dict(DECK)
    if "curve" in material:
        deck["curves"] = {"flow": {"type": "table", "points": material["curve"]}}
        material["curve"] = "flow"
    deck["materials"] = {"m": material}
    if has_beam:
        deck["parts"] = deck["parts"] | {"b": BEAM}
        deck["sections"] = {"square": SQUARE}
    path = folder / "material.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    return build(read_deck(path))


class Layers:
    """Sixteen layers of one material, each strained for itself."""

    def __init__(self, folder: Path, example: Example) -> None:
        self.model, state = model_of(folder, example, False)
        group = self.model.element_groups()[0]
        self.p: RowOfTable = as_rows(group.parameters)[0]
        self.m, self.law = self.p.material, group.materials[0][1]
        self.curves: Rows = as_rows(self.model.curves)
        self.blocks, self.work = state.blocks, np.zeros(WORK.SIZE * LANES)
        self.first = int(self.p.first) + LANES * BLOCK.SIZE
        self.put(WORK.depth, np.ones(LANES))
        self.put(WORK.area, np.ones(LANES))
        self.put(WORK.shear_factor, np.ones(LANES))

    def put(self, row: int, values: np.ndarray) -> None:
        self.work[LANES * row : LANES * (row + 1)] = values

    def get(self, row: int, count: int = 1) -> np.ndarray:
        """(lanes, count), or (lanes,)."""
        lanes = self.work[LANES * row : LANES * (row + count)].reshape(count, LANES).T
        return lanes[:, 0].copy() if count == 1 else lanes.copy()

    def strained(self, d: np.ndarray) -> None:
        for k in range(3):
            self.put(WORK.membrane + k, d[:, k])
        reset_growth(self.work)
        clear_resultants(self.work)

    def step(self, d: np.ndarray, h: float = 1.0) -> np.ndarray:
        """Stresses (lanes, 3) after strains d (lanes, 3) of a step of h."""
        self.strained(d)
        through_thickness(self.blocks, self.first, self.work, h, self.p, self.curves, self.law)
        return self.get(WORK.resultant, 3)

    def tangent(self, d: np.ndarray, h: float = 1.0) -> np.ndarray:
        """Derivatives (lanes, 4, 3) of the stress and of the strain across, by d; not a step."""
        blocks_before, base = self.blocks.copy(), np.zeros(POINT_ROWS * LANES)
        self.strained(d)
        scene = SimpleNamespace(
            lanes=self.blocks,
            lanes_before=blocks_before,
            work=self.work,
            base=base,
            curves=self.curves,
        )
        layers_and_tangent(self.first, 0, h, self.p, scene, self.law)
        self.blocks[:] = blocks_before
        table = base.reshape(SIDE, SIDE, LANES).transpose(2, 0, 1)
        return table[:, [0, 1, 2, ACROSS_OUT], :3]

    def differences(self, d: np.ndarray, h: float, size: float) -> np.ndarray:
        """The same by central differences."""
        derivative, blocks_before = np.zeros((LANES, 4, 3)), self.blocks.copy()
        for k in range(3):
            ends = []
            for direction in (size, -size):
                stress = self.step(d + direction * np.eye(3)[k], h)
                ends.append(np.column_stack([stress, self.get(WORK.thinning)]))
                self.blocks[:] = blocks_before
            derivative[:, :, k] = (ends[0] - ends[1]) / (2.0 * size)
        return derivative

    def stored(self) -> np.ndarray:
        """Elastic energy per volume (lanes,)."""
        energies = (self.law.energy(self.m, self.blocks, self.first + e) for e in range(LANES))
        return np.array(list(energies))

    def lost(self) -> np.ndarray:
        """Energy lost in the step per volume (lanes,)."""
        return self.get(WORK.lost)

    def plastic_strain(self) -> float:
        """Of the first lane."""
        return float(self.blocks[self.first + LANES * LAYER.plastic_strain])

    def pull(self, strain: float, h: float = 1.0) -> float:
        """Stress after a step of strain along x with none across it, in all lanes alike."""
        across, blocks_before = -self.m.poisson * strain, self.blocks.copy()
        for _ in range(50):
            d = np.tile([strain, across, 0.0], (LANES, 1))
            slope = self.tangent(d, h)[0, 1, 1]
            stress = self.step(d, h)[0]
            if abs(stress[1]) <= 1e-12 * self.m.young:
                break
            self.blocks[:] = blocks_before
            across -= stress[1] / slope
        return float(stress[0])


class Fibre:
    """A fibre of a beam."""

    def __init__(self, folder: Path, example: Example) -> None:
        model, _ = model_of(folder, example, True)
        group = next(g for g in model.groups if g.type == "fibre_beam")
        self.law, self.curves = group.materials[0][1], as_rows(model.curves)
        p = as_rows(group.parameters)[0]
        self.m = p.material
        # one alone, of unit area
        self.p = SimpleNamespace(
            count=1, y=np.zeros(1), z=np.zeros(1), area=np.ones(1), material=self.m
        )
        self.old, self.new = as_rows(group.history)[:, 0].copy()

    def step(self, strain: float, rate: float, h: float = 1.0) -> tuple[float, float, float]:
        """Stress, stored and lost energy at a strain; not accepted."""
        along = ((strain, 0.0, 0.0), (rate, 0.0, 0.0))
        result = fibres.resultants(self.p, self.old, self.new, h, self.curves, *along, self.law)
        return result[0], result[3], result[4]

    def accept(self) -> None:
        for name in self.new.dtype.names:
            self.old[name] = self.new[name]

    def tangent(self, strain: float, rate: float, h: float = 1.0) -> tuple[float, float, float]:
        """Stress after a step of h, and its slopes by strain and rate."""
        along = ((strain, 0.0, 0.0), (rate, 0.0, 0.0))
        lack, by_strain, by_rate = fibres.moduli(self.p, self.old, h, self.curves, *along, self.law)
        E = float(self.m.young)
        return E * strain + lack[0], E + by_strain[0], by_rate[0]


def walk(layers: Layers, size: float, steps: int, seed: int, h: float = 1.0) -> np.ndarray:
    """Strain layers at random, in steps of this size. Returns a further strain (lanes, 3)."""
    rng = np.random.default_rng(seed)
    for _ in range(steps):
        layers.step(size * rng.normal(size=(LANES, 3)), h)
    return size * rng.normal(size=(LANES, 3))


def tangent_error(layers: Layers, d: np.ndarray, h: float, size: float) -> float:
    """Largest difference between tangent and differences, over E (strain across: over 1)."""
    scale = np.array([layers.m.young] * 3 + [1.0])[None, :, None]
    error = (layers.tangent(d, h) - layers.differences(d, h, size)) / scale
    return float(np.abs(error).max())


def balance(layers: Layers, direction: np.ndarray, steps: int, h: float) -> tuple[float, float]:
    """Out along `direction` and half way back: worst of work less stored and lost, over the work
    done;

    smallest of what is lost in a step, over the same.
    """
    work, lost, least = np.zeros(LANES), np.zeros(LANES), 0.0
    volume, stress, large = np.ones(LANES), np.zeros((LANES, 3)), layers.law.LARGE_STRAIN
    begun, peak = layers.stored(), np.full(LANES, 1e-300)
    for k in range(steps + steps // 2):
        d = direction if k < steps else -direction
        new = layers.step(d, h)
        across = layers.get(WORK.thinning) if large else 0.0
        grown = volume * (np.exp(d[:, 0] + d[:, 1] + across) if large else 1.0)
        work += 0.5 * ((volume[:, None] * stress + grown[:, None] * new) * d).sum(axis=1)
        lost += layers.lost()
        least = min(least, float((layers.lost() / peak).min()) if k else 0.0)
        peak = np.maximum(peak, np.abs(work))
        stress, volume = new, grown
    error = np.abs(work - (volume * layers.stored() - begun) - lost) / peak
    return float(error.max()), least


def rotated(d: np.ndarray, angle: float, half: float) -> np.ndarray:
    """Strains (half 0.5) or stresses (half 1) in axes turned by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s], [s, c]])
    tensor = np.array([[d[:, 0], half * d[:, 2]], [half * d[:, 2], d[:, 1]]]).transpose(2, 0, 1)
    turned_tensor = R @ tensor @ R.T
    return np.column_stack(
        [turned_tensor[:, 0, 0], turned_tensor[:, 1, 1], turned_tensor[:, 0, 1] / half]
    )


def checks(example: Example, folder: Path) -> dict[str, float]:
    """What is found of a material; the limits stand in test_material_contract.py."""
    size = example_size(example)
    plain = {k: v for k, v in example.items() if k != "failure_strain"}
    h, errors_of = size, {}
    errors = []
    for seed in range(3):
        layers = Layers(folder, plain)
        d = walk(layers, size, 3 * seed, seed, h)
        errors.append(tangent_error(layers, d, h, 1e-6 * size))
    errors_of["tangent"] = max(errors)
    layers = Layers(folder, plain)
    direction = 0.02 * size * np.random.default_rng(4).normal(size=(LANES, 3))
    errors_of["balance"], errors_of["least lost"] = balance(layers, direction, 100, 0.02 * h)
    errors_of["rotated"] = turn_error(folder, plain, size, h)
    module = import_module(f"crashsolve.materials.{example['type']}")
    if module.FIBRE is not None:
        errors_of |= fibre_checks(folder, plain, size, h)
    return errors_of


def example_size(example: Example) -> float:
    """A strain about that at which it yields, or a twentieth."""
    limit = example.get("yield_stress") or (example.get("curve") or [[0, 0]])[0][1]
    return float(limit / example["young"]) if limit else 0.05


def turn_error(folder: Path, example: Example, size: float, h: float) -> float:
    """Stress under turned strains less the turned stress, over E times their size."""
    one, other, angle = Layers(folder, example), Layers(folder, example), 0.7
    rng, worst = np.random.default_rng(7), 0.0
    for _ in range(4):
        d = size * rng.normal(size=(LANES, 3))
        a, b = one.step(d, h), other.step(rotated(d, angle, 0.5), h)
        worst = max(worst, float(np.abs(rotated(a, angle, 1.0) - b).max()))
    return worst / (one.m.young * size)


def fibre_checks(folder: Path, example: Example, size: float, h: float) -> dict[str, float]:
    """Tangents of fibres beside differences, their energy balance, and a layer beside a fibre."""
    rng, fibre, layers = np.random.default_rng(3), Fibre(folder, example), Layers(folder, example)
    E, strain = float(fibre.m.young), 0.0
    by_strain = by_rate = stress_error = 0.0
    for _ in range(40):
        step = 0.4 * size * float(rng.normal())
        # at a rate that the step does not have, either way: nothing ties them together here
        rate, tiny = float(rng.normal()) * size / h, 1e-6 * size
        sigma, slope, faster = fibre.tangent(strain + step, rate, h)
        stress_error = max(stress_error, abs(sigma - fibre.step(strain + step, rate, h)[0]))
        ends = [fibre.step(strain + step + direction, rate, h)[0] for direction in (tiny, -tiny)]
        by_strain = max(by_strain, abs(slope - (ends[0] - ends[1]) / (2.0 * tiny)) / E)
        tiny = 1e-6 * abs(rate)
        ends = [fibre.step(strain + step, rate + direction, h)[0] for direction in (tiny, -tiny)]
        by_rate = max(by_rate, abs(faster - (ends[0] - ends[1]) / (2.0 * tiny)) * abs(rate))
        strain += step
        fibre.step(strain, step / h, h)
        fibre.accept()
    errors = {
        "fibre stress": stress_error / (E * size),
        "fibre by strain": by_strain,
        "fibre by rate": by_rate / (E * size),
        "fibre balance": fibre_balance(Fibre(folder, example), 0.02 * size, 0.02 * h),
    }
    fibre, worst, strain = Fibre(folder, example), 0.0, 0.0
    for step in [0.2 * size] * 20 + [-0.2 * size] * 30:
        strain += step
        one, other = fibre.step(strain, step / h, h)[0], layers.pull(step, h)
        fibre.accept()
        worst = max(worst, abs(one - other))
    return errors | {"layer and fibre": worst / (E * size)}


def fibre_balance(fibre: Fibre, size: float, h: float) -> float:
    """Out and half way back: work less stored and lost energy, over the most of the work."""
    strain, work, lost, last, peak, stored = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(150):
        step = size if k < 100 else -size
        strain += step
        sigma, stored, gone = fibre.step(strain, step / h, h)
        work, lost, last = work + 0.5 * (last + sigma) * step, lost + gone, sigma
        peak = max(peak, work)
        fibre.accept()
    return abs(work - stored - lost) / peak


if __name__ == "__main__":
    from one_point import layer_and_point

    given = yaml.safe_load(sys.argv[1])
    with tempfile.TemporaryDirectory() as name:
        measured = checks(given, Path(name))
        measured["layer and point"] = layer_and_point(Path(name), given, 1e-3, 1e-2)
        for word, value in measured.items():
            print(f"{word}: {value:.2e}")
