"""Claim: every part that has elements can be divided, and its closed form is where meshes lead."""

from pathlib import Path

import pytest
from command import crashsolve
from quick import first_quick
from small_runs import CANTILEVER

from crashsolve.deck.reading.deck import read_deck
from crashsolve.study.meshes import Coarser, coarser, finer

SHELL = """
control: {end_time: 1e-5}
materials: {m: {type: elastic, young: 2e11, poisson: 0.3, density: 7850}}
parts:
  p: {type: shell, thickness: 1e-3, material: m, mesh: MESH}
watch: [matsum.p.energy.kinetic]
"""
MESHES = {
    "{type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [4, 8]}": (32, 12),
    "{type: tube, width: 0.1, length: 0.3, elements: [4, 4, 8]}": (32, 8),
    "{type: box, size: [1, 1, 1], elements: [4, 4, 4]}": (0, 0),
    "{type: sphere, radius: 0.1, elements: 4}": (0, 0),
}
STRUCTURE = f"""
control: {{end_time: 2e-3, step: 2e-6}}
{CANTILEVER}
watch: [{{channel: CHANNEL, statistic: final}}]
"""
TIP = "rbdout.arm_tip.position.z"


def structure(folder: Path, word: str, channel: str = TIP) -> Path:
    """A cantilever as a structure of this description."""
    path = folder / f"{word}.yaml"
    text = STRUCTURE.replace("WORD", word).replace("COUNT", "4").replace("CHANNEL", channel)
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize("mesh", MESHES)
def test_generated_meshes_are_divided_in_all_directions(mesh: str, tmp_path: Path) -> None:
    (tmp_path / "deck.yaml").write_text(SHELL.replace("MESH", mesh), "utf-8")
    deck = read_deck(tmp_path / "deck.yaml")
    count = deck.entries["parts"]["p"].card.mesh.count
    for overrides, factor in ((finer(deck, 2), 4.0), (coarser(deck, 2).overrides, 0.25)):
        other = read_deck(tmp_path / "deck.yaml", overrides)
        assert other.entries["parts"]["p"].card.mesh.count == factor * count


def made_coarser(folder: Path, elements: str, factor: int) -> Coarser:
    """A grid of these elements, made coarser."""
    mesh = next(iter(MESHES)).replace("[4, 8]", elements)
    (folder / "deck.yaml").write_text(SHELL.replace("MESH", mesh), "utf-8")
    return coarser(read_deck(folder / "deck.yaml"), factor)


def test_a_mesh_of_one_element_is_not_made_coarser(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="has 2, which cannot be divided by 2"):
        made_coarser(tmp_path, "[2, 1]", 2)


@pytest.mark.parametrize(
    ("elements", "factor", "numbers", "ratio"),
    [
        # a node in the middle stays one: of 6 elements not 3 but 4
        ("[6, 10]", 2, ("4", "6"), 10.0 / 6.0),
        ("[6, 10]", 4, ("2", "4"), 3.0),
        ("[5, 7]", 2, ("3", "4"), 7.0 / 4.0),
        ("[8, 16]", 4, ("2", "4"), 4.0),
        # two of them stay
        ("[8, 4]", 4, ("2", "2"), 4.0),
    ],
)
def test_any_number_of_elements_is_made_about_half(
    elements: str, factor: int, numbers: tuple[str, str], ratio: float, tmp_path: Path
) -> None:
    other = made_coarser(tmp_path, elements, factor)
    assert tuple(other.overrides.values()) == numbers
    assert other.ratio == pytest.approx(ratio, rel=1e-15)
    assert other.kept == {}


def test_two_elements_across_a_strip_stay(tmp_path: Path) -> None:
    other = made_coarser(tmp_path, "[8, 2]", 2)
    assert other.overrides == {"parts.p.mesh.elements.1": "4", "parts.p.mesh.elements.2": "2"}
    assert other.ratio == 2.0
    assert other.kept == {"parts.p.mesh.elements.2": 2}


@pytest.mark.parametrize(("word", "order"), first_quick([("segments", 1.0), ("beams", 2.0)], 0))
def test_structures_lead_to_one_answer(word: str, order: float, tmp_path: Path) -> None:
    done = crashsolve(
        *("study", structure(tmp_path, word), "-o", tmp_path / "study"),
        *("--integrators", "rattle", "--steps", "2e-6,1e-6", "--meshes", "1,2,4"),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    printed = done.stdout.split("away; order ")[1].split(" in the")[0]
    seen, apart = map(float, printed.split(" +- "))
    # three meshes from 4 elements on have not come to their order yet
    assert seen == pytest.approx(order, abs=0.15)
    assert apart == pytest.approx(abs(seen - order), abs=0.011)
    reference = float(done.stdout.split(f"{TIP} final = ")[1].split()[0])
    # both descriptions lead to one deflection: 1.3354e-4 m of 16 and 32 beam elements; rotary
    # inertia and shear, which segments have as well, are 1e-3 of it
    assert reference == pytest.approx(1.3354e-4, rel=5e-3)
    assert "target 0.05: rattle, mesh x" in done.stdout


def test_what_moves_with_the_mesh_is_not_named(tmp_path: Path) -> None:
    channel = "rbdout.arm_member_1_2.position.z"
    deck = read_deck(structure(tmp_path, "segments", channel))
    with pytest.raises(ValueError, match="names arm_member_1_2, which is elsewhere"):
        finer(deck, 2)
