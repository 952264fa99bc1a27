"""What shells promise to implicit integrators: their tangent, order 2, energy, the same answer."""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import yaml
from bench import exponential, product, refusal
from command import crashsolve, gone_on
from quick import first_quick
from shells import ODD, PATCH, STEEL

from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.elements.shells.forces import blocks
from crashsolve.elements.shells.tangents import blocks as slopes
from crashsolve.foundation.orientation import matrix
from crashsolve.foundation.rows import Rows, as_rows
from crashsolve.model.build import build
from crashsolve.model.implicit.compliance import compliance
from crashsolve.system import points
from crashsolve.system.implicit import global_matrix, stiffness

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable

YIELDING = STEEL | {"type": "elastoplastic", "yield_stress": 200.0, "hardening": 2e4}
MOVING = YIELDING | {"kinematic": 0.6, "rate_D": 40.0, "rate_q": 5.0}
HOT = STEEL | {"type": "johnson_cook", "yield_stress": 200.0, "hardening": 500.0}
HOT |= {"exponent": 0.3, "rate": 0.02, "reference_rate": 1e-3, "melting_heat": 5.0}
RUBBER = {"type": "neo_hookean", "young": 3.0, "poisson": 0.4, "density": 1.0}
THINNING = {"thinning": True}
WELDED = {"welded": [{"nodes": "some", "to": "hub"}]}
# element, mesh, material, words of the part: all that has a tangent of its own
CASES: dict[str, tuple[str, Any, Mapping[str, object], dict[str, Any]]] = {
    "reduced": ("reduced", PATCH, STEEL, {"damping": 0.01}),
    "reduced, yielding": ("reduced", ODD, MOVING, THINNING),
    "reduced, hot": ("reduced", ODD, HOT, {}),
    "fully integrated, yielding": ("fully_integrated", ODD, MOVING, THINNING | {"damping": 0.01}),
    "triangles, yielding": ("triangles", ODD, YIELDING, THINNING),
    "reduced, welded": ("reduced", ODD, STEEL, WELDED),
    "fully integrated, welded": ("fully_integrated", ODD, STEEL, WELDED),
    "triangles, welded": ("triangles", ODD, STEEL, WELDED),
    "reduced, rubber": ("reduced", ODD, RUBBER, THINNING),
    "fully integrated, rubber": ("fully_integrated", ODD, RUBBER, THINNING),
    "triangles, rubber": ("triangles", ODD, RUBBER, THINNING),
}
# one of each element
QUICK = ("reduced, yielding", "fully integrated, welded", "triangles, rubber")
H = 0.01


class Implicit:
    """Elements with their points on bodies, in the middle of a step of H."""

    def __init__(
        self,
        folder: Path,
        element: str,
        mesh: Any,
        material: Mapping[str, object],
        words: dict[str, Any],
    ) -> None:
        nodes = [[*node, 0.0] for node in mesh[0]]
        part = {"type": "shell", "thickness": 0.05, "material": "steel", "element": element}
        sets = [{"name": "some", "nodes": [1, 2]}]
        part |= words | {
            "layers": 3,
            "mesh": {"type": "listed", "nodes": nodes, "quads": mesh[1], "sets": sets},
        }
        control = {"end_time": 1, "integrator": "generalized_alpha"}
        bodies = {"hub": {"mass": 1, "inertia": [1, 2, 3], "position": [0.3, 0.2, 0.4]}}
        deck = {
            "bodies": bodies if "welded" in words else {},
            "control": control,
            "materials": {"steel": material},
            "parts": {"s": part},
        }
        path = folder / "elements.yaml"
        path.write_text(yaml.safe_dump(deck), "utf-8")
        self.model, state = build(read_deck(path))
        self.nodes: Rows = as_rows(state.nodes)
        e, tables = self.model.elements, compliance(self.model, state, 1)
        assert e is not None
        arrays = tables | {"points": state.points, "control": self.model.control}
        arrays |= {"curves": self.model.curves}
        views = {k: as_rows(a) for k, a in arrays.items()}
        self.attached_points: Rows = as_rows(e.attached_points)
        self.scene = SimpleNamespace(
            **views,
            lanes=state.blocks,
            corners=e.corners,
            work=e.work,
            attached_points=self.attached_points,
        )
        self.clock: RowOfTable = as_rows(state.clock)[0]
        group = self.model.element_groups()[0]
        self.p = as_rows(group.parameters)[0]
        self.material = group.materials[0][1]
        kinds = [word for column, word in group.module.KINDS.items() if self.p[column]]
        self.kinds = [import_module(f"crashsolve.elements.shells.forces.{word}") for word in kinds]
        for b in self.nodes[1:]:
            b.start_r, b.start_q, b.start_A = b.r, b.q, b.A

    def position(self, motion: np.ndarray) -> None:
        """All bodies moved and turned (n, 6) from where they are."""
        for b, direction in zip(self.nodes[1:], motion, strict=True):
            b.r = b.r + direction[:3]
            b.q = product(exponential(direction[3:]), b.q)
            b.A = matrix(b.q).ravel()

    def carry(self) -> None:
        points.move_attached(H, self.nodes, self.scene.points, self.attached_points)

    def elements(self) -> None:
        """As composed: forces on the points, from what the elements kept."""
        stiffness.restart_elements(H, self.clock, self.scene)
        for kind in self.kinds:
            blocks.deform(kind, self.p, self.clock, H, self.scene, self.material)

    def force(self) -> np.ndarray:
        """Forces and torques (n, 6) of the elements where the bodies are."""
        self.carry()
        self.scene.points.force = self.scene.points.torque = 0.0
        self.elements()
        self.nodes.force, self.nodes.torque = 0.0, 0.0
        points.transfer_to_bodies(self.clock, self.nodes, self.scene.points, self.attached_points)
        return np.hstack([self.nodes.force, self.nodes.torque])[1:]

    def stiffness(self) -> np.ndarray:
        """K (6 n, 6 n) as the composed step finds it."""
        self.carry()
        matrix = SimpleNamespace(columns=self.scene.columns_0, blocks=self.scene.blocks_0)
        global_matrix.clear_matrix(self.nodes, matrix)
        stiffness.restore_elements(H, self.scene)
        stiffness.update_arms(self.nodes, self.scene)
        for kind in self.kinds:
            word = kind.__name__.rpartition(".")[2].lstrip("_")
            file = import_module(f"crashsolve.elements.shells.tangents.{word}")
            slopes.tangent(file, self.p, H, self.scene, matrix, self.material)
        return self.matrix()

    def differences(self, size: float) -> np.ndarray:
        """The same by central differences of fourth order of the forces."""
        n, kept = len(self.nodes) - 1, self.nodes.copy()
        wanted = np.zeros((6 * n, 6 * n))
        for k in range(6 * n):
            for steps, weight in ((1, 8), (-1, -8), (2, -1), (-2, 1)):
                direction = np.zeros(6 * n)
                direction[k] = steps * size
                self.position(direction.reshape(n, 6))
                wanted[:, k] -= weight * self.force().ravel() / (12.0 * size)
                self.nodes[:] = kept
        return wanted

    def begin(self) -> None:
        """Where all is becomes the start of the next step."""
        self.force()
        stiffness.save_blocks(self.scene)
        for b in self.nodes[1:]:
            b.start_r, b.start_q, b.start_A = b.r, b.q, b.A

    def matrix(self) -> np.ndarray:
        """K as the blocks have it."""
        n, blocks, s = len(self.nodes) - 1, self.scene.blocks_0, self.scene
        K = np.zeros((n, 6, n, 6))
        for p, c in enumerate(s.columns_0):
            for e in range(c.block, c.block_end):
                a, b = s.columns_0[blocks[e].column].node - 1, c.node - 1
                K[b, :, a] = blocks[e].stiff_above.reshape(6, 6).T
                K[a, :, b] = blocks[e].stiff.reshape(6, 6)
            assert p == blocks[c.block].column
        return K.reshape(6 * n, 6 * n)


@pytest.mark.parametrize(
    "case", first_quick([*QUICK, *(c for c in CASES if c not in QUICK)], len(QUICK))
)
def test_the_tangent_is_the_derivative_of_the_forces(tmp_path: Path, case: str) -> None:
    element, mesh, material, words = CASES[case]
    bench = Implicit(tmp_path, element, mesh, material, words)
    n, rng = len(bench.nodes) - 1, np.random.default_rng(3)
    rotation = np.array([0.2, -0.3, 0.5])
    for size in (6e-3, 3e-3):
        # a large turn of the whole, and strains well beyond yield (1e-3), back in part
        motion = size * rng.normal(size=(n, 6)) * (0.2 if mesh is PATCH else 1.0)
        motion[:, :3] += (matrix(exponential(rotation)) - np.eye(3)).dot(bench.nodes.r[1:].T).T
        motion[:, 3:] += rotation
        bench.position(motion)
        if size == 6e-3:
            bench.begin()
    # small beside 1e-3, at which the tangent changes; forces of 1e-15 over it are 1e-10
    K, wanted = bench.stiffness(), bench.differences(1e-5)
    np.testing.assert_allclose(K, wanted, atol=2e-9 * np.abs(wanted).max(), rtol=0)
    # strains are those of the middle of the step, forces those of its end
    assert np.abs(wanted - wanted.T).max() > 1e-4 * np.abs(wanted).max()


DECKS = Path(__file__).resolve().parents[2] / "decks/verification/parts"
# over the first half of the period, without a corner that would shake what no step resolves
RISE = 'curves: {rise: {type: formula, expression: "sin(262.5 * x) ** 4", from: 0, to: 0.02}}'


@pytest.mark.long
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


RADAU = (DECKS / "shell_radau.yaml").read_text("utf-8").partition("expect:")[0]
# the same scene with turns of 1e-4 rad, and the free strip at rest
SLIGHT = {"[0, 0, 500]": "[0, 0, 0.05]", "[0, 0, 50]": "[0, 0, 0.05]"}
SLIGHT |= {"speed: 2}": "speed: 0}", "[1, 0, -2]": "[0, 0, 0]", "[20, 30, 50]": "[0, 0, 0]"}


def tips(text: str, part: str, steps: dict[float, int], tolerance: float, at: Path) -> list[float]:
    """Where the tip of a strip is at the end, by steps of these lengths, so many of them."""
    heights, deck = [], at / "strips.yaml"
    deck.write_text(text, "utf-8")
    for step, count in steps.items():
        words = {"step": step, "tolerance": tolerance, "estimate": "off"}
        sets = [word for k, v in words.items() for word in ("--set", f"control.{k}={v}")]
        done = crashsolve(deck, "-o", at / f"{step}", *sets)
        assert done.returncode == 0, done.stdout + done.stderr
        assert done.stdout.split("accepted, rejected")[1].split()[:2] == [f"{count},", "0"]
        heights.append(Result(at / f"{step}").series(f"rbdout.{part}_a.position.z").values[-1])
    return heights


@pytest.mark.long
@pytest.mark.xdist_group("implicit shells")
def test_radau_has_its_order_where_elements_turn_little(tmp_path: Path) -> None:
    text = RADAU
    for far, slight in SLIGHT.items():
        assert far in text
        text = text.replace(far, slight)
    # with 1e-9 the iteration of the shortest steps reaches round-off first on some machines
    a, b, c = tips(text, "small", {6e-4: 10, 3e-4: 20, 1.5e-4: 40}, 3e-9, tmp_path)
    # steps of a fortieth of the period and less are up to half an order off it yet: 4.6 is seen
    assert np.log2((b - a) / (c - b)) == pytest.approx(5.0, abs=0.5)


@pytest.mark.long
@pytest.mark.xdist_group("implicit shells")
def test_radau_has_the_order_of_the_elements_where_they_turn_far(tmp_path: Path) -> None:
    a, b, c = tips(RADAU, "bent", {1e-4: 60, 5e-5: 120, 2.5e-5: 240}, 1e-7, tmp_path)
    # of neighbouring errors: the next term is a tenth of the first
    assert np.log2((b - a) / (c - b)) == pytest.approx(2.0, abs=0.2)


@pytest.mark.long
@pytest.mark.xdist_group("implicit shells")
def test_steps_of_radau_go_on_from_a_dump_to_the_same_bits(tmp_path: Path) -> None:
    deck = tmp_path / "strips.yaml"
    often = "{history: {interval: 1e-3}, restart: {every: 1e-3}}"
    assert "{history: {interval: 6e-3}}" in RADAU
    deck.write_text(RADAU.replace("{history: {interval: 6e-3}}", often), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "whole")
    assert done.returncode == 0, done.stdout + done.stderr
    # stages one after the other leave up to 0.37 of an error of 1 at the start of steps that bend
    # far: sixteen iterations to 3e-9; the rest closes the joint
    reported = next(line for line in done.stdout.splitlines() if "iterations per step" in line)
    assert float(reported.split()[-1]) < 18.0
    assert "t = 0.005 s" in gone_on(deck, tmp_path / "whole", tmp_path / "again")


@pytest.mark.long
def test_a_step_five_times_too_long_is_stopped(tmp_path: Path) -> None:
    deck = DECKS / "shell_ball_implicit.yaml"
    done = crashsolve(deck, "-o", tmp_path / "long", "--set", "control.step=1.25e-5")
    assert done.returncode == 4
    # the contact makes it, by steps five times too long
    assert "contact 'hits': the normal force has created energy" in done.stderr.splitlines()[-1]
    assert "take a shorter step" in done.stderr.splitlines()[-1]


@pytest.mark.long
def test_longer_load_steps_lead_to_the_same_equilibria(tmp_path: Path) -> None:
    text = (DECKS / "shell_static.yaml").read_text("utf-8").partition("expect:")[0]
    # half a second, three periods of the strip: inertia holds little of what has no stiffness
    text = text.replace("end_time: 1,", "end_time: 10,").replace("[1, 1]]}", "[10, 1]]}")
    assert "end_time: 10" in text and "[10, 1]" in text
    (tmp_path / "deck.yaml").write_text(text, "utf-8")
    done = crashsolve(tmp_path / "deck.yaml", "-o", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    tip = Result(tmp_path / "out").series("rbdout.strip_a.position.z").values[-1]
    # Mattiasson's elastica at 10 E I / L^2, with the tolerance that the deck gives
    assert tip == pytest.approx(0.81060902, abs=1e-3)


WRONG = {
    "thickness: 0.002": ("thickness: 0.002\n    drag: 3", "drag: drag on shells is for explicit"),
    "density: 7850": ("density: 7850, failure_strain: 0.1", "a material with a failure_strain"),
    "generalized_alpha": (
        "dormand_prince_5",
        "set integrator: rattle or generalized_alpha or radau_iia_5",
    ),
}


@pytest.mark.parametrize("deck", ["shell_implicit", "shell_radau"])
@pytest.mark.parametrize("right", list(WRONG))
def test_what_has_no_implicit_steps_yet_is_refused(tmp_path: Path, right: str, deck: str) -> None:
    wrong, message = WRONG[right]
    text = (DECKS / f"{deck}.yaml").read_text("utf-8")
    text = text.replace("radau_iia_5", "generalized_alpha") if "dormand" in wrong else text
    assert right in text
    text = text.replace(right, wrong, 1)
    if "failure" in wrong:
        text = text.replace("type: elastic,", "type: elastoplastic, yield_stress: 2e8,")
    assert message in refusal(tmp_path, text)
