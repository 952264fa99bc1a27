"""Moment over angle as yield moment over plastic angle, the history variable of a hinge.

    M(theta) of the deck, with the elastic stiffness k:   y(x) = M(theta),   x = theta - M / k

Points on the elastic line all have x = 0, so y begins at the first yield Y_0. x grows with theta
wherever the curve rises less steeply than k, however steeply it falls: every M(theta) that a test
can show has one y(x), whose slope is above -k, and the hinge one answer. Straight pieces stay
straight; curved ones are followed by chords.
"""

from dataclasses import dataclass

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.foundation.curve import LINEAR, Pieces

# slopes that differ by less than this share are the same
SAME = 1e-9
# a curved piece is cut into so many chords: they err by its bend over 8 CHORDS^2
CHORDS = 64
# share of its largest moment to which a curve of an ellipse may fall
LEAST = 1e-3


@dataclass
class Backbone:
    """Yield moments y over plastic angles x, the first of them, and the elastic stiffness."""

    stiffness: float
    x: np.ndarray
    y: np.ndarray
    beyond: int
    limit: float
    name: str = ""

    def curve(self) -> tuple[np.ndarray, np.ndarray, int]:
        """Breakpoints, coefficients and the code of extrapolation, as all curves have them."""
        slope = np.diff(self.y) / np.diff(self.x)
        zero = np.zeros_like(slope)
        return self.x, np.stack([self.y[:-1], slope, zero, zero], axis=1), self.beyond


def backbone(points: Pieces, stiffness: float | None, word: str, scene: Scene) -> Backbone:
    """The backbone of a curve M(theta); `stiffness` None takes its first slope."""
    angle, moment = _chords(points)
    if angle[0] != 0.0 or moment[0] != 0.0:
        raise scene.fail(
            f"must begin at [0, 0], not at [{angle[0]:.4g}, {moment[0]:.4g}]: an undeformed hinge "
            "has no moment; a rigid-plastic one is given by a steep first piece",
            word,
        )
    slopes = np.diff(moment) / np.diff(angle)
    k = float(slopes[0]) if stiffness is None else stiffness
    if not slopes[0] > 0.0:
        raise scene.fail("must rise from 0; it opposes the deformation", word)
    if moment.min() < 0.0:
        raise scene.fail(
            f"must not fall below 0, as it does at {angle[moment.argmin()]:.4g}: it would drive "
            "the hinge on",
            word,
        )
    worst = int(slopes.argmax())
    if slopes[worst] > k * (1.0 + SAME):
        raise scene.fail(
            f"rises by {slopes[worst]:.6g} from {angle[worst]:.4g} on, more steeply than the "
            f"elastic stiffness {k:.6g}; give a stiffness not below the steepest slope",
            word,
        )
    if points[2] == LINEAR and slopes[-1] < 0.0:
        raise scene.fail(
            "falls at its end, and would continue below 0; set extrapolate: hold, or end it level",
            word,
        )
    return _plastic(angle, moment, k, points[2], word, scene)


def _plastic(
    angle: np.ndarray, moment: np.ndarray, k: float, beyond: int, word: str, scene: Scene
) -> Backbone:
    """The backbone over the plastic angle."""
    slopes = np.diff(moment) / np.diff(angle)
    yields = np.flatnonzero(slopes < k * (1.0 - SAME))
    if not len(yields):
        raise scene.fail(
            "never yields: add the piece after first yield; a straight line alone is a spring", word
        )
    first = int(yields[0])
    if (slopes[first:] >= k * (1.0 - SAME)).any():
        raise scene.fail(
            f"rises with the elastic stiffness {k:.6g} again after its first yield; no plastic "
            "angle belongs to that piece: give a larger stiffness",
            word,
        )
    angle, moment = angle[first:], moment[first:]
    x = (angle - angle[0]) - (moment - moment[0]) / k
    return Backbone(k, x, moment, beyond, limit=float(moment[0]))


def over_plastic_work(by_angle: Backbone, word: str, scene: Scene) -> Backbone:
    """Squares of the yield moments over plastic work W: dW = y dx, so that y^2 stays straight."""
    least = float(by_angle.y.min() / by_angle.y.max())
    if least < LEAST:
        raise scene.fail(
            f"falls to {100.0 * least:.3g} % of its largest moment; an ellipse needs "
            f"{100.0 * LEAST:g} % of it, or it has no width: set interaction: uncoupled",
            word,
        )
    work = np.diff(by_angle.x) * 0.5 * (by_angle.y[1:] + by_angle.y[:-1])
    x = np.concatenate([[0.0], np.cumsum(work)])
    return Backbone(by_angle.stiffness, x, by_angle.y**2, by_angle.beyond, limit=by_angle.limit)


def refuse_kinematic(by_angle: Backbone, word: str, scene: Scene) -> None:
    """A range that moves needs a width, and a middle that moves along with the deformation."""
    if by_angle.limit <= 0.0:
        raise scene.fail(
            "yields from 0 on, so that its elastic range, which kinematic hardening moves, has "
            "no width; begin it with a piece of the elastic stiffness, or set cyclic: "
            "isotropic",
            word,
        )
    if (np.diff(by_angle.y) < 0.0).any():
        raise scene.fail(
            "falls, and kinematic hardening has no softening; set cyclic: isotropic or "
            "peak_oriented",
            word,
        )


def _chords(points: Pieces) -> tuple[np.ndarray, np.ndarray]:
    """Points of the curve; pieces that bend get more of them."""
    x, c, _ = points
    xs, ys = [x[:1]], [np.asarray(c[:1, 0])]
    for start, end, own in zip(x[:-1], x[1:], c, strict=True):
        count = CHORDS if own[2] or own[3] else 1
        s = (end - start) * np.arange(1, count + 1) / count
        xs.append(start + s)
        ys.append(own[0] + s * (own[1] + s * (own[2] + s * own[3])))
    xs[-1][-1] = x[-1]
    return np.concatenate(xs), np.concatenate(ys)
