"""What threads that share the elements are given: tables, and a start together."""

from collections.abc import Callable
from threading import Thread
from typing import Any

import numpy as np

from crashsolve.model.elements import line_up
from crashsolve.model.partition import JOB
from crashsolve.system.threads.worker import HOME, LINE, QUEUES, ROUND


def shared_arrays(model: Any) -> dict[str, Any]:
    """What the threads tell each other, and the pieces."""
    pieces = model.elements.pieces
    job = np.zeros(1, JOB.dtype)
    job["threads"] = pieces.threads
    return {
        "turns": np.zeros(QUEUES + LINE * pieces.threads, np.int64),
        "job": job,
        "seat": np.zeros(1, np.int64),
        "pieces": pieces.pieces,
        "loans": pieces.loans,
        "lent": pieces.lent,
    }


def own_arrays(model: Any) -> list[dict[str, Any]]:
    """What threads other than the first must not share with it: number, clock, room for a block."""
    clocks, room = model.elements.pieces.clocks, len(model.elements.work)
    return [
        {"seat": np.array([1 + k]), "clock": clocks[k : k + 1], "work": line_up(room)}
        for k in range(len(clocks))
    ]


def together(first: Callable[..., None], other: Callable[..., None]) -> Callable[..., None]:
    """The compiled step, beside which other threads take their shares while it runs."""

    def step(number: float, flag: bool, tables: Any) -> None:
        tables.turns[:] = 0
        threads = [Thread(target=other, args=(0.0, False, own)) for own in tables.of_threads]
        for thread in threads:
            thread.start()
        try:
            first(number, flag, tables)
        finally:
            tables.turns[ROUND] = HOME
            for thread in threads:
                thread.join()

    return step
