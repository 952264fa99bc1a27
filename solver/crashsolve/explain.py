"""Explanation of a scene: the laws it uses, the blocks left out, and the composed step."""

from crashsolve.deck.keywords import SECTIONS
from crashsolve.deck.laws import types_in
from crashsolve.deck.reading.deck import Deck
from crashsolve.model.model import Model
from crashsolve.system.compose import compose


def explain(deck: Deck, model: Model) -> str:
    """A page of plain text: model, laws in use, laws left out, composed step."""
    lines = [f"{deck.title or deck.path.name}", ""]
    lines += [
        f"bodies {len(model.bodies) - 1}, joints {len(model.joints)} "
        f"({model.saddle.rows()} constraint rows), "
        f"contact pairs {sum(len(c.parameters) for c in model.contact_groups)}",
        f"mass {model.total_mass():.6g} kg, size {model.size:.4g} m",
        f"integrator {': '.join(filter(None, (model.integrator, model.choice)))}",
        "",
        "in use",
    ]
    used: dict[str, set[str]] = {}
    for keyword, entries in deck.entries.items():
        if entries:
            used[keyword] = {entry.type for entry in entries.values()}
            lines.append(f"  {keyword}: {', '.join(sorted(used[keyword]))}")
    for entry in deck.written_out:
        used.setdefault(entry.item.keyword, set()).add(entry.type)
        message = f"{entry.type} '{entry.name}'"
        lines.append(f"  {entry.item.keyword}: {message}, written out in these (--expanded)")
    for group in model.contact_groups:
        lines.append(f"  contact loop: {group.word}, pairs {len(group.parameters)}")
    for nodal in model.nodal_groups:
        kind = "a shape" if nodal.narrow is not None else "faces"
        lines.append(f"  contact loop: {nodal.word}, {len(nodal.arrays['probes'])} on {kind}")
    lines += ["", "left out of this scene's compiled step"]
    for keyword, section in SECTIONS.items():
        left = sorted(set(types_in(section.folder)) - used.get(keyword, set()))
        if left:
            lines.append(f"  {keyword}: {', '.join(left)}")
    lines += ["", "composed step", "-" * 13, compose(model)]
    return "\n".join(lines)
