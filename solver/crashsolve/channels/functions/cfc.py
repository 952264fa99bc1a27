"""Channel frequency class: the low-pass filter of crash tests, without a shift in time.

A Butterworth filter of two poles runs forwards and backwards, at omega_d = 2 pi 2.0775 CFC. Before
the first sample and after the last the history is continued by its odd reflection, for two periods
of 2.0775 CFC, and each pass starts as if its first value had always been: so a constant stays what
it is, and the values within such a period of an end of the run are unreliable. Let a run
begin before the impact.

Samples in equal intervals are filtered as they are. Others, as where a deck asks for further times,
are brought to equal intervals, their median, by straight lines, and back: an error of second order
in the interval. No interval may be longer than 1 / (10 CFC), as J211 asks. That does not protect
from aliasing: samples are values of one moment, and a vibration above half the sampling rate looks
like a slow one, which no filter removes. Give `output.history.interval` a tenth of the period of
the fastest vibration of the channel, and compare with half of it; errors that a run estimates show
what is left.

References: SAE J211-1 (2014), Appendix C; ISO 6487 (2015), Annex A.
"""

import math

import numpy as np

from crashsolve.channels.errors import ChannelError, TooShort
from crashsolve.channels.term import Term

SAMPLED = True
CLASSES = (60, 180, 600, 1000)
# corner of one pass [Hz] over the class
CORNER = 2.0775
# samples that J211 requires in a time of 1 / CFC
RATE = 10
# intervals that differ by less than this share are equal
EQUAL = 1e-6
# samples that two poles need before and after
LEAST = 10


def apply(time: np.ndarray, x: Term, cfc: Term) -> Term:
    """The filtered history; raises ChannelError for an unknown class or too few samples."""
    if cfc.unit is not None or np.ndim(cfc.values) or cfc.values not in CLASSES:
        raise ChannelError(f"cfc() has the classes {', '.join(map(str, CLASSES))}")
    grid = _grid(time, int(cfc.values))
    if grid is None:
        return Term(_filtered(x.over(time), int(cfc.values), _interval(time)), x.unit)
    even = np.interp(grid, time, x.over(time))
    smooth = _filtered(even, int(cfc.values), float(grid[1] - grid[0]))
    return Term(np.interp(time, grid, smooth), x.unit)


def _interval(time: np.ndarray) -> float:
    return float(time[-1] - time[0]) / (len(time) - 1)


def _grid(time: np.ndarray, cfc: int) -> np.ndarray | None:
    """Equal intervals that cover unequal ones; None for equal ones; raises ChannelError."""
    if len(time) < LEAST:
        raise TooShort(f"cfc() needs {LEAST} samples or more, not {len(time)}")
    period = 1.0 / (CORNER * cfc)
    if time[-1] - time[0] < period:
        # its padding would rule the answer
        raise TooShort(
            f"cfc(..., {cfc}) needs a history of {1e3 * period:.4g} ms or more, a period of its "
            f"corner, not of {1e3 * float(time[-1] - time[0]):.4g} ms"
        )
    steps = np.diff(time)
    longest, wanted = float(np.max(steps)), 1.0 / (RATE * cfc)
    if longest > wanted * (1.0 + EQUAL):
        raise ChannelError(_too_rare(time, steps, cfc, wanted))
    mean = _interval(time)
    if np.max(np.abs(steps - mean)) <= EQUAL * mean:
        return None
    # sparse enough for memory at any intervals
    step = max(float(np.median(steps)), mean / 4.0)
    grid: np.ndarray = time[0] + step * np.arange(math.ceil((time[-1] - time[0]) / step) + 1)
    return grid


def _too_rare(time: np.ndarray, steps: np.ndarray, cfc: int, wanted: float) -> str:
    """Message of the sampling interval and of that which the filter class needs."""
    usual, at = float(np.median(steps)), int(np.argmax(steps))
    needs = f"cfc(..., {cfc}) needs samples every {1e3 * wanted:.4g} ms or more often"
    advice = f"give output.history.interval {1e3 * wanted:.4g} ms or less"
    if usual > wanted * (1.0 + EQUAL):
        return f"{needs}, not every {1e3 * usual:.6g} ms: {advice}"
    gaps = int(np.sum(steps > wanted * (1.0 + EQUAL)))
    if gaps > 1:
        # a run samples what happens between samples more often
        return f"{needs}, and {gaps} are up to {1e3 * float(steps[at]):.6g} ms apart: {advice}"
    return (
        f"{needs}; there is one every {1e3 * usual:.6g} ms, but none for "
        f"{1e3 * float(steps[at]):.6g} ms from {1e3 * float(time[at]):.6g} ms on: "
        "ask for times after that gap, or take the steps of the run shorter there"
    )


def _filtered(values: np.ndarray, cfc: int, interval: float) -> np.ndarray:
    """Both passes over values (n,) in equal intervals [s]."""
    try:
        from scipy import signal
    except ImportError:
        raise ChannelError("cfc() needs scipy: pip install 'crashsolve[signal]'") from None
    corner = CORNER * cfc
    b, a = signal.butter(2, corner, fs=1.0 / interval)
    beyond = min(math.ceil(2.0 / (corner * interval)), len(values) - 1)
    smoothed: np.ndarray = signal.filtfilt(b, a, values, padtype="odd", padlen=beyond)
    return smoothed
