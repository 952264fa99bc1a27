"""Claims of paths of equilibria: they are those of closed forms through limit points where load and
motion turn back; their end, what is unstable on them and what they cannot do is stated.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from quick import first_quick
from scipy.optimize import brentq

from crashpost.results.result import Result

ROOT = Path(__file__).parents[2]
# two bars as springs of stiffness k between supports and a body that moves up and down, on
# which a load acts
BARS = """
title: two bars
control: {end_time: 1, solution: quasi_static, path: arc_length, steps: 10}
bodies: {apex: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 0.3]}}
joints: {up: {type: prismatic, b: apex, at: [0, 0, 0.3], axis: [0, 0, 1]}}
springs:
  left: {type: linear, a: ground, b: apex, at_a: [-1, 0, 0], stiffness: 1000}
  right: {type: linear, a: ground, b: apex, at_a: [1, 0, 0], stiffness: 1000}
curves: {rise: {points: [[0, 0], [1, 1]], extrapolate: linear}}
loads: {p: {type: force, body: apex, force: [0, 0, -LOAD], curve: rise}}
"""
# a soft spring that pushes the bars: its driven end has to turn back
PUSHED = (
    BARS.replace("loads: {p: {type: force, body: apex, force: [0, 0, -LOAD], curve: rise}}", "")
    .replace("bodies: {", "bodies: {head: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 1.3]}, ")
    .replace(
        "joints: {", "joints: {push: {type: translation_driver, joint: rail, curve: rise}, RAIL"
    )
    .replace("RAIL", "rail: {type: prismatic, b: head, at: [0, 0, 1.3], axis: [0, 0, -1]}, ")
    .replace("springs:", "springs:\n  soft: {type: linear, a: head, b: apex, stiffness: 20}")
)
SOFT = 20.0
KINDS = ("maximum", "minimum")


def of_bars(z: np.ndarray) -> np.ndarray:
    """Load downward under which the apex of both bars stands at a height z [N]."""
    first, now = np.hypot(1.0, 0.3), np.hypot(1.0, z)
    return 2.0 * 1000.0 * (first - now) * z / now


def ran(folder: Path, text: str, *words: str) -> tuple[int, Result, str]:
    deck = folder / "deck.yaml"
    deck.write_text(text, "utf-8")
    done = crashsolve(deck, "-o", folder / "out", *words)
    return done.returncode, Result(folder / "out"), done.stderr


def series(result: Result, name: str) -> np.ndarray:
    return np.asarray(result.series(name).values)


@pytest.mark.parametrize("load", first_quick([20.0, 5.0, 1000.0]))
def test_the_path_of_two_bars_is_its_closed_form(tmp_path: Path, load: float) -> None:
    code, result, _ = ran(tmp_path, BARS.replace("LOAD", f"{load}"))
    assert code == 0
    z = series(result, "rbdout.apex.position.z")
    factor = series(result, "glstat.model.load_factor")
    # of what the tolerance of an equilibrium, 1e-8, leaves of the largest force
    assert load * factor == pytest.approx(of_bars(z), abs=1e-7 * load)
    assert factor[-1] == pytest.approx(1.0, abs=1e-12)
    heights = np.linspace(0.0, 0.3, 10001)
    limit = of_bars(heights).max()
    has_limit = load > limit
    assert (z[-1] < -0.3) == has_limit
    if has_limit:
        text = result.log
        factors = [float(x) for x in re.findall(r"of the load factor, (\S+);", text)]
        # of a parabola through three equilibria
        assert load * factors[0] == pytest.approx(limit, rel=0.03)
        unstable = series(result, "glstat.model.unstable_modes")
        slope = np.gradient(of_bars(z), z)
        between = np.abs(np.abs(z) - heights[of_bars(heights).argmax()]) > 0.02
        assert ((unstable > 0) == (slope > 0.0))[between].all()


@pytest.mark.long
def test_a_driver_turns_back_where_the_path_does(tmp_path: Path) -> None:
    code, result, _ = ran(tmp_path, PUSHED)
    assert code == 0
    z, factor = (series(result, n) for n in ("rbdout.apex.position.z", "glstat.model.load_factor"))
    # the soft spring is as much shorter as its force needs
    assert factor == pytest.approx(of_bars(z) / SOFT + 0.3 - z, abs=1e-7)
    assert (np.diff(factor) < 0.0).any()
    balance = series(result, "glstat.model.balance")[-1]
    assert abs(balance) < 2.0


def toggle(w: float) -> float:
    """Load at which the apex of Williams' toggle is down by w [lbf]: shallow beam-columns."""
    h, L, EA, EI = 0.386, 12.943, 1.885e6, 9.27e3

    def bow(kL: float) -> float:
        """Integral of v'^2 over the length, of v with v' = 0 at both ends, for w = 1."""
        x = np.linspace(0.0, 1.0, 2001)
        r = np.tan(0.5 * kL)
        slope = kL * (1.0 - np.cos(kL * x) - r * np.sin(kL * x)) / (kL - 2.0 * r)
        return float(np.trapezoid(slope**2, x)) / L

    def excess(kL: float) -> float:
        N = EI * (kL / L) ** 2
        return N - EA * (h * w / L - 0.5 * w * w * bow(kL)) / L

    kL = brentq(excess, 1e-3, 6.2)
    N = EI * (kL / L) ** 2
    shear = -EI * (kL / L) ** 3 * w / (kL - 2.0 * np.tan(0.5 * kL))
    return float(2.0 * (N * h / L + shear))


def test_the_whole_path_of_williams_toggle(tmp_path: Path) -> None:
    from test_limit_points import TOGGLE

    text = TOGGLE.replace("steps: STEPS", "path: arc_length, steps: 10").replace("LOAD", "60")
    code, result, _ = ran(tmp_path, text)
    assert code == 0
    w = 0.386 - series(result, "rbdout.left_end.position.z")
    loads = 60.0 * series(result, "glstat.model.load_factor")
    # while the members are compressed, as the closed form has them
    inside = (w > 0.05) & (w < 0.6)
    assert inside.sum() > 20
    expected = np.array([toggle(x) for x in w[inside]])
    # shallow: squares of the slope, 1e-3; and four elements, a percent
    assert loads[inside] == pytest.approx(expected, abs=0.015 * 33.8)
    assert loads[-1] == pytest.approx(60.0, abs=1e-9)


@pytest.mark.long
def test_lees_frame_has_its_published_limit(tmp_path: Path) -> None:
    deck = ROOT / "decks/verification/parts/lee_frame.yaml"
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 0
    log = Result(tmp_path / "out").log
    factors = [re.findall(rf"{kind} of the load factor, (\S+);", log)[0] for kind in KINDS]
    # 1.85445 with shear; a parabola through three equilibria, and elements of 12, err by less
    assert 3.0 * float(factors[0]) == pytest.approx(1.85445, rel=5e-3)
    # about -0.95 in the figure of Schweizerhof and Wriggers (1986): from memory, not read again
    assert 3.0 * float(factors[1]) == pytest.approx(-0.95, rel=0.03)


def test_it_says_that_the_path_ends_at_its_length(tmp_path: Path) -> None:
    text = BARS.replace("LOAD", "20").replace("steps: 10", "steps: 10, path_length: 1")
    code, result, _ = ran(tmp_path, text)
    assert code == 0
    assert series(result, "glstat.model.load_factor")[-1] < 1.0
    assert "before it reached the loads of end_time" in result.log


def test_a_path_is_gone_on_with_after_a_dump(tmp_path: Path) -> None:
    text = BARS.replace("LOAD", "60") + "output: {restart: {every: 0.5}}\n"
    code, whole, _ = ran(tmp_path, text)
    assert code == 0
    z = series(whole, "rbdout.apex.position.z")
    code, again, _ = ran(tmp_path, text, "--restart")
    assert code == 0
    assert series(again, "rbdout.apex.position.z") == pytest.approx(z, abs=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("solution: quasi_static, ", "", "path: arc_length is for equilibria"),
        ("steps: 10", "steps: 10, path_length: 0.5", "path_length"),
        ("path: arc_length", "path: riks", "path"),
        (", extrapolate: linear", "", "outside its range 0 to 1; extend the curve"),
        (", curve: rise", "", "needs a load or a driver with a curve"),
    ],
)
def test_what_is_no_path_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(BARS.replace("LOAD", "60").replace(old, new), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode in (2, 4)
    assert re.search(message, done.stderr)


def test_hinges_and_shells_are_refused(tmp_path: Path) -> None:
    deck = ROOT / "decks/verification/parts/shell_static.yaml"
    done = crashsolve("check", deck, "--set", "control.path=arc_length")
    assert done.returncode == 2
    assert "does not follow parts of type shell" in done.stderr
