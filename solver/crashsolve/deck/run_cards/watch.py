"""Card `watch`: numbers whose error a run estimates, without an expected value."""

from typing import ClassVar

from pydantic import field_validator, model_validator

from crashsolve.channels.series import Window
from crashsolve.deck.card import Card, quantity, word
from crashsolve.deck.run_cards.statistic import (
    PATH,
    channel_reported,
    check_window,
    known_statistic,
    words_reported,
)


class Watch(Card):
    """A channel whose error a run estimates, as it does for those of expect; or its bare name."""

    shorthand: ClassVar[str] = "channel"

    channel: str = word(channel_reported())
    statistic: str = word(f"{words_reported()}, or {PATH}: the whole history", PATH)
    during: Window | None = quantity("s", "[from, to], when only these samples count", None)

    @field_validator("statistic")
    @classmethod
    def _known_statistic(cls, text: str) -> str:
        return text if text == PATH else known_statistic(text)

    @model_validator(mode="after")
    def _has_window(self) -> "Watch":
        check_window(self.statistic, self.during)
        return self
