"""Consecutive pairs of a group on the same two bodies, under one card."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.model.contact.groups import ContactGroup

# see system/contact/body_pairs.py
BODY_PAIR = Record("""
    first                index  first pair
    end                  index  first pair after it
    card                 index  contact card of all of them
    node_a               index  body of side a
    node_b               index  body of side b
    reach_a              m      largest extent of the elements of side a from the mass centre
    reach_b              m      the same for side b
    thick                m      least half thickness of both sides
    skipped              flag   1 while none of its pairs is evaluated
    changes              count  how often histories have changed as that began, or since
    depth                m      of the deepest, at the last evaluation
    approached           m      bound of the approach of the bodies since
    approach             m      the same of the step that ends
    bound                m      as depth, but with what samples have evaluated since
    dissipated           J      by the normal forces of all
    friction_dissipated  J      by their friction
""")


def find_body_pairs(groups: Iterable[ContactGroup]) -> None:
    """Find pairs on the same bodies of a group with one list of pairs that are skipped while
    separated.

    Writes: groups.
    """
    for group in groups:
        if group.skips and group.search is None and not group.in_pieces:
            group.body_pairs = body_pairs_of(group, group.parameters)


def body_pairs_of(group: ContactGroup, pairs: np.ndarray) -> np.ndarray:
    """Which of these pairs of a group are on the same bodies; none is evaluated yet."""
    ends = [group.elements_a["node"][pairs["a"]], group.elements_b["node"][pairs["b"]]]
    keys = np.stack([pairs["card"], *ends])
    first = np.flatnonzero(np.diff(keys, axis=1, prepend=-1).any(axis=0))
    body_pairs = np.zeros(len(first), BODY_PAIR.dtype)
    body_pairs["first"], body_pairs["end"] = first, np.append(first, len(pairs))[1:]
    body_pairs["card"], body_pairs["node_a"], body_pairs["node_b"] = keys[:, first]
    if len(first):
        for name in ("reach_a", "reach_b"):
            body_pairs[name] = np.maximum.reduceat(pairs[name], first)
        body_pairs["thick"] = np.minimum.reduceat(pairs["thick"], first)
    return body_pairs
