"""An equilibrium that was found, for further runs of the same model: they need no other search.

It holds what the search has written (`start.py`): positions and velocities of the nodes, and
deflections of standing tyres. Consequence to test: a run that takes it over has the samples of one
that searches, to the bit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.model.contact.pairs import renew

if TYPE_CHECKING:
    from crashsolve.system.engine import Engine


class Equilibrium:
    """Nodes and histories of groups with which a run begins; `note` describes them in the log."""

    def __init__(self, engine: Engine, note: str) -> None:
        self.note, self._nodes = note, engine.state.nodes.copy()
        self._histories = [group.history.copy() for group in engine.model.groups]

    def restore(self, engine: Engine) -> None:
        """Begin another engine of the model from it. Writes: state.nodes, histories, pairs."""
        engine.state.nodes[:] = self._nodes
        for group, history in zip(engine.model.groups, self._histories, strict=True):
            group.history[:] = history
        renew(engine.model.contact_groups, engine.state)
        engine.bind()
        engine.sample_of(engine.state.nodes)
