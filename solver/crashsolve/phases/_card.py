"""Fields that the cards of all phases share."""

from crashsolve.deck.card import Card, quantity


class PhaseCard(Card):
    """A stretch of the run's time."""

    end_time: float | None = quantity(
        "s",
        "time at which it ends; absent in the last phase, which ends with the run",
        default=None,
    )
