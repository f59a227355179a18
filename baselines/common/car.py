"""The direction in which a car begins its way to a point."""

import math

from benchnav.arrays import FloatArray
from benchnav.geometry import cos_sin
from benchnav.kernels import kernel

from .motion_limits import BACKWARDS, curvature

WELL_OUTSIDE = 1.2  # of the radius: a car drives backwards until the target is this far outside

WIDEST = 1.2  # [rad] from its front: the farthest direction that a car is sent to
BACK_TURN = 0.5  # [rad] by which a car that drives backwards turns its front to the target


@kernel
def car_direction(
    limits: FloatArray, x: float, y: float, heading: float, speed: float, tx: float, ty: float,
    widest: float,
) -> tuple[bool, float]:  # fmt: skip
    """Return (backwards, direction [rad] in the world in which a car begins its way to (tx, ty)).

    It is the target's direction if it lies within ``widest`` [rad] of the car's front, and
    otherwise the nearest that does. A target inside one of the two smallest circles on which the
    car can drive is left behind first: straight ahead, or, if the car can, backwards with its
    front turning to it. ``speed`` [m/s] is the current one, < 0 backwards.
    """
    c, s = cos_sin(heading)
    dx, dy = tx - x, ty - y
    ahead, aside = c * dx + s * dy, c * dy - s * dx
    r = 1.0 / curvature(limits)
    can_reverse = limits[BACKWARDS] > 0.0
    away = math.sqrt(ahead * ahead + (abs(aside) - r) ** 2)
    if can_reverse:
        circle = WELL_OUTSIDE * r if speed < 0.0 else r
        behind = ahead < 0.0 and ahead * ahead + aside * aside < 4.0 * r * r
        if away < circle or behind:
            return True, heading + math.pi + math.copysign(min(widest, BACK_TURN), aside)
    elif away < r:
        return False, heading
    angle = math.atan2(aside, ahead)
    return False, heading + min(max(angle, -widest), widest)


@kernel
def car_target(
    limits: FloatArray, x: float, y: float, heading: float, speed: float, tx: float, ty: float,
    backing: bool,
) -> tuple[bool, float, float]:  # fmt: skip
    """Return (replaced, x, y [m] of a target that a car can drive to directly).

    It is (tx, ty) if it can. Otherwise it lies in the direction in which the car begins its way,
    so that a search over a short time does not prefer to stand; behind the car if it is
    ``backing``.
    """
    backwards, direction = car_direction(limits, x, y, heading, speed, tx, ty, WIDEST)
    c, s = cos_sin(heading)
    ahead, aside = c * (tx - x) + s * (ty - y), c * (ty - y) - s * (tx - x)
    r = 1.0 / curvature(limits)
    if backing:
        backwards, direction = True, heading + math.pi + math.copysign(BACK_TURN, aside)
    inside = ahead * ahead + (abs(aside) - r) ** 2 < r * r
    if not backwards and not inside and abs(math.atan2(aside, ahead)) <= WIDEST:
        return False, tx, ty
    distance = max(math.sqrt(ahead * ahead + aside * aside), 2.0 * r)
    c, s = cos_sin(direction)
    return True, x + distance * c, y + distance * s
