"""Content of log.txt besides its cycle lines: the model summary and the warnings."""

import re

_WARNING = re.compile(r"^warning: (.*)$", re.MULTILINE)
_COUNTED = re.compile(r"^ +(\d+) x  (.*)$", re.MULTILINE)
_CYCLE_HEADER = re.compile(r"^ *cycle +time", re.MULTILINE)


def model_summary(log: str) -> str:
    """Everything before the first cycle line."""
    header = _CYCLE_HEADER.search(log)
    return (log[: header.start()] if header else log).strip("\n")


def warnings(log: str) -> list[tuple[int, str]]:
    """(count, text) of every distinct warning; from the closing table when the run got there."""
    closing = log.rfind("\nwarnings: ")
    if closing >= 0:
        return [(int(count), text) for count, text in _COUNTED.findall(log, closing)]
    return [(1, text) for text in dict.fromkeys(_WARNING.findall(log))]
