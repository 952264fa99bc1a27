"""The command `crashsolve DECK -o FOLDER` up to its first step; prints what it has used (start.py).

CPU time [s] of the process and of its compiler, peak memory [MB] of both, and whether the scene has
beams or shells. It imports no more than the command does.
"""

import gc
import os
import resource
import sys

PROCESSES = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)


def end_before_first_step(deck: str, folder: str) -> None:
    """Run the command until the first step begins, then report the time and memory used."""
    # as the command does before it imports these
    gc.set_threshold(500_000)
    from crashsolve.cli import main
    from crashsolve.deck.family import ELEMENTS, families
    from crashsolve.system.engine import Engine

    def end(engine: Engine, *_: object) -> None:
        used = [resource.getrusage(who) for who in PROCESSES]
        is_flexible = bool(engine.model.elements) or any(
            families()[g.keyword].picture == ELEMENTS for g in engine.model.force_groups()
        )
        times, peaks = [u.ru_utime + u.ru_stime for u in used], [u.ru_maxrss / 1024 for u in used]
        print([*times, *peaks, int(is_flexible)], flush=True)
        os._exit(0)

    def of_equilibria(cls: type[Engine]) -> None:
        for name in {"_step", "reach"} & set(vars(cls)):
            setattr(cls, name, end)

    # motion: every call of the compiled loop passes here, with samples and without. Engines of
    # equilibria are not imported for this
    Engine.within_pause = end  # type: ignore[method-assign]
    Engine.__init_subclass__ = classmethod(of_equilibria)  # type: ignore[assignment]
    sys.exit(main([deck, "-o", folder]))


if __name__ == "__main__":
    end_before_first_step(*sys.argv[1:])
