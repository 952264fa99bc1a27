"""What threads that share a step are given: tables, and a start together."""

from collections.abc import Callable
from threading import Thread
from typing import Any

import numpy as np

from crashsolve.foundation.record import Record
from crashsolve.model.clock import CLOCK
from crashsolve.model.elements import line_up
from crashsolve.model.model import Model
from crashsolve.threads.worker import HOME, LINE, QUEUES, ROUND

JOB = Record("""
    threads  count  that share it
    number   index  what the threads are to do
    h        s      step
    group    index  for which group of loads or contacts
    entry    index  for which of its loads
    current  index  of its history
    floor    m      depth that need not be known
""")


def shared_arrays(model: Model) -> dict[str, Any]:
    """What the threads notify each other, and the pieces."""
    job = np.zeros(1, JOB.dtype)
    job["threads"] = model.threads
    shared = {
        "queues": np.zeros(QUEUES + LINE * model.threads, np.int64),
        "job": job,
        "seat": np.zeros(1, np.int64),
    }
    if model.elements:
        pieces = model.elements.pieces
        shared |= {"pieces": pieces.pieces, "loans": pieces.loans, "lent": pieces.lent}
    return shared


def own_arrays(model: Model) -> list[dict[str, Any]]:
    """What threads other than the first must not share with it, for each of them.

    Number, clock, room for a block of elements, and for the area on which a pair presses.
    """
    rooms = [g for g in model.contact_groups if g.in_pieces and g.is_flat]
    found = []
    for seat in range(1, model.threads):
        own = {"seat": np.array([seat]), "clock": np.zeros(1, CLOCK.dtype)}
        if model.elements:
            own["work"] = line_up(len(model.elements.work))
        for g in rooms:
            own |= {f"{g.word}_data_{k}": data.copy() for k, data in enumerate(g.data)}
        found.append(own)
    return found


def together(first: Callable[..., None], other: Callable[..., None]) -> Callable[..., None]:
    """The compiled step, beside which other threads take their shares while it runs."""

    def step(number: float, flag: bool, tables: Any) -> None:
        tables.queues[:] = 0
        threads = [Thread(target=other, args=(0.0, False, own)) for own in tables.of_threads]
        for thread in threads:
            thread.start()
        try:
            first(number, flag, tables)
        finally:
            tables.queues[ROUND] = HOME
            for thread in threads:
                thread.join()

    return step
