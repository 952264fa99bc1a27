"""Claim: the step that begins where a contact does is no longer than the contact itself."""

from pathlib import Path

import pytest
from command import crashsolve

from crashpost.results.result import Result

HEIGHT, STIFFNESS, GRAVITY = 1.0, 1e7, 9.81
DECK = """
control: {end_time: 3, estimate: off, integrator: METHOD, step_max: STEP}
output: {history: {interval: 0.5}}
bodies: {a: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [0, 0, 1.1]}}
surfaces:
  ball: {type: sphere, body: a, radius: 0.1}
  table: {type: box, at: [0, 0, -0.05], size: [1, 1, 0.1]}
contacts: {c: {a: [ball], b: [table], normal: {type: hertz, stiffness: 1e7}}}
loads: {g: {type: gravity}}
"""


# the ball flies for 0.9 s between impacts of 3.7 ms, with steps of up to 0.2 s
@pytest.mark.parametrize(
    "method, step",
    [
        ("dormand_prince_8", 0.04),
        ("dormand_prince_8", 0.05),
        ("dormand_prince_8", 0.2),
        ("dormand_prince_5", 0.2),
        ("radau_iia_5", 0.2),
    ],
)
def test_a_ball_bounces_without_loss_whatever_the_longest_step(
    method: str, step: float, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(DECK.replace("METHOD", method).replace("STEP", str(step)), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    result = Result(tmp_path / "out")
    z = result.series("rbdout.a.position.z").values - 0.1
    v = result.series("rbdout.a.velocity.z").values
    # errors of steps of 1e-6 in three impacts
    assert 0.5 * v[-1] ** 2 + GRAVITY * z[-1] == pytest.approx(GRAVITY * HEIGHT, rel=1e-4)
    speed = (2.0 * GRAVITY * HEIGHT) ** 0.5
    # three impacts, each of which reverses the momentum; the weight adds its impulse in 3.7 ms
    assert result.series("rcforc.c.impulse.z").values[-1] == pytest.approx(6.0 * speed, rel=0.01)
    # K d^2.5 / 2.5 = m v^2 / 2; the weight adds 0.2 %
    depth = (1.25 * speed**2 / STIFFNESS) ** 0.4
    assert result.series("rcforc.c.peak_depth").values[-1] == pytest.approx(depth, rel=0.005)
