"""A run names the locks, load limiters and pretensioners that had no effect, and states why."""

from pathlib import Path

import pytest
from command import crashsolve

DECK = """
title: A body hangs in a belt
control: {{end_time: 0.02, estimate: off}}
bodies:
  car: {{mass: 100, inertia: [9, 9, 9], position: [0, 0, 1]}}
  man: {{mass: 10, inertia: [1, 1, 1], position: [1, 0, 0]}}
curves:
  flat: {{points: [[0, 4000], [0.3, 4000]]}}
  winding: {{points: [[0, {winding}], [0.1, {winding}]]}}
belts:
  s:
    webbing: {{stiffness: 1.0e+5}}
    route:
      - {{retractor: {{body: car, {words}}}}}
      - {{ring: {{at: [0, 0, 0.5]}}}}
      - {{anchor: {{body: man}}}}
loads: {{weight: {{type: gravity}}}}
"""
LATE = "pretensioner: {time: 0.5, curve: winding}"
WEAK = "lock_time: 0, pretensioner: {time: 0.005, curve: winding, duration: 0.005}"
WORDS = {
    LATE: "its pretensioner fires at 0.5 s, after the end of the run at 0.02 s",
    WEAK: "its pretensioner fired and wound nothing in",
    "lock_acceleration: 50, lock_rate: 3": "its retractor did not lock until the end, at 0.02 s: "
    "its body did not reach 50 m/s^2, the webbing did not reach 3 m/s",
    "lock_time: 0, limiter: flat": "its load limiter paid nothing out",
    # both fall freely
    "lock_acceleration: 5": "the retractor locked in the first two steps",
    "lock_time: 0.01": "",
}


@pytest.mark.parametrize("words", WORDS)
def test_what_a_retractor_has_and_did_not_do_is_reported(words: str, tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(DECK.format(words=words, winding=0 if words == WEAK else 3000), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    expected = WORDS[words]
    assert expected in done.stdout
    assert done.stdout.count("warning: belt") == (2 if words == LATE else bool(expected)), (
        done.stdout
    )
