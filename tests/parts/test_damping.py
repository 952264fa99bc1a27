"""Claims of damping, viscosity and mass scaling: power, momentum, steps, and clear refusals."""

from pathlib import Path

import numpy as np
import pytest
from bench import ONE_BEAM, Bench, Law
from shells import SQUARE, Elements

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.model import Model, State
from crashsolve.system.diagnosis import limiter

DECK = ONE_BEAM.replace("end_time: 1", "end_time: 1, safety: 0.5")
VISCOUS = "viscosity: {linear: 0.2, quadratic: 1.1}"
AXIS = np.array([1.0, 1.0, -0.3])
LENGTH = float(np.linalg.norm(AXIS))


def element(folder: Path, words: str) -> Law:
    return Bench(folder, "", DECK.replace("WORDS", words)).law("parts", "s_1")


@pytest.mark.parametrize("words", ["drag: 3", VISCOUS, f"{VISCOUS}\n    drag: 2\n    damping: 0.1"])
@pytest.mark.parametrize("seed", range(3))
def test_power_on_the_nodes_is_the_decrease_of_stored_energy(
    tmp_path: Path, words: str, seed: int
) -> None:
    law = element(tmp_path, words)
    law.bench.shake(seed, 1.0, 0.5)
    out = law.force()
    given, lost = law.power_on_bodies(), float(out.power)
    assert lost > 0.0
    # differences over 1e-5 s: h^2 times third derivatives over first
    assert given == pytest.approx(-law.growth(1e-5) - lost, rel=1e-8)


def test_drag_takes_momentum_in_proportion_and_as_an_outside_force(tmp_path: Path) -> None:
    law = element(tmp_path, "drag: 3")
    law.bench.shake(0, 1.0, 0.0)
    n = law.bench.nodes
    law.force()
    dragged = np.hstack([n.force[1:], n.torque[1:]])
    bare = element(tmp_path, "drag: 0")
    bare.bench.nodes[:] = n
    bare.force()
    m = bare.bench.nodes
    taken = dragged - np.hstack([m.force[1:], m.torque[1:]])
    A = n.A[1:].reshape(2, 3, 3)
    spin = np.einsum("nij,njk,nlk,nl->ni", A, n.J[1:].reshape(2, 3, 3), A, n.w[1:])
    wanted = -3.0 * np.hstack([n.v[1:] / n.mass_inv[1:, None], spin])
    np.testing.assert_allclose(taken, wanted, atol=1e-12 * np.abs(dragged).max())
    np.testing.assert_allclose(n.external[0][:3], wanted[:, :3].sum(0), rtol=1e-12)


@pytest.mark.parametrize("speed", [-2.0, 2.0])
def test_viscosity_is_the_impedance_of_the_bar_and_more_in_compression(
    tmp_path: Path, speed: float
) -> None:
    law = element(tmp_path, VISCOUS)
    law.bench.move(2, v=speed * AXIS / LENGTH)
    tension = float(law.force().force[0])
    c, per_length = np.sqrt(2000 / 3), 3 * 0.5 * 0.8
    quick = 1.1**2 * 2.0 if speed < 0.0 else 0.0
    assert tension == pytest.approx(per_length * (0.2 * c + quick) * speed, rel=1e-12)
    # a rigid motion is not resisted
    for node in (1, 2):
        law.bench.move(node, v=[1, 2, 3], w=[0, 0, 0])
    assert float(law.force().force[0]) == pytest.approx(0.0, abs=1e-10)


def rates(folder: Path, words: str) -> tuple[Model, State]:
    path = folder / "deck.yaml"
    path.write_text(DECK.replace("WORDS", words).replace("elements: 1", "elements: 4"), "utf-8")
    return build(read_deck(path))


def test_mass_scaling_reaches_its_step_and_states_what_it_added(tmp_path: Path) -> None:
    model, state = rates(tmp_path, "damping: 0")
    p, wanted = model.groups[0].parameters, 0.01
    fastest = np.sqrt(2.0 * (p["rate_b"][0] + p["rate_a"][1]))
    assert 2.0 * 0.5 / fastest < wanted
    scaled, heavy = rates(tmp_path, f"mass_scaling: {{step: {wanted}, limit: 9}}")
    p = scaled.groups[0].parameters
    fastest = np.sqrt(2.0 * (p["rate_b"][0] + p["rate_a"][1]))
    assert 2.0 * 0.5 / fastest == pytest.approx(wanted, rel=1e-12)
    added = scaled.total_mass() - model.total_mass()
    (reported,) = scaled.warnings
    assert f"part 's': mass scaling adds {added:.4g} kg" in reported
    assert "to 4 of 4 elements" in reported
    before, after = (s.nodes["J"][1][[0, 4, 8]] * s.nodes["mass_inv"][1] for s in (state, heavy))
    np.testing.assert_allclose(after, before, rtol=1e-12)


def test_more_mass_than_allowed_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors, match=r"mass_scaling: adds .*but limit is 5 %"):
        rates(tmp_path, "mass_scaling: {step: 0.01}")


def test_viscosity_is_for_explicit_integrators(tmp_path: Path) -> None:
    path = tmp_path / "deck.yaml"
    text = DECK.replace("WORDS", VISCOUS).replace("safety", "integrator: radau_iia_5, safety")
    path.write_text(text, "utf-8")
    with pytest.raises(DeckErrors, match="viscosity: smooths fronts in explicit steps"):
        build(read_deck(path))


def test_the_node_that_sets_the_step_is_reported_with_its_element(tmp_path: Path) -> None:
    model, _ = rates(tmp_path, "damping: 0")
    assert limiter(model, 2) in ("s_1, node s_1", "s_2, node s_1")
    assert limiter(model, 0) == ""


ELEMENTS = pytest.mark.parametrize("element", ["reduced", "fully_integrated", "triangles"])


def any_motion(shell: Elements, size: float) -> np.ndarray:
    return size * np.random.default_rng(5).normal(size=(len(shell.points), 6))


@ELEMENTS
def test_damping_of_shells_takes_the_work_of_its_forces(element: str, tmp_path: Path) -> None:
    words = {"damping": 0.02, "viscosity": {"linear": 0.1, "quadratic": 1.0}}
    damped = Elements(tmp_path, SQUARE, element=element, **words)
    bare = Elements(tmp_path, SQUARE, element=element)
    work = np.zeros(2)
    for step in range(4):
        direction = (-1) ** step * any_motion(damped, 1e-6)
        for k, shell in enumerate((damped, bare)):
            force = shell.move(direction / 1e-3, 1e-3)
            # nodes feel the mean of the forces before and after the step
            before = getattr(shell, "last", np.zeros_like(force))
            work[k] -= 0.5 * float(((before + force) * direction).sum())
            shell.last = force
    taken = float(damped.energies().damping)
    assert taken > 0.0
    # the geometry of 1e-6: forces of one stress turn with it
    assert work[0] - work[1] == pytest.approx(taken, rel=1e-4)


def test_a_rigid_motion_of_shells_is_not_damped(tmp_path: Path) -> None:
    shell = Elements(tmp_path, SQUARE, damping=0.02, viscosity={})
    shell.rotation(np.array([0.1, -0.2, 0.3]), np.array([3.0, 1.0, 2.0]), np.array([1.0, 2.0, 0.0]))
    assert abs(float(shell.energies().damping)) < 1e-20


@ELEMENTS
def test_mass_scaling_of_shells_holds_the_bound_of_the_step(element: str, tmp_path: Path) -> None:
    bare, wanted = Elements(tmp_path, SQUARE, element=element), 1e-3
    bare.move(np.zeros((4, 6)))
    free = float(bare.clock.element_rate)
    # safety is 0.1: the step is 0.2 over the frequency
    assert 0.2 / np.sqrt(free) < wanted
    heavy = Elements(tmp_path, SQUARE, element=element, mass_scaling={"step": wanted, "limit": 99})
    heavy.move(np.zeros((4, 6)))
    reported = float(heavy.clock.element_rate)
    assert 0.2 / np.sqrt(reported) == pytest.approx(wanted, rel=1e-12)
    ratio = bare.points.mass_inv / heavy.points.mass_inv
    # a corner of the worst element alone has its factor
    assert ratio.max() == pytest.approx(free / reported, rel=1e-12)
    assert ratio.min() > 1.0


@ELEMENTS
def test_damping_shortens_the_step_of_shells(element: str, tmp_path: Path) -> None:
    bare = Elements(tmp_path, SQUARE, element=element)
    damped = Elements(tmp_path, SQUARE, element=element, damping=0.01)
    for shell in (bare, damped):
        shell.move(np.zeros((4, 6)))
    omega, reported = (np.sqrt(float(s.clock.element_rate)) for s in (bare, damped))
    xi = 0.005 * omega
    assert reported == pytest.approx(omega * (xi + np.sqrt(1.0 + xi * xi)), rel=1e-12)
