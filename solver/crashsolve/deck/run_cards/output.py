"""Card `output`: files of a run, their intervals, and the figures of its report."""

import math
import re
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import field_validator, model_validator

from crashsolve.channels.series import Window
from crashsolve.channels.units import UnitError, to_si
from crashsolve.deck.card import Card, WhereWritten, quantity, word
from crashsolve.deck.run_cards.statistic import check_window, known_statistic

Pair = tuple[float, float]
MOMENT = r"start|end|(max|min|abs_max):.*\S|[-+]?[\d.]+([eE][-+]?\d+)? *(s|ms|us|µs)"
# interval [s]: a run of any length counts those that have passed
SHORTEST = 1e-15
VIEWS = ("auto", "side", "front", "rear", "top", "bottom", "iso")


class History(Card):
    """Time histories of all channels, or of those chosen."""

    interval: float | None = quantity(
        "s", "time between samples; a 1000th of the run when absent", None, ge=SHORTEST
    )
    channels: tuple[str, ...] | None = word(
        "names of the channels that are written, with globs, such as 'nodout.*' or "
        "'rcforc.*.force.x'; all when absent. Of a family every quantity and every entity that a "
        "name fits are written together. Always written are glstat without momenta, matsum, what "
        "shows events (normal forces, onsets and touches of contacts, plastic deformation, "
        "failure, deletion), what expect, watch, figures and scenes of the report need, and where "
        "errors are estimated the motions of bodies, by which the run sees what its samples miss. "
        "By --set, names with blanks between",
        None,
    )

    @field_validator("channels", mode="before")
    @classmethod
    def _listed(cls, given: Any) -> object:
        """The names in a text, with blanks between, as `--set` can give it."""
        return given.split() if isinstance(given, str) else given

    @field_validator("channels")
    @classmethod
    def _some(cls, given: tuple[str, ...] | None) -> tuple[str, ...] | None:
        if given is not None and not given:
            raise ValueError("name at least one channel, or leave the field out for all")
        return given


class States(Card):
    """Configurations of all bodies for pictures and films."""

    interval: float | None = quantity(
        "s",
        "time between states, without any others; when absent a 50th of the run, with states at "
        "the first touch of another contact, the largest contact force and the first yield too",
        None,
        ge=SHORTEST,
    )


class Restart(Card):
    """Dumps from which a run can continue."""

    every: float | None = quantity("s", "time between dumps; none when absent", None, ge=SHORTEST)


class Log(Card):
    """Lines about the progress of the run."""

    interval: float | None = quantity(
        "s", "time between lines; a 20th of the run when absent", None, ge=SHORTEST
    )


class Curve(Card):
    """One line of a figure, or the bare name of its channel."""

    shorthand: ClassVar[str] = "channel"

    channel: str = word("channel, or arithmetic of channels")
    label: str = word("name in the legend; the channel when empty", "")
    x: str = word("abscissa of this curve; that of the figure when empty", "")


class Reference(Card):
    """A result known from elsewhere, drawn with the curves and compared with them."""

    label: str = word("name in the legend")
    kind: Literal["level", "band", "point", "curve", "corridor"] = word("form of the mark", "level")
    value: float | None = quantity("1", "height of a level, in the unit of the axis", None)
    from_: float | None = quantity("1", "lower end of a band", None)
    to: float | None = quantity("1", "upper end of a band", None)
    points: tuple[Pair, ...] = quantity(
        "1", "[x, y] of a point, of a curve's points, or of a corridor's lower border", ()
    )
    upper: tuple[Pair, ...] = quantity("1", "[x, y] of a corridor's upper border", ())
    tolerance: float | None = quantity(
        "1", "uncertainty of the number; a larger difference counts as a miss", None, ge=0
    )
    source: str = word("publication of the reference", "")
    channel: str = word("channel to compare with it", "")
    statistic: str = word("statistic of that channel, as under expect; none for a corridor", "")
    during: Window | None = quantity("s", "[from, to], when only these samples count", None)
    over: Pair | None = quantity("1", "extent of a level or band along x", None)

    @field_validator("statistic")
    @classmethod
    def _known_statistic(cls, text: str) -> str:
        return known_statistic(text) if text else text

    @model_validator(mode="after")
    def _complete(self) -> "Reference":
        has_band = self.from_ is not None and self.to is not None
        given = {"level": self.value is not None, "band": has_band}
        given["corridor"] = min(len(self.points), len(self.upper)) > 1
        if not given.get(self.kind, len(self.points) > (self.kind == "curve")):
            needs = {"level": "value", "band": "from and to", "corridor": "points and upper"}.get(
                self.kind, "points"
            )
            raise ValueError(f"a {self.kind} needs {needs}")
        if self.kind == "corridor":
            self._check_corridor()
        elif bool(self.channel) != bool(self.statistic):
            raise ValueError("channel and statistic belong together")
        check_window(self.statistic, self.during)
        return self

    def _check_corridor(self) -> None:
        if self.statistic:
            raise ValueError("a corridor is compared with a whole channel; leave out the statistic")
        for border in (self.points, self.upper):
            if any(b <= a for (a, _), (b, _) in pairwise(border)):
                raise ValueError("along a border of a corridor x must increase")


class Figure(Card):
    """One figure of the report; its numbers are in the units of its axes."""

    title: str = word("heading")
    y: tuple[Curve, ...] = word("channels drawn")
    x: str = word("channel of the abscissa, or time", "time")
    x_unit: str = word("unit shown along x; SI when empty", "")
    y_unit: str = word("unit shown along y; SI when empty", "")
    x_scale: Literal["linear", "log"] = word("division of the x axis", "linear")
    y_scale: Literal["linear", "log"] = word("division of the y axis", "linear")
    x_offset: float = quantity("1", "offset added to x, in the unit shown", 0.0)
    y_offset: float = quantity("1", "offset added to y, in the unit shown", 0.0)
    x_label: str = word("title of the x axis", "")
    y_label: str = word("title of the y axis", "")
    x_range: Pair | None = quantity("1", "ends of the x axis", None)
    y_range: Pair | None = quantity("1", "ends of the y axis", None)
    reference: tuple[Reference, ...] = word("published or measured results", ())
    note: str = word("text below the figure", "")

    @model_validator(mode="after")
    def _corridors_over_time(self) -> "Figure":
        if self.x != "time" and any(r.kind == "corridor" and r.channel for r in self.reference):
            raise ValueError("a channel is compared with a corridor over time alone")
        return self


def _is_list(given: object) -> bool:
    return isinstance(given, list | tuple)


def _is_number(given: object) -> bool:
    return isinstance(given, int | float) and not isinstance(given, bool)


def _is_length(text: str, above: float = -math.inf) -> bool:
    try:
        return above < to_si(text.strip(), "m") < math.inf
    except UnitError:
        return False


class Scene(Card):
    """Pictures of the run side by side in the report, as `crashpost render` makes them."""

    title: str = word("heading")
    at: tuple[str, ...] = word(
        "moments: 50 ms, start, end, max:CHANNEL, min:CHANNEL, abs_max:CHANNEL; four over the run "
        "when absent",
        (),
    )
    view: str = word("side, front, rear, top, bottom, iso, or towards the eye as 1,-1,0.5", "auto")
    show: tuple[str, ...] = word(
        "names of bodies and parts, with globs, and springs or belts; all when absent", ()
    )
    color: str = word("field of the states such as plastic_strain; by body when empty", "")
    arrows: str = word("rcforc, rcforc.CONTACT or velocity; none when empty", "")
    follow: str = word("body or part that the camera follows", "")
    close_up: str = word(
        "contact, body or part of which a second row shows close-ups; 'buffers:1 m' states the "
        "width of the window; none when empty",
        "",
    )
    cut: str = word(
        "half space that is drawn, such as y<0 or x > 100 mm; everything when empty", ""
    )
    magnify: float = quantity(
        "1",
        "factor on displacements, for small ones; the picture is labelled with it",
        1.0,
        gt=0,
    )

    @field_validator("cut")
    @classmethod
    def _known_side(cls, given: str) -> str:
        match = re.fullmatch(r"\s*[xyz]\s*[<>]\s*([-+.\deE]+\s*[a-z]*)\s*", given)
        if given and not (match and _is_length(match[1])):
            raise ValueError("write what is drawn, such as 'y<0' or 'x > 100 mm'")
        return given

    @field_validator("close_up")
    @classmethod
    def _known_window(cls, given: str) -> str:
        _, colon, width = given.partition(":")
        if colon and not _is_length(width, above=0.0):
            raise ValueError("write NAME or NAME:WIDTH, such as 'buffers:1 m'")
        return given

    @field_validator("arrows")
    @classmethod
    def _known_arrows(cls, given: str) -> str:
        if given not in ("", "velocity") and given.partition(".")[0] != "rcforc":
            raise ValueError("write rcforc, rcforc.CONTACT or velocity")
        return given

    @field_validator("at", mode="before")
    @classmethod
    def _known_moments(cls, given: Any) -> object:
        """Times as words; a bare number is refused where its unit would be unclear."""
        if not _is_list(given):
            return given
        words = ["0" if _is_number(part) and part == 0 else part for part in given]
        for part in words:
            if _is_number(part):
                raise ValueError(f"a moment needs its unit: {part:g} s")
            if not isinstance(part, str):
                raise ValueError("a moment is text, such as 50 ms, start or max:CHANNEL")
            if part != "0" and not re.fullmatch(MOMENT, part.strip()):
                raise ValueError(
                    f"unknown moment '{part}' (50 ms, start, end, or max:, min: or abs_max: before "
                    "a channel)"
                )
        return words

    @field_validator("view")
    @classmethod
    def _known_view(cls, text: str) -> str:
        if text not in VIEWS:
            numbers = text.split(",")
            try:
                is_direction = len(numbers) == 3 and any(map(float, numbers))
            except ValueError:
                is_direction = False
            if not is_direction:
                raise ValueError(f"unknown view '{text}' (known: {', '.join(VIEWS)}, or 1,-1,0.5)")
        return text


class Report(Card):
    """The page that `crashpost report` makes."""

    figures: tuple[Figure, ...] = word("figures, in order; a default choice when absent", ())
    scenes: tuple[Scene, ...] = word("pictures, in order; a default choice when absent", ())


class Output(Card):
    """The files that a run writes, and their intervals."""

    # defaults need no validator, which takes 2 ms to make for each
    history: History = word("time histories", History.model_construct())
    states: States = word("configurations", States.model_construct())
    restart: Restart = word("restart dumps", Restart.model_construct())
    log: Log = word("log lines", Log.model_construct())
    report: Annotated[Report | None, WhereWritten()] = word(
        "figures of the report; a default choice when absent", None
    )
