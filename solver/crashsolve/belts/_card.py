"""Cards of belts: the route, and the retractor at its beginning."""

from typing import ClassVar

from pydantic import model_validator

from crashsolve.deck.card import BodyName, Card, CurveName, Vec3, quantity, word

MOST = 8  # points of a route


class RoutePoint(Card):
    """Where a belt is fixed to a body, or runs through a ring on it."""

    body: BodyName = word("body", default="ground")
    at: Vec3 = quantity("m", "position, in its frame", default=(0.0, 0.0, 0.0))
    ring: float | None = quantity(
        "1", "mu, where the belt slips through a ring; fixed when absent", default=None, ge=0
    )


class Retractor(Card):
    """Spool at the first point of the route: pulls, locks, limits the load, tightens."""

    curve_axes: ClassVar = {"limit": ("m", "N"), "pretensioner": ("m", "N")}

    pull: float = quantity("N", "of its spring, until it locks", gt=0)
    lock_time: float | None = quantity("s", "when it locks", default=None, ge=0)
    lock_speed: float | None = quantity("m/s", "pay-out rate at which it locks", default=None, gt=0)
    limit: CurveName | None = word(
        "load limiter: force over pay-out since it locked, from 0", default=None
    )
    pretensioner: CurveName | None = word(
        "force over pull-in, from 0; what is pulled in stays in", default=None
    )
    fire_time: float | None = quantity("s", "when the pretensioner fires", default=None, ge=0)

    @model_validator(mode="after")
    def _consistent(self) -> "Retractor":
        if (self.pretensioner is None) != (self.fire_time is None):
            raise ValueError("pretensioner and fire_time belong together")
        locks = (self.lock_time, self.lock_speed, self.fire_time) != (None, None, None)
        if self.limit is not None and not locks:
            raise ValueError("limit: needs lock_time, lock_speed or fire_time before it acts")
        return self
