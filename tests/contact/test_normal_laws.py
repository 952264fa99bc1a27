"""What every normal force law promises: it pushes, keeps its energy account, bounds its slope."""

from pathlib import Path

import numpy as np
import pytest
from bench import written
from touching import Contact

from crashsolve.deck.laws import types_in

DAMPED = "stiffness: 1e6, restitution: 0.4"
LAWS = {
    "hertz": "stiffness: 1e6",
    "lankarani_nikravesh": DAMPED,
    "hunt_crossley": DAMPED,
    "herbert_mcwhannell": DAMPED,
    "lee_wang": DAMPED,
    "gonthier": DAMPED,
    "flores": DAMPED,
    "hu_guo": DAMPED,
    "zhiying_qishao": DAMPED,
    "exact_restitution": DAMPED,
    "layered": f"{DAMPED}, layer: 0.005, core_stiffness: 1e7",
    "kelvin_voigt": "stiffness: 1e5, damping: 40",
    "penalty": "stiffness: 1e5",
    "crush_curve": "curve: stiff, unloading_stiffness: 2e5, damping: 30",
    "padding": "curve: stiff, unloading_curve: soft, unloading_stiffness: 2e5, damping: 30",
}


@pytest.fixture(params=LAWS)
def contact(request: pytest.FixtureRequest, tmp_path: Path) -> Contact:
    return Contact(tmp_path, f"{{type: {request.param}, {LAWS[request.param]}}}")


def test_every_law_is_under_this_contract() -> None:
    assert set(types_in("contact/normal")) == set(LAWS)


def test_a_contact_never_pulls(contact: Contact) -> None:
    rng = np.random.default_rng(1)
    for _ in range(200):
        contact.old.active = int(rng.integers(2))
        contact.old.impact_speed = rng.uniform(0.1, 2.0)
        out = contact.press(rng.uniform(0.0, 0.05), rng.uniform(-6.0, 6.0), h=1e-4)
        assert out.force >= 0.0
        assert out.stored >= 0.0
        assert out.loss >= 0.0


def test_every_column_is_written_and_the_past_is_kept(contact: Contact) -> None:
    law = contact.group.normal
    before = contact.old.tobytes()
    contact.press(0.01, 0.5, h=1e-3)
    assert written(contact.new, law.HISTORY)
    contact.release(law)
    assert written(contact.new, law.HISTORY)
    assert contact.old.tobytes() == before


def test_work_taken_is_stored_or_lost(contact: Contact) -> None:
    """A stroke of several reversals, which stays in contact."""
    work, lost = 0.0, 0.0
    times = np.linspace(0.0, 1.0, 8001)
    h = times[1]
    depths = 0.02 * np.sin(np.pi * times / 2) * (1.0 + 0.6 * np.sin(14.0 * times))
    rates = np.gradient(depths, h, edge_order=2)
    first = before = contact.press(float(depths[1]), float(rates[1]))
    contact.accept()
    for depth, rate, rate_before in zip(depths[2:], rates[2:], rates[1:], strict=False):
        now = contact.press(float(depth), float(rate), h)
        contact.accept()
        work += 0.5 * h * (before.force * rate_before + now.force * rate)
        lost += 0.5 * h * (before.power + now.power) + now.loss
        before = now
    # both sides are sums of second order over 8000 steps; corners of a curve cost h each
    assert work == pytest.approx(before.stored - first.stored + lost, rel=2e-5)
    assert lost >= 0.0
    assert abs(work) > 1.0


def test_a_sample_dissipates_no_energy(contact: Contact) -> None:
    contact.press(0.01, 0.5, h=1e-3)
    contact.accept()
    assert contact.press(0.01, 0.5, h=0.0).loss == 0.0


def test_stiffness_and_damping_bound_the_slopes_of_a_free_impact(contact: Contact) -> None:
    x, v, h, mass = 0.0, 1.5, 2e-5, 2.0
    contact.press(1e-9, v, mass=mass)
    contact.accept()
    while (x := x + h * v) > 0.0:
        now = contact.press(x, v, h, mass)
        # differences over a millionth: the slope changes by as much, and forces round off at 1e-15
        dx, dv = 1e-6 * max(x, 1e-4), 1e-6
        slope = (contact.press(x + dx, v, h, mass).force - now.force) / dx
        rise = (contact.press(x, v + dv, h, mass).force - now.force) / dv
        assert slope <= now.stiffness * (1.0 + 1e-5) + 1e-14 * now.force / dx
        assert rise <= now.damping * (1.0 + 1e-5) + 1e-14 * now.force / dv
        contact.press(x, v, h, mass)
        contact.accept()
        v -= h * now.force / mass


@pytest.fixture
def crush(tmp_path: Path) -> Contact:
    return Contact(tmp_path, "{type: crush_curve, curve: stiff, unloading_stiffness: 2e5}")


# area under the curve to 10, 25 and 50 mm by hand, and the force there
CRUSHED = {
    0.01: (0.5 * 0.01 * 1000, 1000.0),
    0.025: (20.0 + 0.5 * 0.005 * (2000 + 1750), 1750.0),
    0.05: (
        20.0 + 17.5 + 0.5 * 0.02 * (1500 + 1500 + 2500 / 0.97 * 0.02),
        1500 + 2500 / 0.97 * 0.02,
    ),
}


@pytest.mark.parametrize("depth", CRUSHED)
@pytest.mark.parametrize("steps", (1, 7, 1000))
def test_crushing_costs_the_same_in_any_number_of_steps(
    crush: Contact, depth: float, steps: int
) -> None:
    area, force = CRUSHED[depth]
    lost = 0.0
    for k in range(steps):
        out = crush.press(depth * (k + 1) / steps, 1.0, h=1.0)
        crush.accept()
        lost += out.loss
    # sums of up to 1000 exact terms
    assert out.force == pytest.approx(force, rel=1e-12)
    assert out.stored == pytest.approx(force**2 / 4e5, rel=1e-12)
    assert lost == pytest.approx(area - force**2 / 4e5, rel=1e-12)


def test_a_crushed_end_unloads_and_reloads_along_one_line(
    crush: Contact,
) -> None:
    crush.press(0.05, 1.0)
    crush.accept()
    force = CRUSHED[0.05][1]
    residual = 0.05 - force / 2e5
    for depth in (0.049, 0.046, 0.0445, 0.047, 0.0499):
        out = crush.press(depth, 0.0, h=1.0)
        crush.accept()
        assert out.force == pytest.approx(2e5 * (depth - residual), rel=1e-12)
        assert out.loss == 0.0
    crush.release(crush.group.normal)
    crush.accept()
    assert crush.press(residual - 1e-6, 1.0).force == 0.0
    assert crush.press(0.06, 1.0).force == pytest.approx(1500 + 2500 / 0.97 * 0.03, rel=1e-12)


@pytest.fixture
def padding(tmp_path: Path) -> Contact:
    words = "curve: stiff, unloading_curve: soft, unloading_stiffness: 2e5"
    return Contact(tmp_path, f"{{type: padding, {words}}}")


@pytest.mark.parametrize("steps", (1, 7, 1000))
def test_a_stroke_into_padding_and_back_loses_the_area_between_its_curves(
    padding: Contact, steps: int
) -> None:
    area, force = CRUSHED[0.05]
    lost = 0.0
    path = np.concatenate([np.linspace(0, 0.05, steps + 1)[1:], np.linspace(0.05, 0, 1001)[1:]])
    for depth, before in zip(path, [0.0, *path[:-1]], strict=True):
        out = padding.press(float(depth), 1.0 if depth > before else -1.0, h=1.0)
        padding.accept()
        lost += out.loss
    # from the crest a line of slope k falls to the lower curve, 400 + 100 / 0.98 (x - 0.02)
    s = 0.05 - force / 2e5
    x = (2e5 * s + 400 - 100 / 0.98 * 0.02) / (2e5 - 100 / 0.98)
    low = 2e5 * (x - s)
    back = 0.5 * (force + low) * (0.05 - x) + 0.5 * (400 + low) * (x - 0.02) + 4.0
    # sums of up to 1000 exact terms
    assert lost == pytest.approx(area - back, rel=1e-11)
    assert out.force == 0.0 and abs(out.stored) < 1e-12
    # as new
    assert padding.press(0.01, 1.0, h=1.0).force == pytest.approx(1000.0)
