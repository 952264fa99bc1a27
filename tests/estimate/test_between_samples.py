"""Numbers made of samples are right within their errors where a touch lies between two samples."""

import math
from pathlib import Path

import pytest
from command import crashsolve

from crashpost.results.result import Result

BALL = """
title: a ball strikes a floor between two samples
control: {end_time: 0.5}
output: {history: {interval: INTERVAL}}
bodies:
  a: {primitive: {shape: sphere, radius: 0.1}, mass: 2, position: [0, 0, 0.2043],
      velocity: [0, 0, -1]}
surfaces: {a: {type: sphere, body: a, radius: 0.1}, f: {type: plane}}
contacts: {c: {a: [a], b: [f], normal: {type: hertz, stiffness: 1e9}}}
watch:
  - {channel: rcforc.c.normal, statistic: max}
  - {channel: rcforc.c.normal, statistic: integral}
  - {channel: rcforc.c.depth, statistic: max}
  - {channel: rbdout.a.acceleration.z, statistic: max}
  - channel: hic(norm(rbdout.a.acceleration.x, rbdout.a.acceleration.z), '15 ms')
    statistic: max
  - {channel: glstat.model.energy.contact_stored, statistic: max}
  - {channel: rbdout.a.velocity.z, statistic: final}
"""
# an elastic ball at v = 1 m/s: K d^2.5 / 2.5 = m v^2 / 2, F = K d^1.5; impulse 2 m v
DEPTH = (2.5 * 2 / (2 * 1e9)) ** 0.4
PEAK, IMPULSE = 1e9 * DEPTH**1.5, 4.0
# v t = 2.943 d, after 4.3 mm and 100 mm at v; a sample in the middle and the next ones outside
MIDDLE, DURATION = 0.1043 + 0.5 * 2.943 * DEPTH, 2.943 * DEPTH
ALONE = MIDDLE / round(MIDDLE / (0.7 * DURATION))
# a sample soon after the touch begins, and the next ones long after it ends
SOON = (0.1043 + 0.2 * DURATION) / 9


def run(folder: Path, interval: str) -> tuple[dict[str, dict[str, float]], str]:
    """Estimates by the channel and statistic, and the log."""
    deck = folder / "deck.yaml"
    deck.write_text(BALL.replace("INTERVAL", interval), "utf-8")
    done = crashsolve(deck, "-o", folder / "r")
    assert done.returncode == 0, done.stdout
    entries = Result(folder / "r").status["watched"]
    return {f"{e['channel'].split('(')[0]} {e['statistic']}": e for e in entries}, done.stdout


@pytest.mark.parametrize("interval", ["0.01", "0.0473", "0.1", f"{ALONE:.9g}", f"{SOON:.9g}"])
def test_numbers_are_right_within_their_errors(tmp_path: Path, interval: str) -> None:
    watched, log = run(tmp_path, interval)
    true = {"rcforc.c.normal max": PEAK, "rcforc.c.normal integral": IMPULSE}
    true["rbdout.a.acceleration.z max"] = PEAK / 2
    for name, value in true.items():
        # the step's own error is below a hundredth
        assert abs(watched[name]["value"] - value) <= 1.01 * watched[name]["error"], name
        # twenty steps and more see the touch so well
        assert watched[name]["value"] == pytest.approx(value, rel=0.02), name
    assert watched["rcforc.c.depth max"]["value"] == pytest.approx(DEPTH, rel=0.01)
    # a tenth of its value at most
    assert 0.0 < 10.0 * watched["hic max"]["error"] < watched["hic max"]["value"]
    assert watched["rbdout.a.velocity.z final"]["error"] < 1e-2
    assert "contact 'c' peaked at" not in log
    assert "take shorter steps" not in log


@pytest.mark.long
def test_samples_that_show_the_touch_are_not_warned_of(tmp_path: Path) -> None:
    watched, log = run(tmp_path, "2e-5")
    assert "peaked at" not in log
    assert watched["rcforc.c.normal max"]["value"] == pytest.approx(PEAK, rel=0.01)
    assert watched["hic max"]["error"] is not None


PULSE = """
control: {end_time: 0.5}
output: {history: {interval: INTERVAL}}
bodies: {a: {mass: 1, inertia: [1, 1, 1]}}
curves: {p: {type: formula, expression: "exp(-((x-0.1234)/1e-4)**2)", from: 0, to: 1}}
loads: {f: {type: force, body: a, force: [1000, 0, 0], curve: p}}
watch:
  - {channel: rbdout.a.velocity.x, statistic: final}
  - {channel: rbdout.a.acceleration.x, statistic: abs_max}
"""


@pytest.mark.parametrize(("interval", "is_missed"), [("0.05", True), ("2e-5", False)])
def test_a_load_that_peaks_between_samples_is_reported(
    tmp_path: Path, interval: str, is_missed: bool
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(PULSE.replace("INTERVAL", interval), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "r")
    assert done.returncode == 0, done.stdout
    velocity, acceleration = Result(tmp_path / "r").status["watched"]
    # sqrt(pi) w F / m
    assert velocity["value"] == pytest.approx(0.1772454, rel=1e-5)
    assert velocity["error"] is not None
    assert ("curve 'p' ranges over 1 (SI)" in done.stdout) == is_missed
    # 1000 m/s^2, of which no sample shows anything
    assert (acceleration["error"] is None) == is_missed
    if not is_missed:
        assert acceleration["value"] == pytest.approx(1000.0, rel=0.01)


def test_a_peak_of_all_steps_is_known_though_one_sample_shows_it(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    text = BALL.replace("INTERVAL", f"{ALONE:.9g}")
    deck.write_text(text + "  - {channel: rcforc.c.peak_normal, statistic: max}\n", "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "r")
    assert done.returncode == 0, done.stdout
    peak = Result(tmp_path / "r").status["watched"][-1]
    # the step's own error, below a hundredth
    assert 0.1 * abs(peak["value"] - PEAK) < peak["error"] < 0.01 * PEAK


SETTLING = """
title: a ball begins just above a stiff floor and settles within the first of two samples
control: {end_time: 0.2, safety: 0.02}
output: {history: {interval: 0.1}}
bodies: {a: {primitive: {shape: sphere, radius: 0.1}, mass: 1, position: [0, 0, 0.1]}}
surfaces: {a: {type: sphere, body: a, radius: 0.1}, f: {type: plane}}
contacts: {c: {a: [a], b: [f], normal: {type: kelvin_voigt, stiffness: 1e7, damping: 300}}}
loads: {weight: {type: gravity}}
watch:
  - {channel: rcforc.c.normal, statistic: max}
  - {channel: rcforc.c.peak_normal, statistic: max}
"""


def test_a_peak_of_steps_that_are_too_many_to_sample_is_in_the_error(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(SETTLING, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "r")
    assert done.returncode == 0, done.stdout
    normal, peak = Result(tmp_path / "r").status["watched"]
    # of a step of force 1 + exp(-pi zeta / sqrt(1 - zeta^2)), zeta = c / 2 sqrt(k m); c is small
    zeta = 300 / (2 * math.sqrt(1e7))
    overshoot = 1.0 + math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2))
    assert peak["value"] == pytest.approx(9.80665 * overshoot, rel=3e-3)
    assert normal["error"] >= peak["value"] - normal["value"]
    # half of it is hidden: of its own error, and of the samples'
    assert normal["value"] < 0.6 * peak["value"]
    assert "contact 'c' peaked at" in done.stdout


STOP = """
control: {end_time: 0.2}
output: {history: {interval: INTERVAL}}
bodies: {a: {mass: 2, inertia: [1, 1, 1], velocity: [3, 0, 0]}}
joints: {rail: {type: prismatic, b: a, at: [0, 0, 0], axis: [1, 0, 0]}}
springs: {stop: {type: translation_stop, joint: rail, stiffness: 1e7, upper: 0.2043}}
watch:
  - {channel: deforc.stop.force, statistic: abs_max}
  - {channel: rbdout.a.acceleration.x, statistic: integral}
  - {channel: jntforc.rail.force.y, statistic: max}
  - {channel: rbdout.a.acceleration.x, statistic: abs_max, during: [0, 0.06]}
  - {channel: rbdout.a.velocity.x, statistic: final}
  - {channel: rbdout.a.position.x, statistic: max}
"""


@pytest.mark.parametrize("method", ["rattle", "dormand_prince_5", "radau_iia_5"])
@pytest.mark.parametrize("interval", ["0.01", "0.0471"])
def test_a_stop_between_samples_leaves_no_error_of_what_misses_it(
    interval: str, method: str, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(STOP.replace("INTERVAL", interval), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "r", "--set", f"control.integrator={method}")
    assert done.returncode == 0, done.stdout
    *missing, before, velocity, position = Result(tmp_path / "r").status["watched"]
    # for pi sqrt(m / k) = 1.4 ms at 68.1 ms it has up to v sqrt(k m) = 13.4 kN
    assert [entry["error"] for entry in missing] == [None] * 3
    assert all("'a' moves between samples" in entry["how"] for entry in missing)
    # the end of a window is a sample
    assert before["error"] == 0.0
    assert velocity["value"] == pytest.approx(-3.0, abs=0.01)
    assert velocity["error"] is not None
    # and of its way that it is seen to go, v / omega beyond the stop
    assert abs(position["value"] - 0.2043 - 3.0 / math.sqrt(1e7 / 2)) < position["error"]
    assert "give a shorter output.history.interval" in done.stdout


@pytest.mark.parametrize("name", ["phases/preload", "parts/elastica"])
def test_bodies_that_a_search_stops_are_not_reported(name: str, tmp_path: Path) -> None:
    # by kinetic damping in a phase; nodes of beams vibrate within samples of any run
    deck = Path(__file__).resolve().parents[2] / f"decks/verification/{name}.yaml"
    done = crashsolve(deck, "-o", tmp_path / "r")
    assert done.returncode == 0, done.stdout
    assert "between the samples" not in done.stdout


VIBRATION = """
control: {end_time: END, integrator: dormand_prince_8}
output: {history: {interval: INTERVAL}}
bodies: {a: {mass: 1, inertia: [1, 1, 1], position: [1.1, 0, 0]}}
springs: {s: {type: linear, b: a, stiffness: 1e4, length: 1}}
watch: [{channel: deforc.s.force, statistic: min}]
"""


@pytest.mark.parametrize(("share", "is_known"), [(2.0, False), (1.0, False), (1 / 3, True)])
def test_a_vibration_of_whole_periods_between_samples_is_reported(
    share: float, is_known: bool, tmp_path: Path
) -> None:
    # samples so many half waves of omega = 100 rad/s apart
    interval = share * math.pi / 100.0
    text = VIBRATION.replace("INTERVAL", f"{interval:.15g}").replace("END", f"{30 * interval:.15g}")
    deck = tmp_path / "deck.yaml"
    deck.write_text(text, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "r")
    assert done.returncode == 0, done.stdout
    (force,) = Result(tmp_path / "r").status["watched"]
    assert (force["error"] is not None) == is_known
    if is_known:
        assert abs(force["value"] + 1000.0) <= force["error"] + 1e-3


@pytest.mark.parametrize(
    ("formula", "interval"),
    [
        # many waves between samples, which show all sizes; 6 samples in a period of the spring
        ("1 - cos(10450*x)", "0.006931"),
        ("sin(9000*x)", "0.0011"),
        # a corner between samples
        ("max(0, 1 - abs(x - 0.0527)/0.013)", "0.004"),
        ("max(0, 1 - abs(x - 0.0911)/0.03)", "0.01"),
    ],
)
def test_an_acceleration_is_right_within_its_error_under_loads_that_samples_do_not_follow(
    tmp_path: Path, formula: str, interval: str
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(f"""
control: {{end_time: 0.2}}
output: {{history: {{interval: {interval}}}}}
curves: {{p: {{type: formula, expression: '{formula}', from: 0, to: 0.2}}}}
bodies: {{m: {{mass: 2, inertia: [1, 1, 1]}}}}
loads: {{f: {{type: force, body: m, force: [500, 0, 0], curve: p}}}}
watch: [{{channel: rbdout.m.acceleration.x, statistic: abs_max}}]
""")
    done = crashsolve(deck, "-o", tmp_path / "r")
    assert done.returncode == 0, done.stdout
    (entry,) = Result(tmp_path / "r").status["watched"]
    true = 500.0 if formula.startswith("1 - cos") else 250.0
    if entry["error"] is None:
        assert "between samples" in entry["how"]
    else:
        # an extreme of the load is one of the acceleration
        assert abs(entry["value"] - true) <= 3.0 * entry["error"]


@pytest.mark.parametrize("height", [0.03644, 0.0364, 0.0366])
@pytest.mark.parametrize("damping", [2000.0, 12_310.0])
def test_a_peak_between_few_steps_is_right_within_its_error(
    tmp_path: Path, height: float, damping: float
) -> None:
    # a method of high order crosses the touch in some four steps, which samples cut
    mass, stiffness, speed = 19.27, 1.084e8, 1.4606
    deck = tmp_path / "deck.yaml"
    deck.write_text(f"""
control: {{end_time: 0.06, integrator: dormand_prince_8, tolerance: 2e-6}}
output: {{history: {{interval: 4.525e-4}}}}
bodies:
  a: {{mass: {mass}, inertia: [1, 1, 1], position: [0, 0, {0.1 + height}],
       velocity: [0, 0, {-speed}]}}
surfaces: {{a: {{type: sphere, body: a, radius: 0.1}}, f: {{type: plane}}}}
contacts:
  c: {{a: [a], b: [f], normal: {{type: kelvin_voigt, stiffness: {stiffness}, damping: {damping}}}}}
watch: [{{channel: rcforc.c.peak_normal, statistic: final}}]
""")
    done = crashsolve(deck, "-o", tmp_path / "r")
    assert done.returncode == 0, done.stdout
    (entry,) = Result(tmp_path / "r").status["watched"]
    # delta = v / omega_d exp(-d t) sin(omega_d t)
    d = 0.5 * damping / mass
    rate = math.sqrt(stiffness / mass - d * d)
    forces = []
    for k in range(2000):
        t = math.pi / rate * k / 2000
        depth = speed / rate * math.exp(-d * t) * math.sin(rate * t)
        closing = speed * math.exp(-d * t) * math.cos(rate * t) - d * depth
        forces.append(stiffness * depth + damping * closing)
    assert abs(entry["value"] - max(forces)) <= 10.0 * entry["error"] + 1e-6 * max(forces)
