"""Claims: a structure has the mass and stiffness of its members in all descriptions; its cards."""

from pathlib import Path

import numpy as np
import pytest
from quick import first_quick

from crashpost.results.result import Result
from crashsolve import run
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.model.model import Model, State
from crashsolve.simulation import body_shapes

ALL = ("rigid", "hinges", "segments", "beams", "shells")
LAWS = """
materials:
  steel: {type: elastoplastic, young: 2.1e11, poisson: 0.3, density: 7850, yield_stress: 3e8}
  soft: {type: elastic, young: 2e9, poisson: 0.25, density: 1000}
sections:
  tube: {type: rectangular_tube, width: 0.05, height: 0.07, thickness: 0.002}
  pipe: {type: tube, radius: 0.03, thickness: 0.001}
  rod: {type: circle, radius: 0.01}
"""
FRAME = (
    """title: a frame of three members in space
control: {end_time: 1e-3}
parts:
  frame:
    type: structure
    points:
      - {name: A, at: [0.1, 0.2, 0.3]}
      - {name: B, at: [0.1, 0.2, 1.3]}
      - {name: C, at: [0.9, 0.8, 1.3]}
      - {name: D, at: [0.9, 0.8, 0.3], joint: 0.1}
    members:
      - {from: A, to: B, side: [1, 0, 0]}
      - {name: beam, from: C, to: B, divisions: 20}
      - {from: C, to: D, side: [1, 1, 0]}
    section: tube
    material: steel
    side: [0, 0, 1]
    divisions: 12
    across: 8
    velocity: [1, 2, 3]
    angular_velocity: [0.5, -0.2, 0.3]
    deformation: DESCRIPTION
"""
    + LAWS
)


def written(folder: Path, text: str) -> Path:
    path = folder / "structure.yaml"
    path.write_text(text, "utf-8")
    return path


def built(folder: Path, text: str) -> tuple[Model, State]:
    return build(read_deck(written(folder, text)))


def moments(
    state: State, model: Model
) -> tuple[float, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Mass, mass centre, inertia about it, momentum and angular momentum about it of a model."""
    nodes = state.nodes[1:]
    mass = np.where(nodes["mass_inv"] < 1e200, 1.0 / nodes["mass_inv"], 0.0)
    r, v = nodes["r"], nodes["v"]
    A, J = nodes["A"].reshape(-1, 3, 3), nodes["J"].reshape(-1, 3, 3)
    own = A @ J @ A.transpose(0, 2, 1)
    spin = np.einsum("nij,nj->ni", own, nodes["w"])
    points = state.points
    if len(points):
        alone = points["mass_inv"] > 0.0
        alone &= points["fixed"] < 64
        mass = np.append(mass, 1.0 / points["mass_inv"][alone])
        r, v = np.vstack([r, points["r"][alone]]), np.vstack([v, points["v"][alone]])
        J_points = 1.0 / points["J_inv"][alone]
        own = np.concatenate([own, J_points[:, None, None] * np.eye(3)])
        spin = np.vstack([spin, J_points[:, None] * points["w"][alone]])
    total = mass.sum()
    centre = mass @ r / total
    s = r - centre
    square = np.einsum("n,ni,ni->", mass, s, s)
    J_all = own.sum(axis=0) + square * np.eye(3) - np.einsum("n,ni,nj->ij", mass, s, s)
    momentum = mass @ v
    return total, centre, J_all, momentum, (np.cross(s, mass[:, None] * v) + spin).sum(axis=0)


def closed_form() -> tuple[float, np.ndarray, np.ndarray]:
    """The same of three uniform bars with the section's second moments, from its integrals."""
    a, b, t, rho = 0.048, 0.068, 0.002, 7850.0
    area = 2 * t * (a + b)
    I_y, I_z = t * b * b * (a / 2 + b / 6), t * a * a * (b / 2 + a / 6)
    A, B, C, D = np.array([[0.1, 0.2, 0.3], [0.1, 0.2, 1.3], [0.9, 0.8, 1.3], [0.9, 0.8, 0.3]])
    bars = [(A, B, [1.0, 0, 0]), (C, B, [0, 0, 1.0]), (C, D, [1.0, 1.0, 0])]
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for start, end, side in bars:
        e = end - start
        length = float(np.linalg.norm(e))
        e = e / length
        y = np.asarray(side) - e * (e @ side)
        y = y / np.linalg.norm(y)
        z = np.cross(e, y)
        m, middle = rho * area * length, 0.5 * (start + end)
        mass, first = mass + m, first + m * middle
        # integral of x x^T over the bar's mass
        second += m * (np.outer(middle, middle) + length**2 / 12 * np.outer(e, e))
        second += rho * length * (I_z * np.outer(y, y) + I_y * np.outer(z, z))
    centre = first / mass
    about = second - mass * np.outer(centre, centre)
    return mass, centre, np.trace(about) * np.eye(3) - about


@pytest.mark.parametrize("word", ALL)
def test_mass_mass_centre_and_inertia_are_those_of_the_bars(tmp_path: Path, word: str) -> None:
    model, state = built(tmp_path, FRAME.replace("DESCRIPTION", word))
    mass, centre, J, momentum, spin = moments(state, model)
    wanted = closed_form()
    assert mass == pytest.approx(wanted[0], rel=1e-12)
    np.testing.assert_allclose(centre, wanted[1], atol=1e-9)
    # masses at nodes, of the share 2 (l / L)^2 of a member's own inertia, 1/72 at 12 elements; the
    # third of it that the joints and offsets leave, and the mesh of shells, which has 8 across
    tolerance = {"beams": 5e-3, "shells": 2e-3}.get(word, 1e-12)
    np.testing.assert_allclose(J, wanted[2], atol=tolerance * wanted[2].max())
    # the whole moves as one rigid body
    v = np.array([1, 2, 3]) + np.cross([0.5, -0.2, 0.3], centre - [0.1, 0.2, 0.3])
    np.testing.assert_allclose(momentum, mass * v, rtol=1e-9)
    np.testing.assert_allclose(spin, J @ [0.5, -0.2, 0.3], atol=1e-9 * J.max())


@pytest.mark.parametrize("word", ("rigid", "hinges", "segments", "beams", "shells"))
def test_the_body_of_a_point_is_at_the_point_with_the_axes_of_the_world(
    tmp_path: Path, word: str
) -> None:
    deck = read_deck(written(tmp_path, FRAME.replace("DESCRIPTION", word)))
    card = deck.entries["bodies"]["frame_C"].card
    assert card.position == (0.9, 0.8, 1.3)
    assert card.rotation.quaternion() == (1.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("word", ("rigid", "hinges", "segments"))
def test_bodies_are_drawn_as_the_lengths_of_members_that_they_are(
    tmp_path: Path, word: str
) -> None:
    deck = read_deck(written(tmp_path, FRAME.replace("DESCRIPTION", word)))
    model, state = build(deck)
    volume, moment, corners = 0.0, np.zeros(3), []
    for node, points, triangles in body_shapes.bars(model, deck):
        row = state.nodes[node]
        placed = row["r"] + points @ row["A"].reshape(3, 3).T
        a, b, c = (placed[triangles[:, k]] for k in range(3))
        # of the tetrahedra between the triangles and the origin of the world
        own = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0
        volume, moment = volume + own.sum(), moment + own @ (a + b + c) / 4.0
        corners.append(placed)
    # three members of 1 m, solid, 50 mm along y of the section and 70 mm along z
    assert volume == pytest.approx(3.0 * 0.05 * 0.07, rel=1e-12)
    middles = np.array([[0.1, 0.2, 0.8], [0.5, 0.5, 1.3], [0.9, 0.8, 0.8]])
    np.testing.assert_allclose(moment / volume, middles.mean(axis=0), rtol=1e-12)
    # y of the post is x of the world
    post = [x for x in np.concatenate(corners) if x[2] < 1.2 and x[0] < 0.2]
    np.testing.assert_allclose(np.ptp(post, axis=0)[:2], [0.05, 0.07], rtol=1e-9)


def test_members_may_differ_in_section_material_and_description(tmp_path: Path) -> None:
    text = FRAME.replace("DESCRIPTION", "segments")
    text = text.replace("to: B, side", "to: B, deformation: shells, section: pipe, side")
    text = text.replace("divisions: 20", "material: soft, deformation: beams")
    text = text.replace("to: D, side", "to: D, section: rod, deformation: hinges, side")
    deck = read_deck(written(tmp_path, text.replace("name: C,", "name: C, joint: 0.03,")))
    types = {name: entry.type for name, entry in deck.entries["parts"].items()}
    assert types == {"frame_member_1": "shell", "frame_beam": "beam"}
    assert list(deck.entries["hinges"]) == [
        f"frame_member_3_{s}" for s in ("start", "middle", "end")
    ]
    build(deck)


CANTILEVER = (
    """title: a cantilever
control: {end_time: 0.4, safety: 0.8, estimate: off}
output: {history: {interval: 1e-3}}
parts:
  arm:
    type: structure
    points: [{name: foot, at: [0, 0, 0]}, {name: tip, at: [1, 0, 0]}]
    members: [{from: foot, to: tip}]
    section: tube
    material: steel
    side: [0, 1, 0]
    deformation: DESCRIPTION
joints: {wall: {type: weld, b: arm_foot, at: [0, 0, 0]}}
curves:
  slowly:
    {type: formula, expression: "0.5 - 0.5*cos(pi*x/0.4)", from: 0, to: 0.4, extrapolate: hold}
loads: {pull: {type: force, body: arm_tip, force: [0, 100, 200], curve: slowly}}
sensors: {tip: {type: displacement, b: arm_tip}}
"""
    + LAWS
)


def tip_in_closed_form() -> tuple[float, float]:
    """Displacement of the tip along y and z under 100 and 200 N: Timoshenko's beam between rigid
    joints.
    """
    a, b, t, E = 0.048, 0.068, 0.002, 2.1e11
    directions = []
    # bending about z, the flanges along z are b wide and the webs a high; then about y
    for force, flange, web in ((100.0, b, a), (200.0, a, b)):
        second = t * web**2 * (flange / 2 + web / 6)
        c = flange * web / 4
        flow = web**2 * flange**3 / 24 + 2 * (c * c * web + c * web**3 / 6 + web**5 / 120)
        r = 0.035
        bent = ((1 - r) ** 3 - r**3) / (3 * E * second)
        directions.append(force * (bent + (1 - 2 * r) * t * flow / (E / 2.6 * second**2)))
    return directions[0], directions[1]


@pytest.mark.parametrize("word", first_quick(("beams", "hinges", "segments", "shells")))
def test_the_elastic_stiffness_at_the_tip_is_that_of_the_beam(tmp_path: Path, word: str) -> None:
    text = CANTILEVER.replace("DESCRIPTION", word)
    if word == "shells":
        text = text.replace("safety: 0.8", "solution: quasi_static, steps: 1").replace(
            ", curve: slowly", ""
        )
        text = text.replace("end_time: 0.4", "end_time: 1e-3")
        # stability is judged without the arms of reactions, which a blow from two sides twists
        text = text.replace("force: [0, 100, 200]", "force: [0, 0, 200]")
        # a coarse mesh: its stiffness is that of a fine one within a few parts of a thousand
        text = text.replace("deformation: shells", "deformation: shells\n    across: 2")
    result = Result(run(written(tmp_path, text), tmp_path / "results"))
    displacements = [float(result.series(f"disbout.tip.vector.{k}").values[-1]) for k in "yz"]
    # of the runs in time, they still swing by (period / 0.8 s)^2 = 5e-4 of it; of shells, their
    # walls are held at the joints, and bend
    tolerance = 1.5e-2 if word == "shells" else 1e-3
    wanted = tip_in_closed_form()
    assert displacements[1] == pytest.approx(wanted[1], rel=tolerance)
    if "force: [0, 100, 200]" in text:
        assert displacements[0] == pytest.approx(wanted[0], rel=tolerance)


STRUCK = (
    """title: A post is struck along its axis
control: {end_time: 0.004, safety: 0.8, estimate: off}
parts:
  frame:
    type: structure
    points: [{name: foot, at: [0, 0, 0]}, {name: tip, at: [0, 0, 0.3]}]
    members: [{name: post, from: foot, to: tip}]
    section: tube
    material: steel
    side: [0, 1, 0]
    deformation: DESCRIPTION
bodies: {ram: {mass: 100, inertia: [1, 1, 1], position: [0, 0, 0.34], velocity: [0, 0, SPEED]}}
joints:
  floor: {type: weld, b: frame_foot, at: [0, 0, 0]}
  guide: {type: prismatic, b: ram, at: [0, 0, 0.34], axis: [0, 0, 1]}
surfaces:
  striker: {type: plane, body: ram, normal: [0, 0, -1]}
  fender: {type: sphere, body: frame_tip, radius: 0.039}
contacts: {c: {a: [striker], b: [fender], normal: {type: penalty, stiffness: 1e8}}}
"""
    + LAWS
)


@pytest.mark.long
@pytest.mark.parametrize(
    "word, speed", first_quick([("hinges", -15), ("hinges", -0.2), ("segments", -15)])
)
def test_hinges_that_bear_more_than_their_section_are_named(
    tmp_path: Path, word: str, speed: float
) -> None:
    text = STRUCK.replace("DESCRIPTION", word).replace("SPEED", str(speed))
    result = Result(run(written(tmp_path, text), tmp_path / "results"))
    # Y A of a tube of 50 x 70 x 2 mm
    limit = 3e8 * (0.05 * 0.07 - 0.046 * 0.066)
    force = result.series("rcforc.c.normal").values.max()
    named = "along its beam" in result.log
    if word == "segments":
        # they yield: what is above is the inertia of the tip that is struck
        assert force < 3 * limit and not named
    else:
        assert named == (force > limit) == (speed == -15)


COLUMN = (
    """title: A column is pressed along its axis
control: {end_time: 0.03, safety: 0.8, estimate: off}
curves: {rise: {points: [[0, 0], [0.03, 1]]}}
parts:
  frame:
    type: structure
    points: [{name: foot, at: [0, 0, 0]}, {name: tip, at: [0, 0, 3]}]
    members: [{name: post, from: foot, to: tip}]
    section: tube
    material: steel
    side: [0, 1, 0]
    deformation: DESCRIPTION
joints: {floor: {type: weld, b: frame_foot, at: [0, 0, 0]}}
loads: {weight: {type: force, body: frame_tip, force: [0, 0, FORCE], curve: rise}}
"""
    + LAWS
)


@pytest.mark.parametrize("word", first_quick(["beams", "hinges", "segments", "elastic beams"], 2))
@pytest.mark.parametrize("share", first_quick([1.5, 0.5, -1.5], 2))
def test_members_compressed_beyond_eulers_load_are_named(
    tmp_path: Path, word: str, share: float
) -> None:
    # the deformed length is what joints of half a depth leave
    width, height, t, L = 0.05, 0.07, 0.002, 3 - 0.07
    inner = (width - 2 * t, height - 2 * t)
    second = (height * width**3 - inner[1] * inner[0] ** 3) / 12
    euler = np.pi**2 * 2.1e11 * second / L**2
    text = COLUMN.replace("DESCRIPTION", word.split()[-1]).replace("FORCE", str(-share * euler))
    if word.startswith("elastic"):
        text = text.replace("elastoplastic", "elastic").replace(", yield_stress: 3e8", "")
    result = Result(run(written(tmp_path, text), tmp_path / "results"))
    assert ("member 'frame_post' was compressed by" in result.log) == (share == 1.5)
    if share == 1.5:
        # a slow rise, with axial vibrations of a few hundredths
        line = result.log.partition("member 'frame_post' was compressed by")[2]
        ratio = float(line.partition("N, ")[2].partition(" times")[0])
        assert ratio == pytest.approx(1.5, rel=0.1)


def test_hinges_of_a_material_with_a_rate_have_that_of_eq_7(tmp_path: Path) -> None:
    text = FRAME.replace("DESCRIPTION", "hinges\n    hinge_arm: 0.4")
    text = text.replace("density: 7850, ", "density: 7850, rate_D: 40, ", 1)
    deck = read_deck(written(tmp_path, text))
    hinges = [entry.card for entry in deck.entries["hinges"].values()]
    assert len(hinges) == 9
    for hinge in hinges:
        assert (hinge.rate.arm, hinge.rate.power_law()) == (0.4, (0.07, 0.82))


@pytest.mark.parametrize("word", first_quick(ALL))
def test_the_expanded_deck_runs_by_itself_to_the_same_bits(tmp_path: Path, word: str) -> None:
    text = CANTILEVER.replace("DESCRIPTION", word).replace("end_time: 0.4", "end_time: 2e-3")
    kept = "disbout.tip.vector"
    if word == "rigid":
        # held by the ground, it would not move at all
        text, kept = FRAME.replace("DESCRIPTION", word), "rbdout.frame_A.velocity"
    path = written(tmp_path, text)
    first = Result(run(path, tmp_path / "first"))
    expanded = tmp_path / "expanded.yaml"
    expanded.write_text(read_deck(path).text, "utf-8")
    assert "structure" not in expanded.read_text("utf-8")
    second = Result(run(expanded, tmp_path / "second"))
    for k in "xyz":
        channel = f"{kept}.{k}"
        one, other = (result.series(channel).values for result in (first, second))
        assert one.tobytes() == other.tobytes()
    assert np.abs(one).max() > 0.0


@pytest.mark.parametrize("method", ("generalized_alpha", "radau_iia_5"))
@pytest.mark.parametrize("word", ("segments", "beams"))
def test_implicit_steps_have_welds_in_place_of_welded_nodes(
    tmp_path: Path, word: str, method: str
) -> None:
    text = CANTILEVER.replace("DESCRIPTION", word)
    text = text.replace("safety: 0.8", f"integrator: {method}")
    deck = read_deck(written(tmp_path, text))
    build(deck)
    assert not any(entry.card.welded for entry in deck.entries["bodies"].values())
    assert len(deck.entries["joints"]) == (3 if word == "beams" else 1)


WRONG = {
    "to: B, side: [1, 0, 0]": ("to: E, side: [1, 0, 0]", "unknown point 'E' (points: A, B, C, D)"),
    "from: A, to: B": ("from: B, to: B", "begins and ends in one position"),
    "section: tube": ("divisions: 3", "has no section; give it one"),
    "side: [0, 0, 1]": ("damping: 0", "I_y and I_z that differ"),
    "divisions: 12": ("divisions: 0", "divisions: must be at least 1, not 0"),
    "{name: D, at: [0.9, 0.8, 0.3], joint: 0.1}": (
        "{name: D, at: [0.9, 0.8, 1.24]}",
        "leave no length of it between them",
    ),
    # with joints of their own, members in one line were taken for two that pass each other
    "{name: D, at: [0.9, 0.8, 0.3], ": (
        "{name: D, at: [0.5, 0.5, 1.3], ",
        "point 'D' lies on the member from 'C' to 'B', which is not joined to it",
    ),
    "at: [0.9, 0.8, 0.3], joint": (
        "at: [-0.3, -0.1, 0.55], joint",
        "crosses the member from 'A' to 'B' between their points, and is not joined to it",
    ),
    "joint: 0.1": ("joint: 0", "joint: must be greater than 1e-12 m"),
    "from: C, to: D, side": ("from: A, to: B, name: D, side", "repeats member 1"),
    "material: steel": ("material: soft", "hinges need one of type elastoplastic"),
    "name: beam": ("name: beam, section: rod, deformation: shells", "is no closed thin wall"),
    "density: 7850, yield": ("density: 7850, hardening: 1e9, yield", "hardens, and hinges do not"),
    "density: 7850, ": (
        "density: 7850, rate_D: 40, ",
        "has rate_D, and hinges follow no strain rate",
    ),
    "sections:": ("bodies: {frame_A: {mass: 1, inertia: [1, 1, 1]}}\nsections:", "already in use"),
}


@pytest.mark.parametrize("right", list(WRONG))
def test_an_error_is_refused_at_the_line_of_the_structure(tmp_path: Path, right: str) -> None:
    wrong, message = WRONG[right]
    text = FRAME.replace("DESCRIPTION", "hinges")
    assert right in text
    if right == "section: tube":
        text = text.replace("divisions: 12", "fibres: [4, 16]")
    path = written(tmp_path, text.replace(right, wrong, 1))
    with pytest.raises(DeckErrors) as caught:
        build(read_deck(path))
    first = caught.value.errors[0]
    assert message in str(first)
    lines = path.read_text("utf-8").splitlines()
    start = next(k for k, line in enumerate(lines, 1) if "frame:" in line)
    end = next(k for k, line in enumerate(lines, 1) if "deformation: hinges" in line)
    assert first.line is not None and start <= first.line <= end
    assert len(caught.value.errors) <= 3
