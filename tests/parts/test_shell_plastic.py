"""What layers that yield promise: the yield condition to round-off, known paths, energy kept."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from quick import first_quick
from shells import KINDS, ODD, SQUARE, Elements

from crashsolve.elements.shells import return_mapping
from crashsolve.elements.shells.plasticity import transverse_square
from crashsolve.elements.shells.records import (
    BLOCK,
    SLOT,
    WORK,
)
from crashsolve.elements.shells.return_mapping import NEAR, step_to_root
from crashsolve.foundation.curve import curve_line, curve_value, pack
from crashsolve.foundation.rows import Rows, as_rows
from crashsolve.materials._von_mises import LAYER

STRAIN = LAYER.plastic_strain
BASE = {"type": "elastoplastic", "young": 2e5, "poisson": 0.3, "density": 8.0}
Y, H = 200.0, 2000.0
MATERIALS = {
    "perfect": BASE | {"yield_stress": Y},
    "isotropic": BASE | {"yield_stress": Y, "hardening": H},
    "kinematic": BASE | {"yield_stress": Y, "hardening": H, "kinematic": 1.0},
    "mixed": BASE | {"yield_stress": Y, "hardening": H, "kinematic": 0.4},
    "rate": BASE | {"yield_stress": Y, "hardening": H, "rate_D": 40.0},
}
JC = BASE | {"type": "johnson_cook", "yield_stress": Y, "hardening": H, "exponent": 0.26}
# a plastic strain of about 10 % goes half the way to melting
JC |= {"rate": 0.014, "reference_rate": 1e-3, "melting_heat": 6.0, "softening": 1.03}
MATERIALS["johnson_cook"] = JC
MATERIALS["failing"] = MATERIALS["isotropic"] | {"failure_strain": 0.01}


def flow_stress(material: dict[str, Any], e: np.ndarray) -> np.ndarray:
    """Yield stress over plastic strain, without factors of rate and temperature."""
    share = 1.0 - material.get("kinematic", 0.0)
    return Y + share * material.get("hardening", 0.0) * e ** material.get("exponent", 1.0)


def rate_factor(material: dict[str, Any], rate: float) -> float:
    """Factor on it at a rate of the plastic strain."""
    if "rate_D" in material:
        return float(1.0 + (rate / material["rate_D"]) ** 0.2)
    if "rate" in material:
        return float(1.0 + material["rate"] * np.log(max(rate / material["reference_rate"], 1.0)))
    return 1.0


def size(xi: np.ndarray) -> np.ndarray:
    x, y, s = xi.T
    return np.sqrt(x * x + y * y - x * y + 3.0 * s * s)


def whole(shell: Elements, slot: int, xi: np.ndarray) -> float:
    """Von Mises' stress of the layer in a slot, with transverse shear and hourglass."""
    work = shell.scene.work
    left = 1.0 / (
        1.0 + shell.p.material.falls_2 * work.reshape(-1, 16)[SLOT.SIZE * slot + SLOT.g, 0]
    )
    zeta = shell.p.zeta[int(work.reshape(-1, 16)[WORK.yielding, slot])]
    transverse: Any = transverse_square
    return float(np.hypot(size(xi[None])[0], left * np.sqrt(transverse(work, 0, zeta))))


def stretched(strain: Any) -> np.ndarray:
    """Velocities of the unit square for strains xx, yy, xy of its plane."""
    x, y = np.array(SQUARE[0], float).T - 0.5
    motion = np.zeros((4, 6))
    motion[:, 0] = strain[0] * x + 0.5 * strain[2] * y
    motion[:, 1] = strain[1] * y + 0.5 * strain[2] * x
    return motion


@pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)
@pytest.mark.parametrize("kind", KINDS)
def test_yielding_layers_meet_the_yield_condition_to_round_off(
    tmp_path: Path, material: dict[str, object], kind: str
) -> None:
    rng = np.random.default_rng(1)
    shell = Elements(tmp_path, ODD, 0.1, material, layers=5, element=kind)
    yielded = 0
    for _ in range(6):
        before, motion = shell.layers()[-5:, STRAIN], 3e-3 * rng.normal(size=(4, 6))
        shell.move(motion, h=0.5)
        # layers that yield lie one behind the other, those of the point done last are still there
        rows = shell.layers()[-5:]
        grown = rows[:, STRAIN] - before
        for slot, (row, more) in enumerate(zip(rows[grown > 0.0], grown[grown > 0.0], strict=True)):
            factor = rate_factor(material, more / 0.5)
            if "exponent" in material:
                factor *= shell.scene.work.reshape(-1, 16)[SLOT.factor + SLOT.SIZE * slot, 0]
            alpha = row[LAYER.alpha :][:3] if "kinematic" in material else 0.0
            limit = factor * flow_stress(material, row[STRAIN : STRAIN + 1])[0]
            # 1e-14 for the root, as much for the stress that is put together from it
            assert whole(shell, slot, row[:3] - alpha) == pytest.approx(limit, rel=2e-14)
            yielded += 1
    assert yielded > 2


@pytest.mark.parametrize("kind", KINDS)
def test_transverse_shear_yields_with_the_layers(tmp_path: Path, kind: str) -> None:
    shell = Elements(tmp_path, SQUARE, 0.5, MATERIALS["perfect"], layers=3, element=kind)
    tilt, work, last = np.zeros((4, 6)), 0.0, np.zeros((4, 6))
    tilt[:, 3:] = 1e-3, 5e-4, 0.0
    for _ in range(60):
        force = shell.move(tilt)
        work -= 0.5 * (tilt * (force + last)).sum()
        last = force
    tau = np.linalg.norm(shell.rows(BLOCK.shear, 2), axis=1)
    # nothing else is strained, and all layers take the same part
    assert tau == pytest.approx(Y / np.sqrt(3.0), rel=1e-12)
    out = shell.energies()
    # tilting by 0.067 in all: as (1 - cos), the axes do not turn
    assert out.strain + out.hourglass + out.plastic == pytest.approx(work, rel=1e-9)
    assert out.plastic > 0.8 * work


def test_the_hourglass_yields_by_its_mean_square(tmp_path: Path) -> None:
    shell = Elements(tmp_path, SQUARE, 0.1, MATERIALS["perfect"], layers=3)
    direction = np.zeros((4, 6))
    direction[:, :2] = np.outer([1e-4, -1e-4, 1e-4, -1e-4], [3.0, 4.0])
    for _ in range(100):
        shell.move(direction)
    # of the unit square A int h_x^2 is 4/3, with the slopes h_x = 4 y of xi eta
    stress = shell.rows(BLOCK.hourglass_plane, 2)[0] / (0.1 * np.sqrt(4.0 / 3.0))
    assert np.linalg.norm(stress) == pytest.approx(Y, rel=1e-12)
    assert stress[1] / stress[0] == pytest.approx(4.0 / 3.0, rel=1e-12)
    # stretching it as well takes from both
    shell.move(direction + 1e-3 * stretched([1.0, 0.0, 0.0]))
    less = np.linalg.norm(shell.rows(BLOCK.hourglass_plane, 2)[0]) / (0.1 * np.sqrt(4.0 / 3.0))
    assert less < 0.9 * Y
    for slot, row in enumerate(shell.layers()):
        assert whole(shell, slot, row[:3]) == pytest.approx(Y, rel=2e-14)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("hardening", [0.0, 0.3])
def test_the_return_is_of_fourth_order_and_from_anywhere(poisson: float, hardening: float) -> None:
    """Young's modulus and yield stress 1: g is then of the size of what is beyond yield."""
    c1, c2 = 1.0 / (3.0 - 3.0 * poisson), 1.0 / (1.0 + poisson)
    root_step: Any = step_to_root
    for beyond in (1e-3, 0.03, 0.1, 1.0, 30.0, 1e4):
        for angle in np.linspace(0.01, 1.56, 9):
            parts = ((1.0 + beyond) * np.array([np.cos(angle), np.sin(angle)])) ** 2
            g, steps = 0.0, []
            while len(steps) < 20 and (not steps or steps[-1] > 1e-15):
                step = root_step(g, *parts, 1.0, hardening, c1, c2)
                g = max(0.5 * g, g + step)
                steps.append(c2 * abs(step) / (1.0 + c2 * g))
            size = np.hypot(*(np.sqrt(parts) / (1.0 + np.array([c1, c2]) * g)))
            # round-off of the factors, and of 1 - hardening g where that is small
            assert size * (1.0 - hardening * g) == pytest.approx(1.0, abs=1e-14 * size)
            # a step below NEAR is the last but for round-off of the same size
            near = next(k for k, step in enumerate(steps) if step < NEAR)
            assert max(steps[near + 1 :], default=0.0) < 1e-14 * size
            if beyond <= 0.1:
                assert near <= 1 + (poisson == 0.0)


@pytest.mark.parametrize("bend", [0.0, -30.0])
def test_the_line_of_a_curve_touches_it(bend: float) -> None:
    """Straight segments say where they end; what is bent holds nowhere but at the point."""
    coefficients = [[200.0, 5.0, bend, 0.0], [205.0 + bend, 2.0, bend, 0.0]]
    table, (first,) = pack([([0.0, 1.0, 3.0], coefficients, 1)])
    curves: Rows = as_rows(table)
    for x in (0.0, 0.4, 1.0, 2.9, 4.0):
        y, slope, _ = curve_value(curves, first, x)
        at_0, rise, end = curve_line(curves, first, x)
        assert (at_0 + rise * x, rise) == pytest.approx((y, slope), rel=1e-15)
        assert end == (1e300 if x > 3.0 else -1.0 if bend else 1.0 if x < 1.0 else 3.0)


@pytest.mark.parametrize("case", ["linear", "smooth"])
def test_layers_follow_a_curve_over_its_corners_to_round_off(tmp_path: Path, case: str) -> None:
    points = [[0.0, Y], [0.002, 230.0], [0.003, 260.0], [0.01, 280.0], [1.0, 300.0]]
    words = {"points": points, "interpolation": case}
    material = {k: v for k, v in BASE.items()} | {"curve": "flow"}
    shell = Elements(tmp_path, ODD, 0.1, material, layers=5, curves={"flow": words})
    rng, corners = np.random.default_rng(2), set()
    for _ in range(12):
        before = shell.layers()[:, STRAIN]
        shell.move(1.5e-3 * rng.normal(size=(4, 6)))
        rows, slot = shell.layers(), 0
        for row, old in zip(rows, before, strict=True):
            if row[STRAIN] > old:
                flow, _, _ = curve_value(
                    shell.scene.curves, int(shell.p.material.curve), row[STRAIN]
                )
                assert whole(shell, slot, row[:3]) == pytest.approx(flow, rel=2e-14)
                slot += 1
                corners |= {x for x, _ in points if old < x < row[STRAIN]}
    # in one step over two corners, too
    assert len(corners) >= 3


def test_a_step_may_go_over_more_lines_than_the_return_has_passes(tmp_path: Path) -> None:
    points = [[1e-5 * k, Y + k**0.5] for k in range(201)]
    words = {"points": points, "extrapolate": "hold"}
    material = {k: v for k, v in BASE.items()} | {"curve": "flow"}
    shell = Elements(tmp_path, SQUARE, 0.01, material, layers=1, curves={"flow": words})
    shell.move(stretched([0.0, 0.0, 4e-3]))
    row = shell.layers()[0]
    flow, _, _ = curve_value(shell.scene.curves, int(shell.p.material.curve), row[STRAIN])
    assert row[STRAIN] > 60e-5
    assert size(row[None, :3])[0] == pytest.approx(flow, rel=2e-14)


@pytest.mark.parametrize("name", ["isotropic", "kinematic", "mixed"])
def test_pull_and_push_follow_the_law_of_hardening(tmp_path: Path, name: str) -> None:
    """Uniaxial stress, the strain across found by Newton from outside."""
    material = MATERIALS[name]
    shell = Elements(tmp_path, SQUARE, 0.01, material, layers=1)
    beta, stress = material.get("kinematic", 0.0), []
    for direction in (1, -1):
        for _ in range(10):
            pull(shell, direction * 1e-3)
            stress.append(shell.layers()[0, 0])
    e = np.cumsum(np.repeat([1e-3, -1e-3], 10))
    slope = BASE["young"] * H / (BASE["young"] + H)
    top = Y + slope * (e[9] - Y / BASE["young"])
    # yields backwards after 2 Y, and twice what is isotropic
    back = top - 2.0 * (Y + (1.0 - beta) * H * (e[9] - top / BASE["young"]))
    elastic = e[9] - (top - back) / BASE["young"]
    end = back - slope * (elastic - e[19])
    # strains of 1 % shorten and lengthen the square: logarithmic strain within 1e-4 of the sum
    assert stress[9] == pytest.approx(top, rel=1e-4)
    assert stress[19] == pytest.approx(end, abs=1e-4 * Y + abs(end) * 1e-3)


def pull(shell: Elements, strain: float) -> None:
    """A step of strain along x with no stress along y."""
    start, rest, across = shell.points.copy(), shell.state.blocks.copy(), -0.3 * strain
    for _ in range(6):
        ends = []
        for other in (across, across + 1e-9):
            shell.points[:], shell.state.blocks[:] = start, rest
            square = shell.points.r[:, :2].max(axis=0) - shell.points.r[:, :2].min(axis=0)
            motion = stretched([strain * square[0], other * square[1], 0.0])
            shell.move(motion)
            ends.append(shell.layers()[0, 1])
        if abs(ends[0]) < 1e-9 * Y:
            break
        across -= ends[0] * 1e-9 / (ends[1] - ends[0])
    shell.points[:], shell.state.blocks[:] = start, rest
    square = shell.points.r[:, :2].max(axis=0) - shell.points.r[:, :2].min(axis=0)
    shell.move(stretched([strain * square[0], across * square[1], 0.0]))


def test_the_rate_lifts_the_yield_stress_as_cowper_and_symonds_say(tmp_path: Path) -> None:
    shell = Elements(tmp_path, SQUARE, 0.01, MATERIALS["rate"] | {"hardening": 0.0}, layers=1)
    # pure shear of 1 % in a millisecond: the equivalent rate is 10 / sqrt(3) per second
    for _ in range(2):
        before = shell.layers()[0, STRAIN]
        shell.move(stretched([0.0, 0.0, 10.0]), h=1e-3)
    rate = (shell.layers()[0, STRAIN] - before) / 1e-3
    # turned by 1 %: a ten thousandth of the strain
    assert rate == pytest.approx(10.0 / np.sqrt(3.0), rel=1e-2)
    factor = 1.0 + (rate / 40.0) ** 0.2
    assert size(shell.layers()[:, :3])[0] == pytest.approx(Y * factor, rel=1e-12)


@pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)
@pytest.mark.parametrize("kind", first_quick(KINDS))
def test_work_is_stored_or_plastic(tmp_path: Path, material: dict[str, object], kind: str) -> None:
    rng = np.random.default_rng(5)
    shell = Elements(tmp_path, ODD, 0.1, material, layers=4, element=kind)
    direction, work, last = rng.normal(size=(4, 6)), 0.0, np.zeros((4, 6))
    for _ in range(50):
        force = shell.move(6e-5 * direction)
        work -= 0.5 * 6e-5 * (direction * (force + last)).sum()
        last = force
    out = shell.energies()
    assert out.plastic > 0.1 * work
    # strains of 3e-3 in a law of rates: a few times that of what is stored
    assert out.strain + out.hourglass + out.drilling + out.plastic + out.eroded == pytest.approx(
        work, rel=5e-3
    )


def test_plastic_stretch_keeps_the_volume(tmp_path: Path) -> None:
    material = BASE | {"yield_stress": 1.0}
    shell = Elements(tmp_path, SQUARE, 0.01, material, layers=2, thinning=True)
    for _ in range(50):
        shell.move(stretched([1e-2, 2e-3, 5e-3]))
    a, b, c = shell.points.r[1] - shell.points.r[0], shell.points.r[3] - shell.points.r[0], 0
    area = np.linalg.norm(np.cross(a, b)) + c
    # elastic strains are 5e-6; each of the 50 steps errs by a third of its strain squared, 5e-5
    assert area * shell.rows(BLOCK.thickness, 1)[0, 0] == pytest.approx(0.01, rel=3e-3)


def test_johnson_and_cook_follow_their_formula_at_one_rate(tmp_path: Path) -> None:
    material = JC | {"melting_heat": 600.0, "heat_share": 0.5}
    shell = Elements(tmp_path, SQUARE, 0.01, material, layers=1)
    # pure shear: the equivalent strain is gamma / sqrt(3)
    gamma, h, heat = 2e-3, 1e-4, 0.0
    for _ in range(60):
        before = shell.layers()[0]
        shell.move(stretched([0.0, 0.0, gamma / h]), h=h)
        e = shell.layers()[0, STRAIN]
        softer = 1.0 - max(heat, 0.0) ** 1.03
        rate = rate_factor(material, (e - before[STRAIN]) / h)
        flow = (Y + H * e**0.26) * rate * softer
        # at the end the sides are 0.7 % longer, and 0.014 of that is in the factor of rate
        assert size(shell.layers()[:, :3])[0] == pytest.approx(flow, rel=2e-4)
        work = 0.5 * (size(before[None, :3])[0] + flow) * (e - before[STRAIN])
        heat += 0.5 * work / (8.0 * 600.0)
    assert e == pytest.approx(60 * gamma / np.sqrt(3.0), rel=0.2)
    assert heat > 0.005


@pytest.mark.parametrize("material", [MATERIALS["rate"], JC | {"melting_heat": 600.0}])
def test_a_layer_that_strains_on_is_returned_by_few_evaluations(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, material: dict[str, Any]
) -> None:
    counts, evaluate = [0], return_mapping.evaluate_tangents

    def counted(*given: Any) -> None:
        counts[0] += 1
        evaluate(*given)

    monkeypatch.setattr(return_mapping, "evaluate_tangents", counted)
    shell = Elements(tmp_path, SQUARE, 0.01, material, layers=1)
    for _ in range(40):
        counts[0] = 0
        shell.move(stretched([0.0, 0.0, 2e-3 / 1e-4]), h=1e-4)
    # one beside the root, one whose correction leaves round-off; from any start it takes four
    assert counts[0] == 2


@pytest.mark.parametrize("kind", KINDS)
def test_an_element_that_has_failed_is_gone_and_its_energy_reported(
    tmp_path: Path, kind: str
) -> None:
    shell = Elements(tmp_path, SQUARE, 0.01, MATERIALS["failing"], layers=3, element=kind)
    work, last = 0.0, np.zeros((4, 6))
    motion = stretched([3e-4, -1.2e-4, 9e-5])
    # bent as well: the layers fail one after another
    motion[:, 4] = 3e-3 * (np.array(SQUARE[0])[:, 0] - 0.5)
    for step in range(80):
        force = shell.move(motion)
        work -= 0.5 * (motion * (force + last)).sum()
        last = force
        out = shell.energies()
        if step == 30:
            assert out.eroded == 0.0
    count = int(shell.p.element_count)
    assert out.deleted == count
    assert out.eroded_mass == pytest.approx(8.0 * 0.01, rel=1e-12)
    # the mass stays with the nodes
    assert (1.0 / shell.points.mass_inv).sum() == pytest.approx(8.0 * 0.01, rel=1e-12)
    assert np.abs(force).max() == 0.0
    assert out.strain + out.hourglass + out.drilling == 0.0
    assert 0.0 < out.eroded < 0.1 * out.plastic
    # half of the step in which a layer fails: 1.5e-4 of a strain of 1.2e-2
    assert out.plastic + out.eroded == pytest.approx(work, rel=1.6e-2)
