"""Laws as machine code with bounds checked: the numbers of plain Python, and the tests of all laws.

Those of losses and stiffness (test_losses_and_stiffness.py) run in this mode alone. A law that
reads or writes beyond a table ends them with its file and line.
"""

import numpy as np
import pytest
import test_every_law as every
from compiled_laws import compiled

from crashsolve.compiler.machine import BoundsError, runs_plain


@every.each(every.FORCES)
def test_compiled_it_has_the_numbers_of_plain_python(
    law: tuple[str, str],
) -> None:
    both = every.example(law), compiled(law)
    for _ in range(5):
        for one in both:
            every.moving(one, 1)
            one.bench.drift(0.05)
            one.force(0.05)
        plain, checked = both
        for name in ("force", "torque", "stiffness", "damping"):
            there = plain.bench.nodes[name]
            # round-off of some sums: contraction changes the last digits
            bound = 1e-11 * (1.0 + np.abs(there).max())
            np.testing.assert_allclose(checked.bench.nodes[name], there, rtol=0.0, atol=bound)
        for one in both:
            one.accept()


@every.each(every.FORCES)
def test_compiled_it_writes_every_column_and_balances(
    law: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(every, "example", compiled)
    every.test_every_column_is_written_and_the_past_is_kept(law)
    if law in every.BETWEEN:
        every.test_action_equals_reaction_also_in_moment(law, 0)
    else:
        # a load; the ledger of the others is kept by test_losses_and_stiffness.py
        every.test_work_is_stored_or_lost_or_done_from_outside(law, 1)


@pytest.mark.skipif(runs_plain(), reason="plain Python counts negative indices from the end")
def test_a_law_that_leaves_its_table_is_named() -> None:
    one = compiled(("springs", "linear"))
    one.p.node_b = wrong = len(one.bench.nodes) + 6
    said = (
        rf"springs/_between\.py:\d+: line_of_action: `nodes\[p\.node_b\]`: {wrong} is out of bounds"
    )
    with pytest.raises(BoundsError, match=said):
        one.force()
