"""The equations of equilibrium: the interface of the engine for hinges, branches and the balance.

    g(q) = 0,   Phi(q) = 0,   (dg/dq - s D^T D) delta = -g + s D^T Phi

`equilibrium.py` has them of a model. What hinges, segments, branches and the balance ask of them
stands here: n free nodes, m rows of joints.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from crashsolve.model.model import Group, Model, State
from crashsolve.statics.loading import Loading

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable

Tangent = tuple[np.ndarray, np.ndarray]


class CurvesOfLaws(Protocol):
    """Owner of the curves that laws read, and of the groups that may yield."""

    groups: list[Group]

    def curves(self) -> list[SimpleNamespace]: ...


class YieldingElements(Protocol):
    """Owner of the groups whose fibres or walls may flow."""

    groups: list[Group]


class Residual(Protocol):
    """Forces that are out of balance."""

    def message(self) -> str: ...


class Equations(Protocol):
    """Attributes and functions of a quasi-static engine."""

    clock: RowOfTable
    model: Model
    state: State
    nodes: np.ndarray  # of the last sample
    rows: np.ndarray
    ledger: np.ndarray
    free: np.ndarray  # nodes (n,)
    tangent: Tangent | None  # K (6 n, 6 n) and D (m, 6 n) of the last pass
    known_tangent: Tangent | None  # of the last equilibrium
    first: float  # size of the first correction of the last load step
    least: float  # shortest load step

    loading: Loading

    @property
    def yielding(self) -> CurvesOfLaws: ...
    @property
    def plastic_flow(self) -> YieldingElements: ...

    # samples
    def forces_at_rest(self, time: float, nodes: np.ndarray) -> np.ndarray: ...
    def imbalance(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
    def elastic_tangent(self, time: float, g: np.ndarray, D: np.ndarray) -> np.ndarray: ...

    # Newton's method
    def bordered(
        self, columns: np.ndarray, g: np.ndarray, D: np.ndarray, phi: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def condense(self, columns: np.ndarray, D: np.ndarray) -> np.ndarray: ...
    def correction(self, time: float, known_tangent: Tangent | None = None) -> np.ndarray: ...
    def step_fraction(self, change: np.ndarray) -> float: ...
    def iterate(self, time: float) -> int: ...

    # configurations
    def change_from(self, start: np.ndarray) -> np.ndarray: ...
    def save_state(self) -> list[np.ndarray]: ...
    def shift(self, nodes: np.ndarray, change: np.ndarray) -> None: ...
    def size_of(self, change: np.ndarray) -> float: ...
    def restore_state(self, saved: list[np.ndarray]) -> None: ...

    # messages
    @property
    def forces(self) -> Residual: ...
