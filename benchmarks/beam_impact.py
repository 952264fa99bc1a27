"""Cost of the beam impact of section 4.5: CPU time and error of the tips' paths, by method.

    python benchmarks/beam_impact.py

Error: the largest distance of either end of the beam from a run with far finer steps, until the
second end strikes (0.75 s) and until the end (2 s), and how far the impulse of the walls is from
that run's, over the largest it has, until the same times. Beside it, measured on a like machine:
Exudyn's geometrically exact beams in the plane with velocity Verlet cost 1.8 us per step of 10
elements and 3.6 us of 20; with RK4 at 5e-5 s and 10 elements 0.34 s for 0.26 % of the tip's path.
"""

import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

SCENES = Path(__file__).resolve().parent.parent / "decks" / "scenes"
TIMES = np.arange(0.45, 2.0001, 0.005)
FIRST_END = TIMES < 0.75
REFERENCE = {"safety": 0.005}
EXPLICIT = [{"safety": s} for s in (0.8, 0.4, 0.2, 0.1, 0.05)]
CONTROLLED = [
    {"integrator": f"dormand_prince_{order}", "tolerance": tolerance}
    for order in (5, 8)
    for tolerance in (1e-4, 1e-5, 1e-6)
]


def run(deck: str, settings: Mapping[str, object]) -> tuple[np.ndarray, np.ndarray, int, float]:
    """Positions (n, 2, 3) of both ends, impulses (n, 3) [N s], steps and CPU time [s]."""
    changes = {f"control.{name}": str(value) for name, value in settings.items()}
    path = SCENES / f"beam_impact_{deck}.yaml"
    model, state = build(read_deck(path, changes | {"control.energy_limit": "off"}))
    engine, positions, impulses = Engine(model, state), [], []
    engine.start()
    ends = [model.bodies.index(f"beam_{end}") for end in ("start", "end")]
    begun = time.process_time()
    for moment in TIMES:
        engine.advance(moment)
        positions.append(engine.state.nodes["r"][ends].copy())
        impulses.append(engine.clock["impulse"].copy())
    return (
        np.array(positions),
        np.array(impulses),
        int(engine.clock["cycle"]),
        time.process_time() - begun,
    )


def main() -> None:
    print(
        "| deck | method | steps | CPU s | us/step | error to 0.75 s, mm | to 2 s, mm "
        "| impulse to 0.75 s, % | to 2 s, % |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for deck in ("10_continuous", "20_continuous", "10_unilateral", "20_unilateral"):
        methods = EXPLICIT + (CONTROLLED if "continuous" in deck else [])
        finest, truth, _, _ = run(deck, REFERENCE)
        for settings in methods:
            positions, impulses, steps, cpu = run(deck, settings)
            apart = 1e3 * np.linalg.norm(positions - finest, axis=2).max(1)
            missed = np.linalg.norm(impulses - truth, axis=1)
            missed *= 1e2 / np.linalg.norm(truth, axis=1).max()
            message = ", ".join(f"{value}" for value in settings.values())
            print(
                f"| {deck} | {message} | {steps} | {cpu:.3f} | {1e6 * cpu / steps:.1f} "
                f"| {apart[FIRST_END].max():.3g} | {apart.max():.3g} "
                f"| {missed[FIRST_END].max():.2g} | {missed.max():.2g} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
