"""Claims of the anti-roll bar: forces and energy by an independent solution, refusals."""

from pathlib import Path

import numpy as np
import pytest
from bench import Bench
from scipy.optimize import brentq

from crashsolve.foundation.errors import DeckErrors

K, R, S, LINK = 800.0, 0.25, 0.5, 0.3
BODIES = "title: bar\ncontrol: {end_time: 1}\nbodies:\n  c: {mass: 1, inertia: [1, 1, 1]}\n"


def bar(folder: Path, left: str = "", right: str = "") -> Bench:
    left = left or f"arm: [{-R}, {S}, 0], at: [{-R}, {S}, {-LINK}]"
    right = right or f"arm: [{-R}, {-S}, 0], at: [{-R}, {-S}, {-LINK}]"
    text = (
        f"springs: {{s: {{type: anti_roll_bar, body: c, at: [0, 0.1, 0], stiffness: {K}, "
        f"left: {{{left}}}, right: {{{right}}}}}}}\n"
    )
    return Bench(folder, text, BODIES)


def arm_angle(roll: float, y: float) -> float:
    """Angle of the arm at y for a link of constant length to a point of the ground."""
    c, s = np.cos(roll), np.sin(roll)
    A = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    foot = np.array([-R, y, -LINK])

    def too_long(phi: float) -> float:
        end = A @ [-R * np.cos(phi), y, R * np.sin(phi)]
        return float(np.linalg.norm(end - foot) - LINK)

    return float(brentq(too_long, -1.3, 1.3, xtol=1e-15, rtol=1e-14))


def energy(roll: float) -> float:
    return 0.5 * K * (arm_angle(roll, S) - arm_angle(roll, -S)) ** 2


@pytest.mark.parametrize("roll", [-0.3, -0.02, 0.1, 0.22])
def test_energy_and_moment_are_those_of_links_of_constant_length(
    tmp_path: Path, roll: float
) -> None:
    law = bar(tmp_path).law("springs", "s")
    law.bench.rotation(1, [roll, 0, 0])
    out = law.force()
    assert out.stored == pytest.approx(energy(roll), rel=1e-11)
    # central difference: the third derivative over 6 times 1e-10, and 1e-14 / 1e-5 of round-off
    moment = -(energy(roll + 1e-5) - energy(roll - 1e-5)) / 2e-5
    assert law.bench.nodes[1].torque[0] == pytest.approx(moment, rel=1e-7)
    assert out.torque == pytest.approx(K * out.twist, rel=1e-15)


def test_a_link_at_its_dead_centre_stops_the_run_and_gives_no_force(tmp_path: Path) -> None:
    law = bar(tmp_path).law("springs", "s")
    # the arms point down when the body has risen by their length: links are stretched beyond that
    law.bench.move(1, r=[0.0, 0.0, 0.6])
    out = law.force()
    assert law.bench.curves[0].fault == -law.p.node[0] and law.bench.curves[0].x == -1.0
    assert out.force == out.right == 0.0


def test_arms_pass_half_a_turn_one_after_the_other(tmp_path: Path) -> None:
    bodies = BODIES + "".join(f"  {name}: {{mass: 1, inertia: [1, 1, 1]}}\n" for name in "fg")
    ends = [f"arm: [{-R}, {y}, 0], at: [{-R}, {y}, {-LINK}]" for y in (S, -S)]
    text = (
        f"springs: {{s: {{type: anti_roll_bar, body: c, at: [0, 0, 0], stiffness: {K}, "
        f"left: {{body: f, {ends[0]}}}, right: {{body: g, {ends[1]}}}}}}}\n"
    )
    law = Bench(tmp_path, text, bodies).law("springs", "s")
    # about the axis of the bar: each arm turns with the body at its link
    for node, angle in ((2, np.pi + 0.05), (3, np.pi - 0.05)):
        law.bench.rotation(node, [0, angle, 0])
    assert law.force().twist == pytest.approx(0.1, rel=1e-12)


WRONG = {
    "left.body: is the body of the bar": "body: c, arm: [-1, 1, 0], at: [-1, 1, -1]",
    "left.arm: .* no lever": f"arm: [{-R}, {S}, 0], at: [-1, {S}, 0]",
    "left.arm: its arm is 0 m": f"arm: [0, {S}, 0], at: [-1, {S}, -1]",
}


@pytest.mark.parametrize("message", WRONG)
def test_a_bar_that_cannot_be_meant_is_refused(tmp_path: Path, message: str) -> None:
    with pytest.raises(DeckErrors, match=message):
        bar(tmp_path, WRONG[message])
