"""Claims of equilibria of shells: whatever time and units, and refused where they are unstable."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import SolverError
from crashsolve.model.build import build
from crashsolve.recording.engines import engine_of
from crashsolve.statics.equilibrium import StaticEngine

STRIP = Path(__file__).parents[2] / "decks" / "verification" / "parts" / "strip_static.yaml"
# a worker compiles the scene once
pytestmark = [pytest.mark.long, pytest.mark.xdist_group("static_shells")]


def engine(folder: Path, old: str = "", new: str = "", **given: float) -> StaticEngine:
    path, text = folder / "deck.yaml", STRIP.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")
    deck = read_deck(path, {name: repr(value) for name, value in given.items()})
    solver = engine_of(deck, *build(deck))
    assert isinstance(solver, StaticEngine)
    solver.start()
    return solver


@pytest.mark.parametrize(
    "given",
    [{"T": 1e-6}, {"T": 1e6}, {"F": 1e-12}, {"E": 70e-3, "F": 1e-16}, {"E": 70e21, "F": 1e8}],
)
def test_neither_time_nor_units_count(tmp_path: Path, given: dict[str, float]) -> None:
    solver = engine(tmp_path, **given)
    tip = solver.model.bodies.index("strip_a")
    values = {"F": 1e-4, "E": 70e9} | given
    exact = 4.0 * values["F"] * 1e3 / (values["E"] * 0.1 * 0.005**3)
    # 40 elements leave 1 / 4 n^2
    assert solver.state.nodes["r"][tip, 2] == pytest.approx(exact, rel=2e-4)


def test_a_strip_buckles_as_a_column_does(tmp_path: Path) -> None:
    # 1.1 times Euler's load pi^2 E I / 4 L^2 of a strip of 1 m
    load = np.pi**2 / 48.0 * 70e9 * 0.1 * 0.005**3 * 1.1
    with pytest.raises(SolverError, match="becomes unstable between") as caught:
        engine(tmp_path, '[0, 0, "${F/2}"]', '["${-F/2}", 0, 0]', L=1.0, F=load)
    first, second = (
        float(part.split(" and ")[-1].split()[-1]) for part in caught.value.cause.split(" %")[:2]
    )
    # 40 elements leave pi^2 / 48 n^2; and the bracket
    assert 0.011 * first == pytest.approx(1.0, abs=0.012)
    assert 0.011 * second == pytest.approx(1.0, abs=0.012)
    assert first < second
    assert "strip" in caught.value.location
