"""Batch solver for the impact of rigid and flexible multibody systems."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crashsolve.scripting import run as run

__version__ = "0.1.0"


def __getattr__(name: str) -> object:
    """`run` for scripts, loaded when it is asked for."""
    if name == "run":
        from crashsolve.scripting import run

        return run
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
