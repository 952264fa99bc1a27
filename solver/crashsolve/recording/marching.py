"""Arguments of the compiled loop from sample to sample (march.py): tables, and the copies to make.

    copies of the State before a sample;  a snapshot of an interval

They are renewed when tables are bound to other arrays. Where Python is needed at every sample, no
block is run, and the run goes from one sample to the next. Consequence to
test: the same bits as sample by sample.
"""

import time as clock
from collections.abc import Iterable
from contextlib import suppress
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.compiler.cache import CacheError
from crashsolve.compiler.machine import compile_ahead, machine_codes, runs_plain
from crashsolve.compiler.table import Slot, Tables
from crashsolve.foundation.rows import as_rows
from crashsolve.model.clock import CLOCK
from crashsolve.model.contact.body_pairs import BODY_PAIR
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.model.contact.records import CARD_HISTORY, CARD_OUTPUT
from crashsolve.model.model import Model
from crashsolve.model.nodes import NODE, ROW
from crashsolve.recording import gather, march
from crashsolve.recording.kept import Block
from crashsolve.system.engine import Engine

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable
    from crashsolve.recording.changing import Snapshot

ENTRIES = ("march", "take", "look", "bound")
ENTRIES += ("check_interval", "start_interval", "copy_interval", "finish_interval")
# samples of one block
MAX_BLOCK_SAMPLES = 1024
Pieces = Iterable[tuple[np.ndarray, np.ndarray]]
NUMBERS = np.dtype(float)
# rows and dimensions of the tables of march.py, the same in all scenes
LAYOUT: dict[str, Slot] = {
    "job": (march.JOB.dtype, 1),
    "times": (NUMBERS, 1),
    "sample_clock": (CLOCK.dtype, 1),
    "ledger": (NUMBERS, 1),
    "sample_ledger": (NUMBERS, 1),
    "cards": (CARD_OUTPUT.dtype, 1),
    "card_history": (CARD_HISTORY.dtype, 2),
    "watch": (march.WATCH.dtype, 1),
    "marks": (march.MARK.dtype, 1),
    "probes": (march.PROBE.dtype, 1),
    "present_nodes": (NODE.dtype, 1),
    "phase": (march.PHASE.dtype, 1),
    "skipping": (march.SKIPPING.dtype, 1),
    "both": (BODY_PAIR.dtype, 1),
    "before": (march.COPY.dtype, 1),
    "snapshot": (march.COPY.dtype, 1),
    "passed": (march.PASSED.dtype, 1),
    "nodes": (NODE.dtype, 1),
    "rows": (ROW.dtype, 1),
    "clock": (CLOCK.dtype, 1),
    "joints": (gather.JOINT.dtype, 1),
    "origins": (gather.ORIGIN.dtype, 1),
    "block": (gather.BLOCK.dtype, 1),
    "pieces": (gather.PIECE.dtype, 1),
    "bounds": (gather.BOUND.dtype, 1),
    "extremes": (gather.EXTREME.dtype, 1),
}


def compile_march_ahead() -> None:
    """Have march.py compiled, where it is not yet, while a model is built."""
    # an error shows when the code is asked for
    with suppress(CacheError, OSError):
        compile_ahead(Path(march.__file__), ENTRIES, LAYOUT)


class March:
    """Tables and entries of march.py for one engine. Writes: all of the State."""

    def __init__(self, engine: Engine, kept: Block, snapshot: "Snapshot | None") -> None:
        """Samples go to `kept`. With a snapshot, intervals are watched."""
        self.engine, self.kept, self.snapshot = engine, kept, snapshot
        self._bound = -1
        state, control = engine.state, engine.model.control[0]
        self._job = np.zeros(1, march.JOB.dtype)
        self.job: RowOfTable = as_rows(self._job)[0]
        self.job.is_dense, self.job.end = engine.is_dense, control["end"]
        self.job.limit, self.job.longest = control["energy_limit"], inf
        self.job.shortest = -inf
        self.job.cards = len(engine.model.contacts)
        self.watch_table = np.zeros(1, march.WATCH.dtype)
        self.watch: RowOfTable = as_rows(self.watch_table)[0]
        self.watch.watches = snapshot is not None
        self.marks = np.zeros(len(state.cards), march.MARK.dtype)
        self.probes = _probes(engine.model)
        self.job.probes = len(self.probes)
        self.phase = np.zeros(1, march.PHASE.dtype)
        self._times = np.zeros(MAX_BLOCK_SAMPLES)
        self._both = np.zeros(2, BODY_PAIR.dtype)
        self.job.both = self._both.ctypes.data
        # one engine of exactly this kind: others do more between samples
        self._is_plain = type(engine) is Engine and not engine.model.nodal_groups
        self._bind()
        # plain Python takes longer for it than numpy
        bound = None if runs_plain() else lambda: self._call("bound")
        kept.use(lambda: self._call("take"), bound)

    def ask(self) -> bool:
        """Whether the samples miss a contact or an acceleration in the interval that ends now."""
        self._call("check_interval")
        return bool(self.watch.hides)

    def begin(self) -> None:
        """An interval begins."""
        if self.watch.watches:
            self._renew()
            self._call("start_interval")
            if self.snapshot is not None and not self.snapshot.is_copied:
                self.snapshot.take()
                self.watch.copied = 1

    def take_snapshot(self) -> None:
        """Take the snapshot of the interval, where it has none yet, before further steps."""
        if self.snapshot is not None and not self.watch.copied:
            self._renew()
            self._call("copy_interval")
            self.snapshot.note_copies()

    def finish_interval(self) -> None:
        """Count the interval that ends now."""
        self._call("finish_interval")

    def restart_count(self) -> None:
        """Count intervals from the present sample."""
        self.phase[...] = 0
        self.finish_interval()
        for name in ("steps", "spans"):
            self.phase[name] = 0

    def can_march(self, until: float) -> bool:
        """Whether samples until then need copies alone."""
        is_able = self._needs_copies_alone()
        if self.snapshot is not None:
            is_able = is_able and self.snapshot.is_copied
        return is_able and self.engine.has_no_corner(until)

    def look(self) -> bool | None:
        """Sample the present step; whether it has been taken. None where Python must do that."""
        if not self._needs_copies_alone():
            return None
        self._renew()
        self._call("look")
        return bool(self.job.count)

    def _needs_copies_alone(self) -> bool:
        """Whether a sample is a call of the step and copies."""
        return self._is_plain and self.kept.is_copied and self.engine.addresses is not None

    def go(self, times: np.ndarray) -> tuple[int, float, int | None]:
        """Run a block of samples at times [s]; returns their number, and CPU time [s] of the steps.

        Also the status with which the step returned before a sample, None where it did not. It must
        be handled after the samples that are done are recorded: a dump may follow.
        """
        begun, count = clock.process_time(), min(len(times), self.kept.room, MAX_BLOCK_SAMPLES)
        self._renew()
        self._times[:count] = times[:count]
        self.job.most, self.job.total = count, 0
        status = self.engine.within_pause(lambda: self._call("march"))
        if self.job.copies and self.snapshot is not None:
            self.snapshot.note_copies()
        spent, share = clock.process_time() - begun, 1.0
        if self.job.total > 0:
            share = float(self.job.stepping) / float(self.job.total)
        left = status if self.job.why == march.STEPPED else None
        return int(self.job.count), spent * share, left

    def is_at_sample(self) -> bool:
        """Whether the last block has ended at a sample, and not on the way to the next."""
        return self.job.why in (march.DONE, march.OTHER_STEP)

    def _call(self, name: str) -> None:
        self._entries[name](0.0, False, self._tables)

    def _renew(self) -> None:
        """Renew the copies for the present arrays."""
        if self._bound != self.engine.bindings:
            self._bind()

    def _bind(self) -> None:
        engine, state = self.engine, self.engine.state
        self._bound = engine.bindings
        if engine.addresses is not None:
            self.job.step, self.job.present, self.job.of_sample = engine.addresses
        snapshot, skipping = self._copies_of_snapshot()
        self._copies = {
            "before": _table(engine.copied),
            "snapshot": _table(snapshot),
            "passed": _passed(engine.model),
        }
        for name, table in self._copies.items():
            self._job[name] = len(table)
        self._tables = Tables(
            {
                "job": self._job,
                "times": self._times,
                "sample_clock": engine.sample_clock,
                "ledger": state.ledger,
                "sample_ledger": engine.ledger,
                "cards": state.cards,
                "card_history": state.card_history,
                "watch": self.watch_table,
                "marks": self.marks,
                "probes": self.probes,
                "present_nodes": state.nodes,
                "phase": self.phase,
                "skipping": skipping,
                "both": self._both,
            }
            | self._copies
            | self.kept.tables
        )
        if runs_plain():
            self._entries = {name: getattr(march, name) for name in ENTRIES}
            return
        codes = machine_codes(Path(march.__file__), ENTRIES, self._tables)
        self._entries = dict(zip(ENTRIES, codes, strict=True))

    def _copies_of_snapshot(self) -> tuple[Pieces, np.ndarray]:
        """Copies to make of a snapshot, and rows of SKIPPING for what is copied if it changes."""
        if self.snapshot is None or not self.snapshot.is_copied:
            return (), np.zeros(0, march.SKIPPING.dtype)
        pieces = self.snapshot.pieces()
        groups = [
            g
            for g in self.engine.model.contact_groups
            if g.body_pairs is not None and len(g.body_pairs)
        ]
        apart = {f"{name}/{g.word}" for g in groups for name in ("body_pairs", "history")}
        copies = {name: copy for name, (_, copy) in pieces.items()}
        rows = [_skipping(g, copies) for g in groups]
        others = [piece for name, piece in pieces.items() if name not in apart]
        return others, np.array(rows, march.SKIPPING.dtype)


def _skipping(group: ContactGroup, kept: dict[str, np.ndarray]) -> tuple[int, ...]:
    """A row of SKIPPING, by the copies that a snapshot has."""
    history, pairs = group.history, group.body_pairs
    assert pairs is not None
    copies = (kept[f"{name}/{group.word}"].ctypes.data for name in ("body_pairs", "history"))
    kept_pairs, kept_history = copies
    both = (pairs.ctypes.data, kept_pairs, len(pairs), history.ctypes.data, kept_history)
    return *both, history.strides[0], history.strides[1]


def _table(pieces: Pieces) -> np.ndarray:
    """Rows of COPY, of arrays in one piece."""
    copies = [(target.ctypes.data, source.ctypes.data, source.nbytes) for source, target in pieces]
    return np.array(copies, march.COPY.dtype)


def has_probes(model: Model) -> bool:
    """Whether a sensor has a role in measures of injury."""
    return len(_probes(model)) > 0


def _probes(model: Model) -> np.ndarray:
    """Rows of PROBE, of all sensors that have a role in measures of injury."""
    rows = [
        (p["node"], p["point"], np.zeros(3), np.zeros(3), 0.0, 0)
        for group in model.sensor_groups()
        if "has_role" in (group.parameters.dtype.names or ())
        for p in group.parameters
        if p["has_role"]
    ]
    return np.array(rows, march.PROBE.dtype)


def _passed(model: Model) -> np.ndarray:
    """Rows of PASSED: times at which pairs passed, of every group that notes them."""
    passed = []
    for group in model.contact_groups:
        if "pass_time" in (group.history.dtype.names or ()) and group.history.shape[1]:
            column, (half, stride) = group.history["pass_time"], group.history.strides
            passed.append((column.ctypes.data, stride, group.history.shape[1], half))
    return np.array(passed, march.PASSED.dtype)
