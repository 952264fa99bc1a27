"""One run: deck to results. The recital of the roof: read, build, compose, advance, write.

Signals: SIGTERM dumps and stops, SIGUSR1 dumps and goes on, SIGCONT is ignored (queues send it
along). The words stop, dump and states in control.txt of the results folder do the same.
"""

import importlib
import os
import platform
import signal
import socket
import time
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

import crashsolve
from crashsolve.deck.dump import as_data
from crashsolve.deck.read import Deck, read_deck
from crashsolve.foundation.errors import (
    CrashsolveError,
    DeckErrors,
    ExitCode,
    RunStopped,
    SolverError,
)
from crashsolve.histories import Histories
from crashsolve.model.build import build
from crashsolve.output.history import HistoryWriter
from crashsolve.output.log import Log
from crashsolve.output.peaks import write_peaks
from crashsolve.output.restart import newest_restart, write_restart
from crashsolve.output.states import StateWriter
from crashsolve.output.status import State as RunState
from crashsolve.output.status import Status, write_status
from crashsolve.pictures import Pictures
from crashsolve.system.energy import ENTRIES, IMBALANCE, KINETIC, LARGEST
from crashsolve.system.engine import Engine


def solve(deck_path: Path, folder: Path, overrides: Mapping[str, str], restart: bool) -> int:
    """Run a deck and write its results; returns the exit code. Raises CrashsolveError."""
    begun = time.process_time()
    deck = read_deck(deck_path, overrides)
    model, state = build(deck)
    folder.mkdir(parents=True, exist_ok=True)
    return Run(deck, Engine(model, state), folder, begun).execute(restart)


class Run:
    """A deck being solved into a results folder."""

    def __init__(self, deck: Deck, engine: Engine, folder: Path, begun: float) -> None:
        self.deck, self.engine, self.folder = deck, engine, folder
        self.cpu = {"read and build": time.process_time() - begun}
        self.wall_begun = time.monotonic()
        self.requests: set[str] = set()
        span = deck.control.end_time - deck.control.start_time
        out = deck.output
        self.history_step = out.history.interval or span / 1000 or 1.0
        self.state_step = out.states.interval or span / 50 or 1.0
        self.log_step = out.log.interval or span / 20 or 1.0
        self.restart_step = out.restart.every

    def execute(self, restart: bool) -> int:
        """The whole run. Raises SolverError, RunStopped, OutputError after flushing."""
        dump = newest_restart(self.folder) if restart else None
        self.log = Log(self.folder / "log.txt", append=dump is not None)
        try:
            self._begin(dump)
            self._march()
            self._end("finished", ExitCode.NORMAL, "")
            return ExitCode.NORMAL
        except CrashsolveError as error:
            stopped = isinstance(error, RunStopped)
            self.log.error(str(error)) if not stopped else self.log.line(str(error))
            self._end("stopped" if stopped else "failed", ExitCode(error.exit_code), str(error))
            raise

    def _begin(self, dump: Any) -> None:
        """Log the model, evaluate the initial state or take up the dump, open the files."""
        self._banner()
        resumed = None
        cpu = time.process_time()
        if dump is None:
            self.engine.start()
            self._refuse_misfits()
            self.histories = Histories(self.engine)
        else:
            self.histories = Histories(self.engine)
            resumed = self._restore(*dump)
        self.cpu["compile or load"] = time.process_time() - cpu
        self.pictures = Pictures(self.engine)
        metadata = self._metadata()
        self.history = HistoryWriter(
            self.folder / "history.h5", self.histories.families, metadata, resumed
        )
        self.states = StateWriter(self.folder, self.pictures.blocks, metadata, resumed)
        for text in self.engine.model.warnings:
            self.log.warning(text)
        self._catch_signals()
        if resumed is None:
            self.engine.sample()
            self._write(self.deck.control.start_time, force=True)

    def _refuse_misfits(self) -> None:
        found = self.engine.assembly_errors()
        if found:
            entries = self.deck.entries["joints"]
            raise DeckErrors(
                self.deck.error(entries[name], None, text, "correct the joint or the bodies")
                for name, text in found
            )

    def _march(self) -> None:
        """Advance from sample to sample until the end."""
        start, end = self.deck.control.start_time, self.deck.control.end_time
        cpu = time.process_time()
        # the k-th sample lies at k intervals, not at a sum of them
        k = round((self.engine.clock["time"] - start) / self.history_step)
        while self.engine.clock["time"] < end:
            k += 1
            target = start + k * self.history_step
            if target > end - 1e-9 * self.history_step:
                target = end
            self.engine.advance(target)
            self.engine.sample()
            self._write(target, force=target == end)
            self._obey()
        self.cpu["steps and output"] = time.process_time() - cpu

    def _write(self, now: float, force: bool) -> None:
        """Whatever is due at this sample."""
        self.history.append(now, self.histories.row())
        if force or self._due(now, self.state_step):
            self.states.write(now, self.pictures.fields())
        if force or self._due(now, self.log_step):
            self._log_line()
        if self.restart_step and self._due(now, self.restart_step):
            self._dump()

    def _due(self, now: float, step: float) -> bool:
        """Whether a multiple of `step` lies in the last history interval."""
        begun = now - self.deck.control.start_time
        before = begun - self.history_step
        return int(begun / step + 1e-9) > int(before / step + 1e-9)

    def _log_line(self) -> None:
        e, clock = self.engine, self.engine.clock
        limiter = "samples, turn or deck"
        if clock["limit_node"]:
            limiter = e.model.bodies[int(clock["limit_node"])]
        self.log.cycle(
            int(clock["cycle"]),
            float(clock["time"]),
            float(clock["step"]),
            float(e.ledger[KINETIC]),
            self._balance(),
            float(clock["residual"]),
            limiter,
        )
        self._status("running", None, "")
        span = self.deck.control.end_time - self.deck.control.start_time
        self.log.progress((clock["time"] - self.deck.control.start_time) / (span or 1.0))

    def _balance(self) -> float:
        ledger = self.engine.ledger
        return float(100.0 * ledger[IMBALANCE] / ledger[LARGEST]) if ledger[LARGEST] > 0 else 0.0

    def _status(self, state: RunState, code: int | None, message: str) -> None:
        clock = self.engine.clock
        write_status(
            self.folder / "status.json",
            Status(
                state,
                float(clock["time"]),
                int(clock["cycle"]),
                self.deck.control.end_time,
                float(clock["step"]),
                self._balance(),
                time.process_time(),
                time.monotonic() - self.wall_begun,
                code,
                message,
            ),
        )

    def _end(self, state: RunState, code: ExitCode, message: str) -> None:
        """Close everything that is open, whatever has happened."""
        if hasattr(self, "history"):
            self.history.close()
            self.states.close()
            write_peaks(self.folder / "peaks.txt", self.history.extremes)
        self._status(state, int(code), message)
        self._summary()
        self.log.finish(normal=code == ExitCode.NORMAL)

    def _summary(self) -> None:
        clock = self.engine.clock
        saddle = self.engine.model.saddle
        facts = {
            "cycles": f"{int(clock['cycle'])}",
            "contact onsets located": f"{int(clock['located'])}",
            "energy balance": f"{self._balance():.3g} %",
        }
        if self.engine.model.joints:
            facts["constraint rows, redundant"] = f"{saddle.rows()}, {saddle.redundant()}"
            facts["position iterations per step"] = (
                f"{clock['iterations'] / max(int(clock['cycle']), 1):.2f}"
            )
            facts["largest constraint error"] = (
                f"{float(clock['residual']):.2g} of the model's size"
            )
        self.log.line()
        self.log.facts(facts)
        self._energies()
        self.log.timing(self.cpu)
        self.log.citations(self.engine.model.citations)

    def _energies(self) -> None:
        """The ledger at the end, in J and in % of the largest energy."""
        ledger = self.engine.ledger
        largest = float(ledger[LARGEST]) or 1.0
        lines = [
            f"{name.replace('_', ' '):20} {value:14.6e} J {100 * value / largest:9.3f} %"
            for name, value in zip(ENTRIES, map(float, ledger), strict=True)
            if value != 0.0
        ]
        self.log.section("energy", lines)

    def _banner(self) -> None:
        model = self.engine.model
        counts = {k: len(v) for k, v in self.deck.entries.items() if v}
        self.log.banner(
            f"crashsolve {crashsolve.__version__}",
            {
                "deck": str(self.deck.path),
                "title": self.deck.title,
                "host": socket.gethostname(),
                "model": ", ".join(f"{n} {k}" for k, n in counts.items()) or "empty",
                "mass": f"{model.mass.sum():.6g} kg",
                "size": f"{model.size:.4g} m",
            },
        )

    def _metadata(self) -> dict[str, Any]:
        report = self.deck.output.report
        return {
            "title": self.deck.title,
            "deck_name": self.deck.path.name,
            "deck_text": self.deck.text,
            "deck_sources": {path.name: path.read_text("utf-8") for path in self.deck.files},
            "parameters": self.deck.parameters,
            "expect": self.deck.expectations(),
            "report": as_data(report) if report is not None else None,
            "citations": self.engine.model.citations,
            "versions": {
                "crashsolve": crashsolve.__version__,
                "python": platform.python_version(),
                "numpy": np.__version__,
                "numba": importlib.import_module("numba").__version__,
            },
            "host": socket.gethostname(),
            "started": datetime.now(UTC).isoformat(timespec="seconds"),
        }

    def _arrays(self) -> dict[str, np.ndarray]:
        """Everything that changes, by name: the content of a restart dump."""
        s, model = self.engine.state, self.engine.model
        arrays = {name: getattr(s, name) for name in s.__dataclass_fields__}
        arrays |= {f"history/{g.word}": g.history for g in model.groups}
        arrays |= {f"history/{c.word}": c.history for c in model.contact_groups}
        arrays |= {"saddle/columns": model.saddle.columns, "saddle/blocks": model.saddle.blocks}
        return arrays

    def _dump(self) -> None:
        self.history.flush()
        arrays = {name: _plain(array) for name, array in self._arrays().items()}
        info = {"deck_text": self.deck.text, "momenta": [x.tolist() for x in self.histories.start]}
        path = write_restart(self.folder, arrays, info)
        self.log.line(f"restart dump {path.name} at t = {float(self.engine.clock['time']):.6g} s")

    def _restore(self, arrays: dict[str, np.ndarray], info: dict[str, Any]) -> float:
        """Take up a dump; returns its time. Raises SolverError for the dump of another deck."""
        mine = self._arrays()
        same = info["deck_text"] == self.deck.text and mine.keys() == arrays.keys()
        if not same or any(_plain(mine[k]).shape != arrays[k].shape for k in mine):
            raise SolverError(
                0.0,
                0,
                "restart",
                "the dump in this folder belongs to another deck",
                "run without --restart, or into another folder",
            )
        for name, array in mine.items():
            _plain(array)[...] = arrays[name]
        self.histories.start = (np.array(info["momenta"][0]), np.array(info["momenta"][1]))
        now = float(self.engine.clock["time"])
        self.log.line(f"going on from t = {now:.6g} s")
        return now

    def _catch_signals(self) -> None:
        wanted = {"SIGTERM": "stop", "SIGUSR1": "dump"}
        for name, word in wanted.items():
            number = getattr(signal, name)
            signal.signal(number, lambda *_, word=word: self.requests.add(word))
        signal.signal(signal.SIGCONT, signal.SIG_IGN)

    def _obey(self) -> None:
        """Act on signals and on control.txt."""
        order = self.folder / "control.txt"
        if order.exists():
            self.requests |= set(order.read_text("utf-8").split())
            os.unlink(order)
        if "states" in self.requests:
            self.states.write(float(self.engine.clock["time"]), self.pictures.fields())
        if self.requests & {"stop", "dump"}:
            self._dump()
        if "stop" in self.requests:
            now = float(self.engine.clock["time"])
            raise RunStopped(f"stopped on request at t = {now:.6g} s; go on with --restart")
        self.requests.clear()


def _plain(array: np.ndarray) -> np.ndarray:
    """The bytes of a structured array, for a file that need not know its columns."""
    if array.dtype.names is None:
        return array
    return array.view(np.uint8).reshape(*array.shape, array.dtype.itemsize)
