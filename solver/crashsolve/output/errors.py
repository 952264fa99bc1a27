"""The one error of this package: a result file could not be written or read."""

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
