"""Parkes' cantilever struck at its tip, as a chain of rigid segments and plastic hinges.

    python benchmarks/parkes.py [SEGMENTS ...]

A mass G at the tip of a rigid-plastic cantilever starts at V_0; a plastic hinge travels from the
tip to the root, and then the whole rotates about its root. With m the mass per length, M_0 the
plastic moment and displacements small (Parkes 1955), in the second phase

    omega = V_0 / (L (1 + m L / 2 G)),   theta_root = (G L^2 + m L^3 / 3) omega^2 / 2 M_0

The chain errs by the length of its segments, over which the travelling hinge leaps, and by its
elasticity, as waves of bending run ahead of the hinge. R is the energy of the impact over that
which the beam stores elastically at M_0. V_0 is a tenth of the benchmark's, so that displacements
are small; they go with its square.

Reference: Parkes (1955), The permanent deformation of a cantilever struck transversely at its tip,
Proc. Royal Society A 228, 462-476.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from crashpost.results.result import Result

LENGTH, PER_LENGTH, TIP_MASS, MOMENT, SPEED = 1.0, 10.0, 2.0, 500.0, 2.0
# of the benchmark (P4) at 20 m/s, times the square of the speed
TIP, ROOT, DURATION = 0.3434465761 * 0.01, 0.1741496599 * 0.01, 0.008
# the blow is a pulse that is this short beside all that follows [s]
PULSE = 2e-5


def deck(segments: int, ratio: float) -> str:
    """The chain, so stiff that the ratio of energies is as asked."""
    part = LENGTH / segments
    # R = (G V^2 / 2) / (M^2 L / 2 E I), E I = M part / reach
    reach = TIP_MASS * SPEED**2 * part / (ratio * MOMENT * LENGTH)
    mass, inertia = PER_LENGTH * part, PER_LENGTH * part**3 / 12.0
    bodies = [
        f"  s{i}: {{mass: {mass}, inertia: [{inertia}, {inertia}, {inertia}], "
        f"position: [{(i + 0.5) * part}, 0, 0]}}"
        for i in range(segments)
    ]
    hinges = [
        f"  h{i}: {{type: bending, {f'a: s{i - 1}, ' if i else ''}b: s{i}, "
        f"at: [{i * part}, 0, 0], axis: [0, 0, 1], curve: hinge}}"
        for i in range(segments)
    ]
    impulse = 2.0 * TIP_MASS * SPEED / PULSE
    return "\n".join(
        [
            f"title: Parkes' cantilever of {segments} segments",
            f"control: {{end_time: {1.2 * DURATION}, safety: 0.3, step_max: {PULSE / 20}, "
            "estimate: off}",
            f"output: {{history: {{interval: {DURATION / 100}}}, states: {{interval: 1}}}}",
            "curves:",
            f"  hinge: {{points: [[0, 0], [{reach}, {MOMENT}], [1, {MOMENT}]]}}",
            f"  blow: {{points: [[0, 0], [{PULSE / 2}, {impulse}], [{PULSE}, 0], [1, 0]]}}",
            "bodies:",
            *bodies,
            f"  tip: {{mass: {TIP_MASS}, inertia: [1e-3, 1e-3, 1e-3], position: [{LENGTH}, 0, 0]}}",
            "joints:",
            f"  tip: {{type: revolute, a: s{segments - 1}, b: tip, at: [{LENGTH}, 0, 0], "
            "axis: [0, 0, 1]}",
            "hinges:",
            *hinges,
            "loads: {blow: {type: force, body: tip, force: [0, 1, 0], curve: blow}}",
            "",
        ]
    )


def solve(segments: int, ratio: float) -> tuple[float, float]:
    """Largest displacement of the tip [m], and residual angle of the root [rad]."""
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder) / "parkes.yaml", Path(folder) / "out"
        path.write_text(deck(segments, ratio), "utf-8")
        command = [sys.executable, "-m", "crashsolve", str(path), "-o", str(out)]
        subprocess.run(command, check=True, capture_output=True)
        result = Result(out)
        tip = result.series("rbdout.tip.position.y").values
        return float(tip.max()), float(result.series("hinge.h0.residual_angle").values[-1])


def main() -> None:
    print("segments       R   tip over Parkes   root over Parkes")
    for segments in map(int, sys.argv[1:] or ["5", "10", "20", "40"]):
        for ratio in (80.0, 800.0, 8000.0, 80000.0):
            tip, root = solve(segments, ratio)
            print(f"{segments:8} {ratio:7g}   {tip / TIP:15.4f}   {root / ROOT:16.4f}", flush=True)


if __name__ == "__main__":
    main()
