"""The log of a run: log.txt and, line by line the same, standard output.

Progress is drawn only when standard output is a terminal.
"""

import sys
from collections import Counter
from pathlib import Path
from typing import TextIO

from crashsolve.foundation.streams import discard_output, lost, printable
from crashsolve.output.files import reported

NORMAL = "N o r m a l    t e r m i n a t i o n"
ERROR = "E r r o r    t e r m i n a t i o n"
STOPPED = "S t o p p e d   o n   r e q u e s t"
WIDTH = 100
HEADER_EVERY = 40
BAR_WIDTH = 40
HEADER = (
    f"{'cycle':>10} {'time s':>12} {'step s':>10} {'kinetic J':>12} "
    f"{'balance %':>10} {'residual':>9} {'left':>8}  step set by"
)


class Log:
    """Writes log.txt and a stream; raises OutputError when log.txt cannot be written."""

    def __init__(
        self, path: Path | str, stream: TextIO | None = None, *, append: bool = False
    ) -> None:
        self.path = Path(path)
        self.warnings: Counter[str] = Counter()
        self._stream: TextIO | None = stream or sys.stdout
        self._progress_shown = False
        self._cycles = 0
        with reported(self.path):
            self._file = self.path.open("a" if append else "w", encoding="utf-8")
        while lost:
            self._warn_of_loss(lost.pop())

    def line(self, text: str = "") -> None:
        """Write one line, at once visible in the file; no text makes it two, or moves a cursor."""
        text = printable(text)
        with reported(self.path):
            self._file.write(text + "\n")
            self._file.flush()
        self._clear_progress()
        self._show(text + "\n")

    def last_words(self, text: str) -> None:
        """Write the last line of the log, also from within another one. Raises OSError."""
        with self.path.open("a", encoding="utf-8") as file:
            file.write(printable(text) + "\n")

    def section(self, title: str, lines: list[str]) -> None:
        """Write a titled paragraph."""
        self.line()
        self.line(title)
        for text in lines:
            self.line("  " + text)

    def banner(self, program: str, facts: dict[str, str]) -> None:
        """Open the log with the program and the data of the run."""
        self.line("=" * WIDTH)
        self.line(program)
        self.line("=" * WIDTH)
        self.facts(facts)

    def facts(self, facts: dict[str, str]) -> None:
        """Write names and values in two columns."""
        width = max(map(len, facts), default=0)
        for name, value in facts.items():
            self.line(f"  {name.ljust(width)}  {value}")

    def cycle(
        self,
        cycle: int,
        time: float,
        step: float,
        kinetic: float,
        balance: float,
        residual: float,
        left: float | None,
        bound: str,
    ) -> None:
        """Write one line of progress: balance in %, wall time left [s], limit of the step."""
        if self._cycles % HEADER_EVERY == 0:
            self.line()
            self.line(HEADER)
        self._cycles += 1
        self.line(
            f"{cycle:10d} {time:12.5e} {step:10.3e} {kinetic:12.5e} "
            f"{balance:10.4f} {residual:9.1e} {_clock(left):>8}  {bound}"
        )

    def warning(self, text: str) -> None:
        """Write a warning the first time it occurs and count it every time."""
        self.warnings[text] += 1
        if self.warnings[text] == 1:
            self.line(f"warning: {text}")

    def error(self, text: str) -> None:
        """Write an error, or several that stand in lines of their own."""
        for part in text.split("\n"):
            self.line(f"error: {part}")

    def timing(self, seconds: dict[str, float]) -> None:
        """Write where the time went, with the share of each entry in %."""
        total = sum(seconds.values())
        rows = {**seconds, "total": total}
        width = max(map(len, rows))
        self.section(
            "timing",
            [
                f"{name.ljust(width)} {value:12.3f} s {100 * value / (total or 1.0):6.1f} %"
                for name, value in rows.items()
            ],
        )

    def citations(self, references: list[str]) -> None:
        """Write the references of the laws used."""
        if references:
            self.section("references of the laws used", references)

    def progress(self, fraction: float) -> None:
        """Draw a bar in the last line of a terminal."""
        if self._stream is not None and self._stream.isatty():
            full = round(BAR_WIDTH * min(max(fraction, 0.0), 1.0))
            bar = "#" * full + "." * (BAR_WIDTH - full)
            self._show(f"\r[{bar}] {100 * fraction:5.1f} %")
            self._progress_shown = True

    def finish(self, last: str) -> None:
        """Repeat every distinct warning with its count, write the last line and close."""
        if self.warnings:
            count = self.warnings.total()
            self.section(
                f"warnings: {count}, of which distinct: {len(self.warnings)}",
                [f"{times:8d} x  {text}" for text, times in self.warnings.items()],
            )
        self.line()
        self.line(last)
        self._file.close()

    def _clear_progress(self) -> None:
        """Wipe the bar so that a line can take its place."""
        if self._progress_shown:
            self._show("\r\x1b[K")
            self._progress_shown = False

    def _show(self, text: str) -> None:
        """Write to the stream; one that is full, or that is not read, is no reason to stop."""
        if self._stream is not None:
            try:
                self._stream.write(text)
                self._stream.flush()
            except (OSError, ValueError) as error:
                stream, self._stream = self._stream, None
                reason = getattr(error, "strerror", None) or error
                discard_output(stream)
                # a reader such as `head` has closed the pipe
                if not isinstance(error, BrokenPipeError):
                    self._warn_of_loss(str(reason))

    def _warn_of_loss(self, reason: str) -> None:
        self.warning(f"standard output: {reason}; from here on only {self.path.name}")


def _clock(seconds: float | None) -> str:
    """Hours, minutes and seconds; days where it is many."""
    if seconds is None:
        return "-"
    if seconds >= 360000.0:
        return f"{seconds / 86400.0:.3g} d"
    whole = round(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"
