"""What methods of integration declare: their order, and whether they choose their steps."""

import importlib
from types import ModuleType


def order_of(method: str) -> float | None:
    """Declared order [1] of a method in its step; None when it declares none."""
    return getattr(_module(method), "ORDER", None)


def chooses_its_step(method: str) -> bool:
    """Whether a method chooses its steps by a tolerance, as those of stages do."""
    return hasattr(_module(method), "STAGES")


def _module(method: str) -> ModuleType | None:
    try:
        return importlib.import_module(f"crashsolve.integrators.{method}")
    except ModuleNotFoundError:
        # a run with it will say so
        return None
