"""A chain of bodies through joints, placed from its root: positions, rotations and velocities.

    A_b = A_a Q R_ab,   x_b = x_a + A_a s_a - A_b s_b
    w_b = w_a + A_a w_Q,   v_b = v_a + w_a x A_a s_a - w_b x A_b s_b

R_ab, s_a and s_b are those of the zero posture, where the cards of the bodies have them; Q is the
rotation of b against a and w_Q its angular velocity, both in axes of a. A link whose b is in place
moves a in the same way. Consequence to test: joints close to round-off.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crashsolve.deck.building import Jointed, Scene

Array = np.ndarray


@dataclass(frozen=True)
class Link:
    """A joint of a chain in the zero posture; arms from the mass centres, in axes of a and of b."""

    joint: str
    a: int
    b: int
    s_a: Array
    s_b: Array
    R_ab: Array
    axis: Array | None  # of its rotation, axes of a; None where it turns about any


class Motion(NamedTuple):
    """Rotation, mass centre, its velocity and the angular velocity of a body, in world axes."""

    A: Array
    x: Array
    v: Array
    w: Array


def link(scene: Scene, joint: str, card: Jointed) -> Link:
    """A joint of the scene as a link of a chain, from where its bodies are now."""
    a, b, point = scene.joint_point(card)
    A_a, A_b = scene.matrix(a), scene.matrix(b)
    axis = None
    if hasattr(card, "axis"):
        axis = A_a.T @ scene.matrix(scene.node(card.frame)) @ scene.unit(card.axis, "axis")
    s_a, s_b = A_a.T @ (point - scene.r[a]), A_b.T @ (point - scene.r[b])
    return Link(joint, a, b, s_a, s_b, A_a.T @ A_b, axis)


def next_body(one: Link, Q: Array, w_Q: Array, placed: dict[int, Motion]) -> None:
    """Place the body of a link whose other body is in place. Writes: placed."""
    if one.a in placed:
        A_a, x, v, w = placed[one.a]
        A_b, w_b = A_a @ Q @ one.R_ab, w + A_a @ w_Q
        arm_a, arm_b = A_a @ one.s_a, A_b @ one.s_b
        v_b = v + np.cross(w, arm_a) - np.cross(w_b, arm_b)
        placed[one.b] = Motion(A_b, x + arm_a - arm_b, v_b, w_b)
        return
    A_b, x, v, w = placed[one.b]
    A_a = A_b @ (Q @ one.R_ab).T
    w_a = w - A_a @ w_Q
    arm_a, arm_b = A_a @ one.s_a, A_b @ one.s_b
    v_a = v + np.cross(w, arm_b) - np.cross(w_a, arm_a)
    placed[one.a] = Motion(A_a, x + arm_b - arm_a, v_a, w_a)


def in_order(root: int, links: Sequence[Link]) -> tuple[list[Link], list[Link]]:
    """Links in an order in which each hangs on those before, and the ones left over."""
    order: list[Link] = []
    known, waiting = {root}, list(links)
    while ready := [one for one in waiting if (one.a in known) != (one.b in known)]:
        order.append(ready[0])
        known |= {ready[0].a, ready[0].b}
        waiting.remove(ready[0])
    return order, waiting
