"""Runs of crashsolve: a deck with another integrator, step and tolerance."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from problem import Method, Run

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

DECKS = Path(__file__).resolve().parents[2] / "decks"

# the methods that choose their step, over the requested error
TOLERANCES = [
    (integrator, "tolerance", [10.0**-k for k in range(3, 13)])
    for integrator in ("dormand_prince_5", "dormand_prince_8")
]
# and those for stiff problems beside them
STIFF = [
    *TOLERANCES,
    ("generalized_alpha", "tolerance", [10.0**-k for k in range(2, 10)]),
    ("radau_iia_5", "tolerance", [10.0**-k for k in range(2, 11)]),
]
Watch = Callable[[dict[str, np.void]], Any]


def methods(
    deck: Path,
    entries: Sequence[tuple[str, str, Sequence[float]]],
    watch: Watch,
    overrides: dict[str, str] | None = None,
    **control: object,
) -> list[Method]:
    """One method per entry (integrator, word of control that is varied, its values).

    `watch` takes the bodies by name, each with the columns of the node table, and gives the values
    to judge. `control` holds further words, the same for all runs.
    """

    def prepare(integrator: str, word: str, value: float) -> Run:
        words = {"energy_limit": "off", **control, "integrator": integrator}
        if word == "tolerance":
            # the method chooses its step, also where the deck states one
            words["step"] = "auto"
        words[word] = value
        given = read_deck(deck, overrides or {})
        given = replace(given, control=given.control.model_copy(update=words))
        engine = Engine(*build(given))

        def solve() -> None:
            engine.start()
            engine.advance(given.control.end_time)

        def watched() -> np.ndarray:
            return np.array(watch(dict(zip(engine.model.bodies, engine.state.nodes, strict=True))))

        return Run(solve, watched)

    return [
        Method(
            "crashsolve",
            integrator if word == "step" else f"{integrator}, {word}",
            word,
            values,
            lambda value, i=integrator, w=word: prepare(i, w, value),
        )
        for integrator, word, values in entries
    ]


def rotation(body: np.void) -> np.ndarray:
    """Rotation matrix of a body, from its quaternion (w, x, y, z)."""
    w, x, y, z = body["q"]
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def angle_of(body: np.void) -> float:
    """Angle about z of a body that rotates about z only, modulo a revolution."""
    w, _, _, z = body["q"]
    return float(2.0 * np.arctan2(z, w))
