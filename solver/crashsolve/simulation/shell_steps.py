"""A remark on the default of `control.safety` where shells take part in explicit steps."""

from crashsolve.deck.reading.deck import Deck
from crashsolve.model.model import Model

# theory/shells.md
OF_SHELLS = 0.9


def remark_on_safety(deck: Deck, model: Model) -> list[str]:
    """That steps of shells are a ninth of what is stable, where the deck leaves it to the default.

    The bound of shells is rigorous, see theory/shells.md; the default is for accuracy of springs.
    """
    control = deck.control
    given = control.model_fields_set & {"step", "safety", "accuracy"}
    is_explicit = model.integrator == "rattle" and control.solution == "transient"
    has_shells = any(part.type == "shell" for part in deck.entries["parts"].values())
    if given or not is_explicit or not has_shells:
        return []
    return [
        f"control.safety is {control.safety:g} when absent, for the accuracy of springs; where "
        f"shells set the step, {OF_SHELLS:g} is stable too, in a ninth of the steps"
    ]
