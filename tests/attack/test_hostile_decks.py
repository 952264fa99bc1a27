"""Claim: what no deck should hold is refused by one message, before anything runs."""

import os
import time
from pathlib import Path

import pytest

from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.output.log import Log

DECKS = Path(__file__).resolve().parents[2] / "decks"
BALL = "control: {end_time: 1}\nbodies: {ball: {mass: 1, inertia: [1, 1, 1]}}\n"
# CPU [s] of a refusal, where minutes and the memory of the machine were spent
SOON = 5.0


def refusal(folder: Path, text: str, name: str = "deck.yaml") -> str:
    path = folder / name
    path.write_text(text, "utf-8")
    begun = time.process_time()
    with pytest.raises(DeckErrors) as caught:
        build(read_deck(path))
    assert time.process_time() - begun < SOON
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('title: "a\\0b"\n', "deck.yaml:1:8: error: the character U+0000 is not allowed"),
        ('title: "\\e[2J"\n', "the character U+001B is not allowed"),
        ('title: "a\\nwarning: b"\n', "title: must be one line"),
        ('"a\\eb": 1\n', "the character U+001B is not allowed"),
        (f"parameters: {{a: '${{{'9' * 400}}}'}}\n", "is too large"),
        ("parameters: {a: '${b}', b: '${a}'}\n", "depends on itself"),
    ],
)
def test_text_that_could_forge_a_line_and_numbers_beyond_all(
    text: str, words: str, tmp_path: Path
) -> None:
    assert words in refusal(tmp_path, text + BALL)


def test_a_chain_of_parameters_may_be_long_and_includes_may_not(tmp_path: Path) -> None:
    chain = "".join(f"  p{i}: '${{p{i + 1} + 1}}'\n" for i in range(1000))
    (tmp_path / "deck.yaml").write_text(f"parameters:\n{chain}  p1000: 1\n{BALL}", "utf-8")
    deck = read_deck(tmp_path / "deck.yaml")
    assert isinstance(deck, Deck)
    assert deck.parameters["p0"] == 1001
    for i in range(1200):
        (tmp_path / f"{i}.yaml").write_text(f"include: {i + 1}.yaml\n", "utf-8")
    assert "nested more than 50 deep" in refusal(tmp_path, "include: 1.yaml\n", "0.yaml")


def test_a_file_name_that_is_not_text_is_refused(tmp_path: Path) -> None:
    path = os.fsencode(tmp_path) + b"/\xff.yaml"
    with open(path, "w") as file:
        file.write(BALL)
    with pytest.raises(DeckErrors, match="the name of the file is not UTF-8"):
        read_deck(Path(os.fsdecode(path)))


SHELL = """control: {end_time: 1}
materials: {s: {type: elastic, young: 2e11, poisson: 0.3, density: 7850}}
parts:
  p: {type: shell, thickness: THICK, material: s, MORE mesh: {type: grid, along: [1, 0, 0],
      across: [0, 1, 0], elements: [NU, 1000000]}}
"""


@pytest.mark.parametrize("count", [10**6, 10**9, 10**15])
def test_a_mesh_beyond_the_memory_of_the_machine(count: int, tmp_path: Path) -> None:
    text = SHELL.replace("NU", str(count)).replace("THICK", "0.01").replace("MORE", "")
    message = refusal(tmp_path, text)
    assert "part 'p': mesh.elements: " in message
    assert "GB of memory, and this machine has" in message
    assert "take fewer" in message


@pytest.mark.parametrize("count", ["200000", "1000000000000", "1" + "0" * 300])
def test_a_beam_of_very_many_elements(count: str) -> None:
    begun = time.process_time()
    with pytest.raises(DeckErrors) as caught:
        read_deck(DECKS / "scenes" / "beam_impact_10_continuous.yaml", {"elements": count})
    assert time.process_time() - begun < SOON
    assert len(caught.value.errors) == 1


def test_names_of_cuts_are_names(tmp_path: Path) -> None:
    cut = 'section_cuts: [{name: "a b", at: [0.5, 0, 0], normal: [1, 0, 0]}],'
    text = SHELL.replace("1000000]", "4]").replace("NU", "4").replace("THICK", "0.01")
    assert "'a b' is not a valid name" in refusal(tmp_path, text.replace("MORE", cut))


@pytest.mark.parametrize("thickness", ["1e200", "1e300"])
def test_numbers_that_no_machine_reckons_with(thickness: str, tmp_path: Path) -> None:
    text = SHELL.replace("1000000]", "4]").replace("NU", "4").replace("MORE", "")
    message = refusal(tmp_path, text.replace("THICK", thickness))
    assert "too large or too small to compute with" in message


def test_no_text_adds_a_line_to_the_log(tmp_path: Path) -> None:
    log = Log(tmp_path / "log.txt", open(os.devnull, "w"))  # noqa: SIM115
    log.line("a\nwarning: forged\r\x1b[2J\x9b\u2028\u202eb")
    text = (tmp_path / "log.txt").read_text("utf-8")
    assert text == "a\\nwarning: forged\\r\\x1b[2J\\x9b\\u2028\\u202eb\n"
