"""Errors of this package: a result file could not be written or read, or should hold NaN."""

from pathlib import Path

from crashsolve.foundation.errors import CrashsolveError, ExitCode
from crashsolve.foundation.streams import printable


class OutputError(CrashsolveError):
    """A result file failed; names the file and the reason, and ends the run with exit code 5."""

    exit_code = ExitCode.OUTPUT

    def __init__(self, path: Path | str, reason: object) -> None:
        self.path = Path(path)
        self.reason = str(reason)
        super().__init__(printable(f"{self.path}: {self.reason}"))


class NotFiniteError(OutputError):
    """A result is no number: the run has gone wrong, not the file; ends it with exit code 4."""

    exit_code = ExitCode.SOLVER
