"""Runs of one case of the stability matrix over its range, and what each of them came to.

A deck of decks/extreme says what must be true over the whole range, in its `expect:` entries; a
Sweep says how the range is run and how a run must end. Test and page (STABILITY.md) read the same.
"""

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from subprocess import TimeoutExpired

import numpy as np
import yaml
from command import crashsolve

from crashpost.results.result import Result
from crashpost.values.expectation import Verdict, check_expectations

DECKS = Path(__file__).resolve().parents[2] / "decks"
RATTLE = ("rattle",)
STIFF = ("generalized_alpha", "radau_iia_5")
ALL = (*RATTLE, "dormand_prince_5", *STIFF)
# beside contacts and corners order 8 is the time stepper of order 5: it is tried on smooth motions
EXPLICIT = ("rattle", "dormand_prince_5", "dormand_prince_8")
# The error of a step counts over the largest speed in the model, and decks ask for 0.1 % of every
# body's own: where that is 1e-6 of the largest, as in grazing, a step may err by 1e-10 at most.
TOLERANCES = {"generalized_alpha": "1e-10", "radau_iia_5": "1e-7"}
# what the two kinds of honest failure look like: place and advice, or time, location, cause and
# advice
REFUSED = re.compile(r"^[^\n]*\.yaml:\d+:\d+: error: .+: .+", re.MULTILINE)
STOPPED = re.compile(r"^t = \S+ s, cycle \d+, .+: .+; .+", re.MULTILINE)
ENDS = {"ends": (0, re.compile("")), "is refused": (2, REFUSED), "stops": (4, STOPPED)}
# where round-off decides: within its bounds, or stopped
EITHER = "ends or stops"
# a run of a few thousand steps costs less as plain Python than its compiler
PLAIN = "CRASHSOLVE_PLAIN"

# deviations that no channel can state: (what, measured, bound)
Look = Callable[[Result, dict[str, str]], Iterator[tuple[str, float, float]]]


@dataclass(frozen=True)
class Sweep:
    """A range of one setting of a deck, and how every run over it must end."""

    case: str
    deck: str  # below decks/, without .yaml
    setting: str  # parameter, or field of control as control.step
    values: tuple[float, ...]
    end: str = "ends"  # or "is refused", "stops", EITHER
    says: str = ""  # what the message must contain, a regular expression
    integrators: tuple[str, ...] = RATTLE
    also: dict[str, str] = field(default_factory=dict)
    quick: tuple[float, ...] = ()  # values for the normal suite, as plain Python
    look: Look | None = None
    make: Callable[[int], dict[str, object]] | None = None  # writes the deck for a number of bodies

    @property
    def path(self) -> Path:
        return DECKS / f"{self.deck}.yaml"

    @property
    def name(self) -> str:
        """A word for the test's name."""
        return re.sub(r"\W+", "-", f"{self.case}-{self.end}").strip("-")


@dataclass(frozen=True)
class Outcome:
    """How a run ended, and how far it was from what it must be."""

    code: int
    message: str
    balance: float  # largest energy error, % of the largest energy
    residual: float  # largest constraint error over the model's size
    deviations: list[tuple[str, float, float]]  # what, measured, bound
    is_finite: bool
    steps: int = 0
    cpu: float = 0.0  # of the steps alone [s]

    @property
    def worst(self) -> tuple[float, str]:
        """Largest deviation in units of its bound, and what it is of."""
        shares = ((_share(got, bound), what) for what, got, bound in self.deviations)
        return max(shares, default=(0.0, ""))

    def faults(self, sweep: Sweep) -> list[str]:
        """Everything that breaks the promise of the sweep."""
        end = ("ends" if self.code == 0 else "stops") if sweep.end == EITHER else sweep.end
        code, pattern = ENDS[end]
        says = "" if end == "ends" else sweep.says
        all_faults = []
        if self.code != code:
            all_faults.append(f"exit code {self.code} instead of {code}: {self.message[-500:]}")
        elif not (pattern.search(self.message) and re.search(says, self.message)):
            all_faults.append(f"unclear message: {self.message[-500:]}")
        if re.search("Traceback|Warning:", self.message):
            all_faults.append(f"not meant for a user: {self.message[-500:]}")
        if not self.is_finite:
            all_faults.append("a file holds a number that is not finite")
        wrong = [d for d in self.deviations if not d[1] <= d[2]] if code == 0 else []
        return all_faults + [
            f"{what}: off by {got:.3g}, allowed {bound:.3g}" for what, got, bound in wrong
        ]


def requested(sweep: Sweep, integrator: str) -> dict[str, str]:
    """Settings beside the one that is swept."""
    closely = {"control.tolerance": TOLERANCES[integrator]} if integrator in TOLERANCES else {}
    settings = closely | sweep.also
    settings.pop(sweep.setting, None)
    # a step made without an estimate of its error has no use for a tolerance
    return {k: v for k, v in settings.items() if (integrator, k) != ("rattle", "control.tolerance")}


def run(sweep: Sweep, value: float, integrator: str, folder: Path, plain: bool) -> Outcome:
    """One run of a sweep."""
    settings = {
        **requested(sweep, integrator),
        sweep.setting: f"{value!r}",
        "control.integrator": integrator,
    }
    # what is true is known
    settings["control.estimate"] = "off"
    if integrator != "rattle":
        settings = {"control.step": "auto", **settings}
    deck = sweep.path
    if sweep.make:
        del settings[sweep.setting]
        deck = folder.with_suffix(".yaml")
        deck.write_text(yaml.safe_dump(sweep.make(int(value)), sort_keys=False), "utf-8")
    words = [word for name, text in settings.items() for word in ("--set", f"{name}={text}")]
    environment = {PLAIN: "1"} if plain else {}
    try:
        done = crashsolve(deck, "-o", folder, *words, **environment)
    except TimeoutExpired:
        return Outcome(-1, "the run does not come to an end", 0.0, 0.0, [], True)
    return outcome(done.returncode, done.stderr, folder, settings, sweep.look)


def outcome(
    code: int, message: str, folder: Path, settings: dict[str, str], look: Look | None = None
) -> Outcome:
    """What a run has left in its folder."""
    if not (folder / "history.h5").exists():
        return Outcome(code, message, 0.0, 0.0, [], True)
    result = Result(folder)
    status = json.loads((folder / "status.json").read_text("utf-8"))
    balance = np.abs(result.series("glstat.model.balance").values).max(initial=0.0)
    residual = result.series("glstat.model.residual").values.max(initial=0.0)
    deviations = []
    if code == 0:
        deviations = [_deviation(verdict) for verdict in check_expectations(result)]
        deviations += look(result, settings) if look else []
    return Outcome(
        code,
        message,
        float(balance),
        float(residual),
        deviations,
        finite(result),
        status["cycle"],
        status["cpu_steps"],
    )


def _deviation(verdict: Verdict) -> tuple[str, float, float]:
    expected, deviation = verdict.expected, verdict.deviation
    what = f"{expected.channel} {expected.statistic}"
    return what, np.inf if deviation is None else abs(deviation), expected.allowed


def finite(result: Result) -> bool:
    """Whether every number in the histories and in status.json is finite."""
    status = json.loads((result.folder / "status.json").read_text("utf-8"))
    numbers = [value for value in status.values() if isinstance(value, float)]
    series = (result.series(channel.name).values for channel in result.channels("*"))
    return bool(np.isfinite(numbers).all() and all(np.isfinite(x).all() for x in series))


def _share(got: float, bound: float) -> float:
    if got <= 0.0:
        return 0.0
    return got / bound if bound > 0.0 else np.inf
