"""Post-processor of crashsolve: it reads the result files and nothing else."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crashpost.results.result import Result as Result


def __getattr__(name: str) -> object:
    """`Result` for scripts, loaded when it is asked for."""
    if name == "Result":
        from crashpost.results.result import Result

        return Result
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
