"""The report: one HTML page that holds everything and can be sent as it is.

A figure that cannot be drawn is replaced by the reason; the reasons are also returned.
"""

from collections.abc import Sequence
from datetime import UTC, datetime
from itertools import islice

from crashpost.compare.references import Comparison, comparisons
from crashpost.errors import PostError
from crashpost.figures import draw, gallery
from crashpost.figures.page import (
    EXPECTED,
    MISSED_PUBLISHED,
    block,
    details,
    escape,
    figure,
    page,
    table,
    tiles,
)
from crashpost.reports.views import views
from crashpost.results import ledger, logbook
from crashpost.results.result import Result
from crashpost.results.table import number
from crashpost.values import injury_table, words
from crashpost.values.accuracy import HEADER as ERRORS
from crashpost.values.accuracy import accuracy_rows, cost_rows, worst_error
from crashpost.values.events import events
from crashpost.values.expectation import Verdict, check_expectations
from crashpost.values.figure import Figure, figures_of
from crashpost.values.injury_measure import HEADER, NUMERIC
from crashpost.values.summary import BASIS, Peak, peaks, status_line
from crashpost.values.units import PageUnits, Units, on_page, page_time_unit
from crashsolve.channels.display import factor, readable

OPEN_PEAKS, MAX_PEAKS = 30, 1000
GOOD, BAD = {"finished"}, {"failed", "killed"}


def report(
    result: Result, pictures: str = "all", units: Units | None = None
) -> tuple[str, list[str]]:
    """The page, and the items that could not be shown; raises PostError for a broken description.

    `pictures` is all, strips (without film and 3-D) or none.
    """
    return _Report(result, pictures, units or Units()).page()


class _Report:
    def __init__(self, result: Result, pictures: str, units: Units) -> None:
        self.result, self.pictures, self.units = result, pictures, units
        self.described = result.stored_json("report", dict)
        requested = figures_of(self.described) if (self.described or {}).get("figures") else []
        self.chosen = requested or gallery.default_figures(result)
        self.time_unit = page_time_unit(result, requested, units)
        self.energy = gallery.energy_figures(result)
        self.momentum = gallery.momentum_figures(result)
        shown = [*self.chosen, *self.energy, *self.momentum]
        self.page_units = PageUnits(result, shown, units, self.time_unit)
        self.verdicts = check_expectations(result)
        self.problems: list[str] = []
        self.drawn = self.missed = 0

    def page(self) -> tuple[str, list[str]]:
        result = self.result
        sections = [
            block("pictures", "Pictures", self.views()),
            block("events", "What happened", _events(result, self.page_units)),
            block("curves", "Curves", self.figures(self.chosen)),
            block("injury", "Injury", _injury(result, self.page_units)),
            block("expectations", "Expectations", _verdicts(self.verdicts, self.page_units)),
            block("peaks", "Peaks", _peaks(result, self.page_units)),
            block("errors", "Estimated errors", _errors(result, self.page_units)),
            block(
                "energy", "Energy", _energies(result, self.page_units), self.figures(self.energy)
            ),
            block("momentum", "Momentum", self.figures(self.momentum)),
            block("cost", "Steps and cost", _cost(result, self.time_unit)),
            block("warnings", "Warnings", _warnings(result)),
            block("model", "Model", _model(result)),
            block("literature", "Literature of the laws used", _sources(result)),
            block("deck", "Deck", _deck(result)),
        ]
        body = [self.heading(sections), *sections, _footer(result)]
        return page(result.title, body), self.problems

    def views(self) -> str:
        """Pictures and films of the run."""
        try:
            text, problem = views(self.result, self.described, self.pictures, self.time_unit)
        except PostError as error:
            text, problem = "", str(error)
        if problem:
            self.problems.append(f"pictures: {problem}")
            text += f'<p class="problem">{escape(problem)}</p>'
        return text

    def heading(self, sections: Sequence[str]) -> str:
        state = str(self.result.status.get("state", "unknown"))
        css_class = "good" if state in GOOD else "bad" if state in BAD else ""
        line = status_line(self.result, self.time_unit).removeprefix(state).lstrip(", ")
        message = self.result.status.get("message")
        names = [s.split('"')[1] for s in sections if s]
        links = "".join(f'<a href="#{name}">{name.capitalize()}</a>' for name in names)
        return (
            '<header><div class="eyebrow">crashsolve result</div>'
            f"<h1>{escape(self.result.title)}</h1>"
            f'<p class="facts"><span class="state {css_class}">{escape(state)}</span>'
            f"{escape(line)}</p>"
            + (f'<p class="problem">{escape(str(message))}</p>' if message else "")
            + tiles(_facts(self.result, self.verdicts, self.missed))
            + f"<nav>{links}</nav></header>"
        )

    def figures(self, figures: Sequence[Figure]) -> str:
        if not figures or not len(self.result.time):
            return ""
        return f'<div class="figures">{"".join(map(self.figure, figures))}</div>'

    def figure(self, wanted: Figure) -> str:
        self.drawn += 1
        try:
            of = self.page_units.of
            wanted = on_page(self.result, wanted, self.units, self.time_unit, of)
            drawing, keys = draw.svg(self.result, wanted, f"f{self.drawn}")
            compared = comparisons(self.result, wanted)
            self.missed += sum(one.missed is True for one in compared)
            below = _comparisons(compared)
        except PostError as error:
            self.problems.append(f"figure '{wanted.title}': {error}")
            drawing, keys, below = (f'<p class="problem">{escape(str(error))}</p>', [], "")
        note = f'<p class="note">{escape(wanted.note)}</p>' if wanted.note else ""
        return figure(wanted.title, drawing, keys, note + below)


def _facts(result: Result, verdicts: list[Verdict], missed: int) -> list[tuple[str, str]]:
    """The few numbers that say whether the run can be trusted."""
    facts = []
    if verdicts:
        passed = sum(verdict.passed for verdict in verdicts)
        caption = "expectations met" if passed == len(verdicts) else EXPECTED
        facts.append((f"{passed} of {len(verdicts)}", caption))
    if missed:
        facts.append((str(missed), MISSED_PUBLISHED))
    for caption, value in (
        ("largest energy imbalance", ledger.worst_balance(result)),
        ("largest momentum imbalance", ledger.worst_momentum(result)),
    ):
        if value is not None:
            facts.append((f"{draw.tick(float(f'{value:.2g}'))} %", caption))
    error = worst_error(result)
    if error is not None:
        facts.append((f"{error:.1e}", "largest estimated error, of its channel's scale"))
    warnings = sum(count for count, _ in logbook.warnings(result.log))
    return [*facts, (str(warnings), "warning" if warnings == 1 else "warnings")]


def _comparisons(compared: list[Comparison]) -> str:
    rows = []
    for c in compared:
        percent = f" ({c.percent:+.3g}\u00a0%)" if c.percent else ""
        inside = c.low != c.high and not c.difference
        size = f"{c.difference:+.3g}" if c.difference else "0"
        # a number is not parted from its unit
        unit = f"\u00a0{c.unit}"
        difference = "in range" if inside else f"{size}{unit}{percent}"
        computed, published = f"{c.computed:.4g}{unit}", f"{c.published}{unit}"
        verdict = {None: "", True: "missed", False: "met"}[c.missed]
        rows.append([c.label, computed, published, difference, verdict, c.source])
    header = ("", "this run", "published", "difference", "", "source")
    return table(header, rows, ("", "num", "num", "num", "", ""))


def _verdicts(verdicts: list[Verdict], page_units: PageUnits) -> str:
    rows = []
    for one in verdicts:
        verdict = one.in_unit(page_units.unit(one.unit), page_units.size(one.unit))
        expected = verdict.expected
        value = "-" if verdict.computed is None else f"{verdict.computed:.7g}"
        deviation = "-" if verdict.deviation is None else f"{verdict.deviation or 0:.2g}"
        numbers = [value, f"{expected.value:.7g}", expected.tolerance_text, deviation, verdict.unit]
        reason = verdict.problem or f"{expected.because}: {expected.source}"
        outcome = "pass" if one.passed else "FAIL"
        statistic = expected.statistic_over(page_units.unit("s"))
        rows.append([outcome, expected.channel, statistic, *numbers, reason])
    header = (
        "",
        "channel",
        "statistic",
        "found",
        "expected",
        "tolerance",
        "deviation",
        "",
        "because",
    )
    return table(header, rows, ("", "name", "", "num", "num", "num", "num", "unit", ""))


def _errors(result: Result, page_units: PageUnits) -> str:
    """The watched channels, each with its estimated error and how that was found."""
    rows = accuracy_rows(result, lambda unit: (page_units.unit(unit), page_units.size(unit)))
    return table(ERRORS, rows, ("name", "num", "unit", "num", "num", ""))


def _cost(result: Result, time_unit: str) -> str:
    return table(("", "value"), cost_rows(result, time_unit), ("", "num"))


def _energies(result: Result, page_units: PageUnits) -> str:
    entries = ledger.energies(result) if len(result.time) else []
    largest = max((entry.largest for entry in entries), default=0.0)
    unit = page_units.of.get("J") or readable("J", largest)
    rows = []
    for entry in entries:
        values = entry.series.values * factor("J", unit)
        share = 100 * entry.largest / largest
        numbers = [
            f"{value:.4g}" for value in (values[0], values[-1], entry.largest * factor("J", unit))
        ]
        rows.append([entry.label, *numbers, f"{share:.3g} %"])
    header = ("energy", f"initial, {unit}", f"final, {unit}", f"largest, {unit}", "of the largest")
    return table(header, rows, ("", "num", "num", "num", "num"))


def _warnings(result: Result) -> str:
    rows = [[str(count), text] for count, text in logbook.warnings(result.log)]
    return table(("times", "warning"), rows, ("num", ""))


def _events(result: Result, page_units: PageUnits) -> str:
    size = page_units.size("s")
    rows = [[number(event.time * size), event.text] for event in events(result, page_units.of)]
    return table((f"at, {page_units.unit('s')}", "what"), rows, ("num", ""))


def _injury(result: Result, page_units: PageUnits) -> str:
    rows = injury_table.table(result, page_units.of)
    note = f"<p class=note>{' '.join(injury_table.notes(rows))}</p>" if rows else ""
    return table(HEADER, rows, tuple("num" if head in NUMERIC else "" for head in HEADER)) + note


def _peaks(result: Result, page_units: PageUnits) -> str:
    rows = [_peak_row(peak, page_units) for peak in islice(peaks(result), MAX_PEAKS + 1)]
    time_unit = page_units.unit("s")
    header = ("channel", "unit", "least", f"at, {time_unit}", "greatest", f"at, {time_unit}")
    classes = ("name", "", "num", "num", "num", "num")
    note = f"<p class=note>{escape(words.capital(BASIS))}.</p>"
    note *= any(".peak_" in row[0] for row in rows)
    if len(rows) <= OPEN_PEAKS:
        return table(header, rows, classes) + note
    more = len(rows) > MAX_PEAKS
    title = (
        f"The first {MAX_PEAKS} channels; peaks.txt has all" if more else f"{len(rows)} channels"
    )
    return details(title, table(header, rows[:MAX_PEAKS], classes) + note)


def _peak_row(peak: Peak, page_units: PageUnits) -> list[str]:
    along, size = page_units.size("s"), page_units.size(peak.unit)
    shown = peak._replace(
        unit=page_units.unit(peak.unit),
        least=peak.least * size,
        least_time=peak.least_time * along,
        greatest=peak.greatest * size,
        greatest_time=peak.greatest_time * along,
    )
    return shown.cells


def _model(result: Result) -> str:
    rows = [
        [family.name, str(len(family.ids)), _some(family.ids), family.meaning]
        for family in result.families.values()
    ]
    families = table(("family", "entities", "names", "holds"), rows, ("name", "num", "", ""))
    if result.chosen_channels:
        chosen = escape(", ".join(result.chosen_channels))
        families += f"<p class=note>By output.history.channels: {chosen}</p>"
    log = logbook.model_summary(result.log)
    return families + (details("Log of the start", f"<pre>{escape(log)}</pre>") if log else "")


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:8]) + (", ..." if len(names) > 8 else "")


def _sources(result: Result) -> str:
    """The literature behind the laws used."""
    citations = result.stored_json("citations", list) or []
    return "".join(f"<p>{escape(str(citation))}</p>" for citation in citations)


def _deck(result: Result) -> str:
    text = result.deck_text
    return details("Includes and parameters resolved", f"<pre>{escape(text)}</pre>") if text else ""


def _footer(result: Result) -> str:
    versions = (result.stored_json("versions", dict) or {}).items()
    facts = [f"{name} {version}" for name, version in versions]
    if "started" in result.attributes:
        facts.append(f"started {result.attributes['started']} on {result.attributes.get('host')}")
    written = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
    origin = f"<p>Run: {escape(', '.join(facts))}.</p>" if facts else ""
    return f"<footer>{origin}<p>Page written by crashpost on {written}.</p></footer>"
