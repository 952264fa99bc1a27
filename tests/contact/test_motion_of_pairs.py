"""How far a point of one body moves at most, seen from another: what lets a pair apart alone."""

from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from crashsolve.system.contact.resting import largest_approach, record_motion


def body(rng: np.random.Generator, speed: float, spin: float) -> SimpleNamespace:
    """A body that has moved and rotationed at random."""
    start_q, rotation = (
        Rotation.random(random_state=rng),
        Rotation.from_rotvec(rng.normal(size=3) * spin),
    )
    start = rng.normal(size=3)
    end_q = rotation * start_q
    return SimpleNamespace(
        start_r=start,
        r=start + rng.normal(size=3) * speed,
        start_q=np.roll(start_q.as_quat(), 1),
        q=np.roll(end_q.as_quat(), 1),
        rotations=(start_q, end_q),
        moved=np.zeros(3),
        has_surface=1,
        rotated=np.zeros(3),
    )


def seen_from(b: SimpleNamespace, end: int, x: np.ndarray) -> np.ndarray:
    """Positions in the axes of body b, at the start (0) or the end (1) of the step."""
    return b.rotations[end].inv().apply(x - (b.start_r, b.r)[end])


def test_no_point_moves_farther_than_the_bound_says() -> None:
    """Of 2000 motions of two bodies, of any size; the bound is within 2 % of small ones."""
    rng = np.random.default_rng(3)
    shares = []
    for _ in range(2000):
        size = 10.0 ** rng.uniform(-5.0, 0.0)
        a, b = body(rng, size, size), body(rng, 10.0 * size, size)
        record_motion(np.array([a, a, b], object))
        reach = rng.uniform(0.0, 2.0)
        p = SimpleNamespace(reach_a=reach, reach_b=reach + 1.0)
        points = rng.normal(size=(500, 3))
        points *= reach / np.linalg.norm(points, axis=1)[:, None]
        ends = [of.apply(points) + r for of, r in zip(a.rotations, (a.start_r, a.r), strict=True)]
        moved = [seen_from(b, end, x) for end, x in enumerate(ends)]
        farthest = float(np.linalg.norm(moved[1] - moved[0], axis=1).max())
        bound = largest_approach(p, a, b)
        # round-off of positions
        assert farthest <= bound + 1e-14
        if size < 1e-3:
            shares.append(farthest / bound)
    # a point of the sphere is close to where travel and rotation add up only now and then
    assert max(shares) > 0.98


def test_what_two_bodies_have_in_common_is_no_approach() -> None:
    """Both translated and rotationed about one point: a vehicle and what is carried along in it."""
    rotation = Rotation.from_rotvec([0.0, 0.0, 1e-4])
    bodies = []
    for start in (np.array([1.0, 0.0, 0.0]), np.array([-2.0, 1.0, 0.5])):
        bodies.append(
            SimpleNamespace(
                start_r=start,
                r=rotation.apply(start) + np.array([0.01, 0.0, 0.0]),
                start_q=np.array([1.0, 0.0, 0.0, 0.0]),
                q=np.roll(rotation.as_quat(), 1),
                moved=np.zeros(3),
                has_surface=1,
                rotated=np.zeros(3),
            )
        )
    a, b = bodies
    record_motion(np.array([a, a, b], object))
    # of 10 mm that both move, squares of the angle are left: 1e-8 times some metres
    assert largest_approach(SimpleNamespace(reach_a=0.3, reach_b=3.0), a, b) < 1e-7
