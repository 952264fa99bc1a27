"""What two threads that share the elements are given: text, tables, and a start together."""

from collections.abc import Callable
from threading import Thread
from typing import Any

import numpy as np

from crashsolve.model.elements import line_up
from crashsolve.model.partition import JOB
from crashsolve.system.threads.worker import CALLED, HOME, TURNS


def arrays_of_first(model: Any) -> dict[str, Any]:
    """What the two threads tell each other, and the first half."""
    halves = model.elements.halves
    rows = {f"{word}_share": rows for word, rows in halves.rows[0].items()}
    return rows | {
        "turns": np.zeros(TURNS, np.int64),
        "job": np.zeros(1, JOB.dtype),
        "loans": halves.loans,
        "lent": halves.lent,
        "holds": halves.holds,
        "second_clock": halves.second_clock,
        "second_work": line_up(len(model.elements.work)),
    }


def arrays_of_second(model: Any, first: dict[str, Any]) -> dict[str, Any]:
    """Arrays of the second thread: the same but for what it must not share."""
    halves = model.elements.halves
    own = {f"{word}_share": rows for word, rows in halves.rows[1].items()}
    own |= {f"{word}_parameters": rows for word, rows in halves.loads.items()}
    # of the ground, and of the history of a part, it writes nothing that counts
    copies = [*(f"{g.word}_history" for g in model.element_groups()), "nodes"]
    return (
        first
        | own
        | {name: first[name].copy() for name in copies}
        | {"corners": halves.corners, "points": halves.points, "clock": halves.second_clock}
        | {"work": first["second_work"]}
    )


def together(first: Callable[..., None], second: Callable[..., None]) -> Callable[..., None]:
    """The compiled step, beside which a second thread does its share while it runs."""

    def step(number: float, flag: bool, tables: Any) -> None:
        tables.turns[:] = 0
        thread = Thread(target=second, args=(0.0, False, tables.second))
        thread.start()
        try:
            first(number, flag, tables)
        finally:
            tables.turns[CALLED] = HOME
            thread.join()

    return step
