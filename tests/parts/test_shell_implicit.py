"""What shells promise to implicit integrators: their tangent, order 2, energy, the same answer."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml
from bench import exponential, plain, product
from command import crashsolve
from shells import PATCH, SQUARE, STEEL

from crashpost.result import Result
from crashsolve.deck.read import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.posture import matrix
from crashsolve.model.build import build
from crashsolve.model.compliance import compliance
from crashsolve.system import points, stiffness

YIELDING = STEEL | {"type": "elastoplastic", "yield_stress": 200.0, "hardening": 2e4}
# element, mesh, material: all that has a tangent of its own
CASES = {
    "reduced": ("reduced", PATCH, STEEL),
    "reduced, yielding": ("reduced", SQUARE, YIELDING),
    "fully integrated, yielding": ("fully_integrated", SQUARE, YIELDING),
    "triangles, yielding": ("triangles", SQUARE, YIELDING),
}
H = 0.01


class Implicit:
    """Elements with their points on bodies, in the middle of a step of H."""

    def __init__(self, folder: Path, element: str, mesh: Any, material: dict[str, Any]) -> None:
        nodes = [[*node, 0.0] for node in mesh[0]]
        part = {"type": "shell", "thickness": 0.05, "material": "steel", "element": element}
        part |= {"layers": 3, "mesh": {"type": "listed", "nodes": nodes, "quads": mesh[1]}}
        control = {"end_time": 1, "integrator": "generalized_alpha"}
        deck = {"control": control, "materials": {"steel": material}, "parts": {"s": part}}
        path = folder / "elements.yaml"
        path.write_text(yaml.safe_dump(deck), "utf-8")
        self.model, state = build(read_deck(path))
        self.nodes: Any = state.nodes.view(np.recarray)
        e, tables = self.model.elements, compliance(self.model, state, 1)
        assert e is not None
        arrays = tables | {"points": state.points, "control": self.model.control}
        arrays |= {"curves": self.model.curves}
        views = {k: a.view(np.recarray) if a.dtype.names else a for k, a in arrays.items()}
        self.scene = SimpleNamespace(
            **views, lanes=state.blocks, corners=e.corners, work=e.work, riders=e.riders
        )
        self.riders: Any = e.riders.view(np.recarray)
        self.clock: Any = state.clock.view(np.recarray)[0]
        group = self.model.element_groups()[0]
        self.p = group.parameters.view(np.recarray)[0]
        words = [word for column, word in group.module.KINDS.items() if self.p[column]]
        self.kinds = [__import__(f"crashsolve.parts.{word}", fromlist=["deform"]) for word in words]
        for b in self.nodes[1:]:
            b.start_r, b.start_q, b.start_A = b.r, b.q, b.A

    def place(self, motion: np.ndarray) -> None:
        """All bodies moved and turned (n, 6) from where they are."""
        for b, way in zip(self.nodes[1:], motion, strict=True):
            b.r = b.r + way[:3]
            b.q = product(exponential(way[3:]), b.q)
            b.A = matrix(b.q).ravel()

    def carry(self) -> None:
        plain(points.carry)(H, self.nodes, self.scene.points, self.riders)

    def elements(self) -> None:
        """As composed: forces on the points, from what the elements kept."""
        plain(stiffness.begin_again)(H, self.clock, self.scene)
        for kind in self.kinds:
            plain(kind.deform)(self.p, self.clock, H, self.scene)

    def force(self) -> np.ndarray:
        """Forces and torques (n, 6) of the elements where the bodies are."""
        self.carry()
        plain(stiffness.clear_points)(self.scene)
        self.elements()
        both = np.hstack([self.scene.points.force, self.scene.points.torque])
        return both[self.scene_points()].copy()

    def scene_points(self) -> np.ndarray:
        """The point of each body."""
        return np.argsort(self.riders.node)

    def stiffness(self) -> np.ndarray:
        """K (6 n, 6 n) as the composed step finds it."""
        s, blocks = self.scene, self.scene.blocks_0
        self.carry()
        plain(stiffness.clear)(s)
        plain(stiffness.clear_points)(s)
        self.elements()
        plain(stiffness.keep_forces)(s)
        for colour in range(s.counts[0].colours):
            for k in range(6):
                plain(stiffness.displace)(H, colour, k, s)
                self.elements()
                plain(stiffness.note)(colour, k, s)
                plain(stiffness.clear_points)(s)
                self.carry()
        n = len(self.nodes) - 1
        K = np.zeros((n, 6, n, 6))
        for p, c in enumerate(s.columns_0):
            for e in range(c.block, c.block_end):
                a, b = s.columns_0[blocks[e].column].node - 1, c.node - 1
                K[b, :, a] = blocks[e].stiff_above.reshape(6, 6).T
                K[a, :, b] = blocks[e].stiff.reshape(6, 6)
            assert p == blocks[c.block].column
        return K.reshape(6 * n, 6 * n)


@pytest.mark.parametrize("case", CASES)
def test_the_tangent_is_the_derivative_of_the_forces(tmp_path: Path, case: str) -> None:
    bench = Implicit(tmp_path, *CASES[case])
    n, rng = len(bench.nodes) - 1, np.random.default_rng(3)
    # well beyond yield (its strain is 1e-3), and turned as a whole
    motion = 4e-3 * rng.normal(size=(n, 6)) * (0.2 if CASES[case][1] is PATCH else 1.0)
    motion[:, 3:] += [0.02, -0.03, 0.05]
    bench.place(motion)
    found, size = bench.stiffness(), 1e-5
    wanted = np.zeros((6 * n, 6 * n))
    kept = bench.nodes.copy()
    for k in range(6 * n):
        for sign in (1.0, -1.0):
            way = np.zeros(6 * n)
            way[k] = sign * size
            bench.place(way.reshape(n, 6))
            wanted[:, k] -= sign * bench.force().ravel() / (2.0 * size)
            bench.nodes[:] = kept
    # forces over a difference of 1e-6 (rad, or of 1e-7 of the size) bend by so much of themselves
    np.testing.assert_allclose(found, wanted, atol=1e-5 * np.abs(wanted).max())
    # strains are those of the middle of the step, forces those of its end
    assert np.abs(wanted - wanted.T).max() > 1e-4 * np.abs(wanted).max()


DECKS = Path(__file__).resolve().parents[2] / "decks/verification/parts"
# over the first half of the period, without a corner that would shake what no step resolves
RISE = 'curves: {rise: {type: formula, expression: "sin(262.5 * x) ** 4", from: 0, to: 0.02}}'


@pytest.mark.xdist_group("implicit shells")
def test_the_order_is_two_and_energy_is_kept(tmp_path: Path) -> None:
    deck = tmp_path / "strips.yaml"
    text = (DECKS / "shell_implicit.yaml").read_text("utf-8").partition("expect:")[0]
    deck.write_text(text.replace("0.05]}", "0.05], curve: rise}") + RISE, "utf-8")
    tips, balances = [], []
    for step in (2.4e-4, 1.2e-4, 6e-5):
        words = {"step": step, "end_time": 6e-3, "spectral_radius": 1}
        sets = [word for k, v in words.items() for word in ("--set", f"control.{k}={v}")]
        done = crashsolve(deck, "-o", tmp_path / f"{step}", *sets)
        assert done.returncode == 0, done.stdout + done.stderr
        result = Result(tmp_path / f"{step}")
        tips.append(result.series("rbdout.plain_a.position.z").values[-1])
        balances.append(abs(result.series("glstat.model.balance").values[-1]))
    ratio = (tips[1] - tips[0]) / (tips[2] - tips[1])
    # of neighbouring errors: the next term is a sixtieth of the first
    assert np.log2(ratio) == pytest.approx(2.0, abs=0.05)
    # the work of a force that grows is summed by trapezia: what is missing is theirs
    assert np.log2(balances[0] / balances[1]) == pytest.approx(2.0, abs=0.05)
    assert balances[2] < 0.02


@pytest.mark.long
def test_a_step_five_times_too_long_is_stopped(tmp_path: Path) -> None:
    deck = DECKS / "shell_ball_implicit.yaml"
    done = crashsolve(deck, "-o", tmp_path / "long", "--set", "control.step=1.25e-5")
    assert done.returncode == 4
    assert "energy" in done.stderr + done.stdout


WRONG = {
    "thickness: 0.002": ("thickness: 0.002\n    drag: 3", "drag: drag on shells is for explicit"),
    "hold: [{nodes: u0}]\nbodies:": (
        "welded: [{nodes: u0, to: shoe}]\nbodies:",
        "welded: a welded set of nodes is for explicit steps",
    ),
    "density: 7850": ("density: 7850, failure_strain: 0.1", "a material with a failure_strain"),
    "generalized_alpha": ("radau_iia_5", "say integrator: rattle or generalized_alpha"),
}


@pytest.mark.parametrize("right", list(WRONG))
def test_what_has_no_implicit_steps_yet_is_refused(tmp_path: Path, right: str) -> None:
    wrong, message = WRONG[right]
    text = (DECKS / "shell_implicit.yaml").read_text("utf-8")
    assert right in text
    text = text.replace(right, wrong, 1)
    if "failure" in wrong:
        text = text.replace("type: elastic,", "type: elastoplastic, yield_stress: 2e8,")
    path = tmp_path / "deck.yaml"
    path.write_text(text, "utf-8")
    with pytest.raises(DeckErrors) as caught:
        build(read_deck(path))
    assert message in str(caught.value)
