"""What a shell costs: bare force and update, a whole run, memory; an implicit step.

    python benchmarks/shell_cost.py [elements along a side, a multiple of 4]

CPU time, so that a busy machine disturbs little, and of many short runs the fastest: a core that
others use beside is slower by up to a half. Flops are counted on the kernels as plain Python;
bytes are those that a cycle must move where the model does not fit into the cache: numbers of the
elements read and written, corners read, points read and written twice.
"""

import os
import subprocess
import sys
import tempfile
import time
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from crashsolve.cli import release_memory
from crashsolve.compiler.machine import machine_code
from crashsolve.compiler.table import Tables
from crashsolve.deck.reading.deck import read_deck
from crashsolve.elements.shells.forces import blocks
from crashsolve.foundation.point import LANES, POINT
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

DECK = """
title: shells
control: {{end_time: {end}, safety: 0.9, energy_limit: "off", estimate: "off"}}
materials:
  elastic: {{type: elastic, young: 2.1e11, poisson: 0.3, density: 7850}}
  plastic: {{type: elastoplastic, young: 2.1e11, poisson: 0.3, density: 7850, yield_stress: 2.5e8,
    hardening: 1e9}}
  johnson_cook: {{type: johnson_cook, young: 2.1e11, poisson: 0.3, density: 7850,
    yield_stress: 2.5e8, hardening: 3e8, exponent: 0.3, rate: 0.02, melting_heat: 7e5}}
parts:
  plate:
    type: shell
    mesh: {{type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [{n}, {n}]}}
    thickness: {thickness}
    element: {element}
    material: {material}
    supports: [{{nodes: u0}}, {{nodes: u1}}, {{nodes: v0}}, {{nodes: v1}}]
loads: {{q: {{type: pressure, part: plate, pressure: {pressure}}}}}
output: {{history: {{interval: {end}}}}}
"""
BARE = """
from crashsolve.foundation.kernels import entry
from crashsolve.materials import {law}
from crashsolve.elements.shells.forces import {kind}
from crashsolve.elements.shells.forces.blocks import deform

@entry
def advance(h, flag, scene):
    for _ in range(scene.cycles[0]):
        deform({kind}, scene.p[0], scene.clock[0], h, scene, {law})
"""
# of which the fastest counts, a few hundredths of a second each
RUNS = 50
# file of the kernels, and elements for each quadrilateral of the mesh
KINDS = {"reduced": ("reduced", 1), "fully_integrated": ("full", 1), "triangles": ("triangle", 2)}
CASES = [(element, material) for element in KINDS for material in ("elastic", "plastic")]
CASES += [("reduced", "johnson_cook")]


def engine(folder: Path, n: int, element: str, material: str) -> Engine:
    """A plate of n by n quadrilaterals, or twice as many triangles."""
    path = folder / f"{material}.yaml"
    values = {"n": n, "material": material, "thickness": 0.1 / n, "pressure": 1e5, "end": 1e-3}
    values["element"] = element
    path.write_text(DECK.format(**values), "utf-8")
    return Engine(*build(read_deck(path)))


def bare(folder: Path, n: int, element: str, material: str) -> float:
    """CPU time of gather, strain, stress, force and scatter per element and cycle [s].

    Points have velocities and stay where they are: every layer strains by 1e-4 a cycle, for ever
    the same way, and all of them yield where there is a yield stress. The fastest of many runs.
    """
    e = engine(folder, n, element, material)
    state, elements, group = e.state, e.model.elements, e.model.element_groups()[0]
    assert elements is not None
    rng = np.random.default_rng(1)
    state.points["v"] = rng.normal(size=(len(state.points), 3)) * 1e-4 / n
    cycles = max(1, 400_000 // n**2)
    tables = Tables(
        {"points": state.points, "lanes": state.blocks, "corners": elements.corners}
        | {"work": elements.work, "p": group.parameters, "clock": state.clock}
        | {"curves": e.model.curves, "cycles": np.array([cycles])}
    )
    source = folder / f"bare_{element}.py"
    (kind, pieces), law = KINDS[element], group.materials[0][1]
    source.write_text(BARE.format(kind=kind, law=law.__name__.rpartition(".")[2]), "utf-8")
    advance = machine_code(source, "advance", tables)
    best = 1e300
    for _ in range(RUNS):
        begun = time.process_time()
        advance(1.0, False, tables)
        best = min(best, time.process_time() - begun)
    return best / (cycles * pieces * n**2)


class Counted(float):
    """A number that counts its operations."""

    count = 0


def _counting(name: str) -> Any:
    plain = getattr(float, name)

    def act(self: Counted, *others: float) -> Counted:
        Counted.count += 1
        return Counted(plain(float(self), *map(float, others)))

    return act


for _name in ("add", "sub", "mul", "truediv"):
    for _side in ("", "r"):
        setattr(Counted, f"__{_side}{_name}__", _counting(f"__{_side}{_name}__"))


class Column(list[object]):
    """Numbers that stay such numbers: those of numpy would not count."""

    def __setitem__(self, at: Any, value: Any) -> None:
        super().__setitem__(at, Counted(value))


def flops(folder: Path, element: str, material: str) -> float:
    """Operations per element and cycle, counted; square roots are left out."""
    e = engine(folder, 4, element, material)
    state, elements, group = e.state, e.model.elements, e.model.element_groups()[0]
    assert elements is not None
    state.points["v"] = np.random.default_rng(1).normal(size=(len(state.points), 3)) * 5e-3
    scene = SimpleNamespace(
        points=state.points.view(np.recarray),
        corners=elements.corners,
        lanes=Column(map(Counted, state.blocks)),
        work=Column(map(Counted, elements.work)),
        curves=e.model.curves.view(np.recarray),
    )
    Counted.count = 0
    p, clock = group.parameters.view(np.recarray)[0], state.clock.view(np.recarray)[0]
    (kind, pieces), law = KINDS[element], group.materials[0][1]
    kernels = import_module(f"crashsolve.elements.shells.forces.{kind}")
    blocks.deform(kernels, p, clock, 1.0, scene, law)
    return Counted.count / (16 * pieces)


def moved(stride: int, pieces: int) -> float:
    """Bytes that an element and cycle moves through memory, a point to a quadrilateral."""
    return 16 * stride / LANES + 16 + 4 * POINT.dtype.itemsize / pieces


def bandwidth() -> float:
    """Bytes per second of a sum of two long arrays on one core."""
    a, b = np.ones(20_000_000), np.ones(20_000_000)
    best = 1e300
    for _ in range(5):
        begun = time.process_time()
        np.add(a, b, out=b)
        best = min(best, time.process_time() - begun)
    return 24 * len(a) / best


def whole(folder: Path, n: int, element: str, material: str) -> tuple[float, float, float]:
    """CPU time per element and cycle of a run [s], memory per element [bytes], set-up time [s]."""
    path = folder / f"{material}.yaml"
    end = 40 * 0.9 / n / 6000
    values = {"n": n, "material": material, "thickness": 0.1 / n, "pressure": 1e5, "end": end}
    values["element"] = element
    path.write_text(DECK.format(**values), "utf-8")
    script = (
        "import sys, time\n"
        "from pathlib import Path\n"
        "from crashsolve.cli import release_memory\n"
        "from crashsolve.compiler.machine import load_linker\n"
        "release_memory()\n"
        "load_linker()\n"
        "from crashsolve.deck.reading.deck import read_deck\n"
        "from crashsolve.model.build import build\n"
        "from crashsolve.system.engine import Engine\n"
        "begun = time.process_time()\n"
        "e = Engine(*build(read_deck(Path(sys.argv[1]))))\n"
        "e.start()\n"
        "ready = time.process_time()\n"
        "e.advance(float(sys.argv[2]))\n"
        "done = time.process_time()\n"
        "used = Path('/proc/self/status').read_text().partition('VmHWM:')[2]\n"
        "peak = 1024 * int(used.split()[0])\n"
        "print(done - ready, int(e.clock['cycle']), peak, ready - begun)\n"
    )
    for _ in range(2):  # the first run compiles
        words = [sys.executable, "-c", script, str(path), str(end)]
        measured = subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()
    cpu, cycles, peak, ready = map(float, measured)
    count = KINDS[element][1] * n**2
    return cpu / (cycles * count), peak / count, ready


def implicit(folder: Path, n: int, method: str) -> tuple[float, float, int]:
    """CPU of an implicit step with new factors, and with those at hand; passes of the latter."""
    path = folder / "implicit.yaml"
    words = {"thickness": 0.01, "element": "reduced", "material": "elastic", "pressure": 1e4}
    text = DECK.format(n=n, end=1.0, **words)
    step = 1e-4
    control = f"integrator: {method}, step: {step}, tolerance: 1e-6"
    path.write_text(text.replace("safety: 0.9", control), "utf-8")
    e = Engine(*build(read_deck(path)))
    e.start()
    spent = {True: 0.0, False: 0.0}
    for cycle in range(40):
        is_anew = cycle % 2 == 0
        if is_anew:
            e.state.clock["factored"] = 0.0
        begun = time.process_time()
        e.advance((cycle + 1) * step)
        # the first steps learn how many a call may take
        spent[is_anew] += (time.process_time() - begun) if cycle >= 20 else 0.0
    return spent[True] / 10, spent[False] / 10, int(e.clock["last_iterations"])


def main(n: int) -> None:
    """Print the table."""
    print(f"{n * n} elements, 5 layers; {os.uname().machine}, one core")
    print(f"bandwidth of one core {bandwidth() / 1e9:.1f} GB/s")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for case in CASES:
            e = engine(folder, n, *case)
            stride = int(e.model.element_groups()[0].parameters["stride"][0])
            seconds, run = bare(folder, n, *case), whole(folder, n, *case)
            bytes_moved, count = moved(stride, KINDS[case[0]][1]), flops(folder, *case)
            print(
                f"{case[0]:16} {case[1]:12} "
                f"bare {1e-6 / seconds:6.2f} M/s {1e9 * seconds:6.1f} ns, "
                f"{count:.0f} flops, {bytes_moved:.0f} bytes, {count / seconds / 1e9:.1f} Gflop/s, "
                f"{bytes_moved / seconds / 1e9:.1f} GB/s; whole run {1e-6 / run[0]:.2f} M/s, "
                f"{run[1]:.0f} bytes per element in all, set-up {run[2]:.1f} s of CPU"
            )
        for side in (10, 20, 40):
            for method in ("generalized_alpha", "radau_iia_5"):
                anew, kept, iterations = implicit(folder, side, method)
                print(
                    f"{method}, {side * side} elements: {1e3 * anew:.2f} ms a step with new "
                    f"factors, {1e3 * kept:.2f} ms with those at hand, {iterations} passes"
                )


if __name__ == "__main__":
    # as in a run
    release_memory()
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 64)
