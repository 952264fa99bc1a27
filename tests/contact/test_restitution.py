"""What each law returns from a free impact, against the exact relation and published figures."""

from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from quick import first_quick
from small_runs import last
from touching import Contact, pressed_apart

from crashpost.cli import main as crashpost
from crashpost.results.result import Result
from crashsolve.contact.normal._restitution import damping_factor, returned
from crashsolve.contact.normal.kelvin_voigt import damping_ratio

# restitution returned for 0.1, 0.2, ... 0.9, 0.95 asked: roots of (E1), four digits
ASKED = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
RETURNED = {
    "lankarani_nikravesh": "6653 6723 6842 7016 7252 7561 7960 8471 9132 9535",
    "hunt_crossley": "5158 5469 5813 6197 6630 7120 7680 8329 9090 9524",
    "herbert_mcwhannell": "4907 5008 5200 5503 5936 6511 7227 8070 9009 9501",
    "lee_wang": "6867 7120 7390 7680 7992 8329 8693 9090 9524 9756",
    "gonthier": "1010 2046 3042 3978 4877 5773 6696 7680 8764 9359",
    "flores": "0694 1555 2562 3629 4704 5773 6832 7885 8939 9468",
    "hu_guo": "0741 1656 2707 3796 4877 5936 6973 7992 8999 9500",
    "zhiying_qishao": "2175 2664 3267 3988 4826 5769 6796 7874 8959 9489",
    "exact_restitution": "1000 2000 3000 4000 5000 6000 7000 8000 9000 9500",
}
# chi that returns e exactly, ten digits
EXACT = {0.1: 9.9981593975, 0.3: 3.0870819811, 0.5: 1.4327505333, 0.9: 0.1664819507}


@pytest.mark.parametrize("law", RETURNED)
def test_a_law_returns_the_restitution_of_the_exact_relation(tmp_path: Path, law: str) -> None:
    for requested, digits in zip(ASKED, RETURNED[law].split(), strict=True):
        contact = Contact(tmp_path, f"{{type: {law}, stiffness: 1e9, restitution: {requested}}}")
        # half a unit of the last digit quoted
        assert returned(float(contact.p.chi)) == pytest.approx(float(f"0.{digits}"), abs=5.1e-5)


@pytest.mark.parametrize("e", EXACT)
def test_the_exact_damping_factor_is_the_published_one(e: float) -> None:
    assert damping_factor(e) == pytest.approx(EXACT[e], abs=1e-10)
    assert returned(damping_factor(e)) == pytest.approx(e, abs=1e-12)


def test_no_damping_returns_everything() -> None:
    assert (returned(0.0), damping_factor(1.0), damping_ratio(1.0)) == (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "law",
    [
        "{type: hertz, stiffness: 1e6}",
        "{type: lankarani_nikravesh, stiffness: 1e6, restitution: 0.5}",
        "{type: hunt_crossley, stiffness: 1e5, exponent: 1, restitution: 0.3}",
        "{type: exact_restitution, stiffness: 1e6, restitution: 0.2}",
        "{type: exact_restitution, stiffness: 1e8, exponent: 2.5, restitution: 0.8}",
        "{type: layered, stiffness: 1e5, restitution: 0.3, layer: 0.01, core_stiffness: 1e7}",
        "{type: layered, stiffness: 1e7, restitution: 0.3, layer: 0.01, core_stiffness: 1e5}",
    ],
)
def test_an_impact_step_by_step_obeys_the_exact_relation(tmp_path: Path, law: str) -> None:
    contact = Contact(tmp_path, law)
    chi = float(contact.p.chi)
    v_out, _ = pressed_apart(contact, 0.0, 2.0, 1e-5, mass=3.0)
    # second order: about 1000 steps in a contact
    assert v_out == pytest.approx(2.0 * returned(chi), rel=2e-5)


@pytest.mark.parametrize("e", (0.05, 0.1353352832366127, 0.5, 0.9))
@pytest.mark.parametrize("mass", (0.5, 3.0))
def test_spring_and_damper_have_the_stated_restitution(
    tmp_path: Path, e: float, mass: float
) -> None:
    contact = Contact(tmp_path, f"{{type: kelvin_voigt, stiffness: 1e4, restitution: {e}}}")
    v_out, lost = pressed_apart(contact, 0.0, 2.0, 5e-6 * sqrt(mass), mass)
    # second order, over 2000 steps in a contact
    assert v_out == pytest.approx(2.0 * e, abs=2e-5)
    assert lost == pytest.approx(2.0 * mass * (1.0 - e * e), rel=5e-5)


@pytest.mark.parametrize("law", RETURNED)
def test_a_law_with_another_restitution_warns(tmp_path: Path, law: str) -> None:
    contact = Contact(tmp_path, f"{{type: {law}, stiffness: 1e9, restitution: 0.3}}")
    x = returned(float(contact.p.chi))
    expected = (
        f"contact 'hit': {law} with restitution 0.3 gives a restitution of {x:.3f} "
        "in a free impact; type: exact_restitution gives the one asked for"
    )
    assert contact.model.warnings == ([] if abs(x - 0.3) <= 0.006 else [expected])
    assert bool(contact.model.warnings) == (law not in ("exact_restitution", "gonthier"))


def test_impacts_beyond_the_range_are_flagged_and_remembered(tmp_path: Path) -> None:
    # sqrt(E/rho) = 100 m/s: the range ends at 1 mm/s
    law = "{type: hertz, young_a: 1e7, poisson_a: 0.3, density_a: 1000, radius: 0.1}"
    contact = Contact(tmp_path, law)
    assert float(contact.p.speed_limit) == pytest.approx(1e-3, rel=1e-12)
    for speed, flag in ((0.9e-3, 0), (1.1e-3, 1), (0.9e-3, 1)):
        contact.p.speed_floor = 1e-6
        contact.press(1e-9, speed)
        assert contact.new.too_fast == flag
        contact.accept()
        contact.release(contact.group.normal)
        assert contact.new.too_fast == flag
        contact.accept()


def test_without_a_density_the_range_is_unknown(tmp_path: Path) -> None:
    assert np.isinf(Contact(tmp_path, "{type: hertz, stiffness: 1e6}").p.speed_limit)


FLAT = """
title: a box falls on its face, or nearly
control: {{end_time: 2.0e-3, estimate: "off"}}
bodies:
  a:
    mass: 1
    primitive: {{shape: box, size: [0.4, 0.2, 0.1]}}
    position: [0, 0, 0.0502]
    rotation: {{axis: [0, 1, 0], angle: {tilt}}}
    velocity: [0, 0, -1]
surfaces: {{a: {{type: box, body: a, size: [0.4, 0.2, 0.1]}}, f: {{type: plane}}}}
contacts:
  c: {{a: [a], b: [f], normal: {{type: kelvin_voigt, stiffness: 1.0e8, restitution: {e}}}}}
"""


@pytest.mark.parametrize(("e", "tilt"), [(0.5, 0.0), (0.2, 1e-9), (0.5, 1e-7), (0.8, 1e-6)])
def test_all_corners_share_the_damping(e: float, tilt: float, tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(FLAT.format(e=e, tilt=f"{tilt:.1e}"), "utf-8")
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    # 2e-4 by a step of the default length; 300 times the tilt by corners that begin one by one
    assert last(Result(tmp_path / "out"), "rbdout.a.velocity.z") == pytest.approx(
        e, abs=3e-4 + 300.0 * tilt
    )


@pytest.mark.parametrize("tilt", [1e-12, 1e-9, 1e-6, 1e-4])
def test_corners_that_strike_one_soon_after_the_other_strike_at_once(
    tilt: float, tmp_path: Path
) -> None:
    text = FLAT.format(e=0.4, tilt=f"{tilt:.1e}").replace("[0, 1, 0], angle", "[1, 0.7, 0], angle")
    # four corners, one by one, in steps of a hundredth of the impact
    text = text.replace("1.0e8", "1.0e6").replace('"off"', '"off", step: 2.0e-5')
    deck = tmp_path / "deck.yaml"
    deck.write_text(text.replace("2.0e-3", "8.0e-3"), "utf-8")
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    result = Result(tmp_path / "out")
    # depths of corners differ by 0.24 of the tilt [m], 2400 tilts of what counts as at once, and
    # damping one by one changes the restitution by a twentieth
    assert last(result, "rbdout.a.velocity.z") == pytest.approx(0.4, abs=3e-4 + 120.0 * tilt)
    spins = [last(result, f"rbdout.a.angular_velocity.{axis}") for axis in "xy"]
    assert max(np.abs(spins)) < 1e-6 + 1e3 * tilt


@pytest.mark.parametrize("speed", [1e-4, 5e-6])
def test_a_slow_impact_after_a_long_flight_has_its_restitution(
    speed: float, tmp_path: Path
) -> None:
    text = FLAT.format(e=0.5, tilt=0.0).replace("0.0502", "0.15").replace("-1]", f"{-speed:.1e}]")
    deck = tmp_path / "deck.yaml"
    deck.write_text(text.replace("2.0e-3", f"{0.2 / speed:.1e}"), "utf-8")
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    # 2e-4 by a step of the default length; with an onset within 1e-9 of the model, 1e-2 at 5e-6 m/s
    assert last(Result(tmp_path / "out"), "rbdout.a.velocity.z") == pytest.approx(
        0.5 * speed, abs=3e-4 * speed
    )


WHOLE = Path(__file__).resolve().parents[2] / "decks/verification/contact/kelvin_voigt_whole.yaml"


@pytest.mark.parametrize("e", first_quick((0.2, 0.9)))
def test_joints_and_edges_are_part_of_the_mass(e: float, tmp_path: Path) -> None:
    done = crashsolve(WHOLE, "-o", tmp_path, "--set", f"e={e}", "--set", "control.estimate=off")
    assert done.returncode == 0, done.stdout
    assert crashpost(["expect", str(tmp_path)]) == 0
