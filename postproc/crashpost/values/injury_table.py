"""All measures of injury of a result in one table, with their errors by the samples."""

from crashpost.results.result import Result
from crashpost.values import injury, occupant_injury
from crashpost.values.injury_measure import rows


def table(result: Result) -> list[list[str]]:
    """The measures as text, under injury_measure.HEADER; none without a role or before there are
    samples.
    """
    if len(result.time) < 2:
        return []
    return rows(result, lambda one: injury.measures(one) + occupant_injury.measures(one))
