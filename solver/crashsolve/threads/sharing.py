"""Tables of the threads that share a step, and the step in which all of them run."""

from collections.abc import Callable
from threading import Thread

import numpy as np

from crashsolve.compiler.table import Tables
from crashsolve.foundation.record import Record
from crashsolve.model.clock import CLOCK
from crashsolve.model.elements import line_up
from crashsolve.model.model import Model
from crashsolve.threads.worker import LAST_ROUND, LINE, QUEUES, ROUND

JOB = Record("""
    threads  count  that share it
    number   index  what the threads are to do
    h        s      step
    group    index  for which group of loads or contacts
    entry    index  for which of its loads
    current  index  of its history
    floor    m      depth that need not be known
""")


def shared_arrays(model: Model) -> dict[str, np.ndarray]:
    """Tables that all threads share: queues, job and pieces."""
    job = np.zeros(1, JOB.dtype)
    job["threads"] = model.threads
    shared = {
        "queues": np.zeros(QUEUES + LINE * model.threads, np.int64),
        "job": job,
        "thread_number": np.zeros(1, np.int64),
    }
    if model.elements:
        pieces = model.elements.pieces
        assert pieces is not None
        shared |= {
            "pieces": pieces.pieces,
            "originals": pieces.originals,
            "replicas": pieces.replicas,
        }
    return shared


def arrays_of_threads(model: Model) -> list[dict[str, np.ndarray]]:
    """Tables of its own for each thread but the first.

    Number, clock, work space for a block of elements and for the area of contact of a pair.
    """
    flat_groups = [g for g in model.contact_groups if g.in_pieces and g.is_flat]
    tables = []
    for thread_number in range(1, model.threads):
        own = {"thread_number": np.array([thread_number]), "clock": np.zeros(1, CLOCK.dtype)}
        if model.elements:
            own["work"] = line_up(len(model.elements.work))
        for g in flat_groups:
            own |= {f"{g.word}_data_{k}": data.copy() for k, data in enumerate(g.data)}
        tables.append(own)
    return tables


def together(first: Callable[..., None], other: Callable[..., None]) -> Callable[..., None]:
    """The compiled step `first`, during which other threads run `other`."""

    def step(number: float, flag: bool, tables: Tables) -> None:
        tables.queues[:] = 0
        threads = [Thread(target=other, args=(0.0, False, own)) for own in tables.of_threads]
        for thread in threads:
            thread.start()
        try:
            first(number, flag, tables)
        finally:
            tables.queues[ROUND] = LAST_ROUND
            for thread in threads:
                thread.join()

    return step
