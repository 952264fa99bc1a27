"""What a finished run states about itself: remarks in status.json, and warnings in the log."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from crashsolve.deck.reading.deck import Deck
from crashsolve.output.files import Json
from crashsolve.simulation.injury_samples import InjurySamples
from crashsolve.simulation.missed import missed_contacts, missed_curves
from crashsolve.simulation.missed_motions import missed_motions
from crashsolve.simulation.redundant import arbitrary_reactions, undetermined
from crashsolve.simulation.remarks import range_warnings, remarks
from crashsolve.system.contact.balance import contact_warnings
from crashsolve.system.engine import Engine
from crashsolve.system.flags import law_warnings

if TYPE_CHECKING:
    from crashsolve.output.peaks import Extremes
    from crashsolve.simulation.missed_motions import MissedMotion


class Ending:
    """The end of a run, whose files in `folder` are closed; samples every `interval` [s].

    `motions` are those that the samples miss, where the estimates of errors have looked for them.
    """

    def __init__(
        self,
        engine: Engine,
        deck: Deck,
        folder: Path,
        interval: float,
        motions: "list[MissedMotion] | None" = None,
    ) -> None:
        self.engine, self.deck, self.interval, self.motions = engine, deck, interval, motions
        self.history = folder / "history.h5"
        self.injury = InjurySamples(deck, folder, interval)
        self.undetermined = undetermined(engine)

    def remarks(self, extremes: "Extremes") -> Json:
        """Entries of status.json; `extremes` of all channels."""
        own = {"undetermined": self.undetermined}
        return remarks(self.engine, extremes, self.history) | own | self.injury.remarks()

    def warnings(self) -> Iterator[str]:
        """Warnings for the log."""
        engine = self.engine
        yield from law_warnings(engine.model, engine.state)
        yield from range_warnings(engine)
        contacts = [m for m in missed_contacts(engine, self.history) if m.is_hidden]
        curves = [c for c in missed_curves(engine, self.history) if c.is_hidden]
        yield from (missed.words(self.interval) for missed in (*contacts, *curves))
        if not contacts and not curves:
            motions = self.motions
            if motions is None:
                motions = missed_motions(engine, self.history, self.deck)
            yield from (missed.words() for missed in motions[:1])
        yield from self.injury.warnings()
        yield from arbitrary_reactions(self.undetermined, self.deck)
        if self.deck.control.solution == "transient":
            yield from contact_warnings(engine.model, engine.state, engine.ledger)
        yield from engine.step_warnings()
