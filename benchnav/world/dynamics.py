"""The motion of a body that follows from a command."""

import math

from benchnav.geometry.rotation import angle_of, cos_sin
from benchnav.kernels import kernel_without_allocation


@kernel_without_allocation
def limited(
    c0: float, c1: float, twist: bool, nonholonomic: bool, heading: float,
    max_speed: float, max_turn_rate: float, dt: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the command within limits of speed and turn rate.

    It is returned as a twist if it is a twist or the body is ``nonholonomic``, a unicycle. A
    unicycle tracks a planar velocity u by one law: turn towards u at the
    rate that would face it at the end of the step, within the limit, and drive at
    |u| cos(error), but never backwards. A holonomic body follows a twist as a unicycle
    does.
    """
    if nonholonomic or twist:
        v, w = c0, c1
        if not twist:
            c, s = cos_sin(heading)
            ahead, aside = c * c0 + s * c1, c * c1 - s * c0
            v, w = max(0.0, ahead), angle_of(ahead, aside) / dt
        return min(max(v, 0.0), max_speed), min(max(w, -max_turn_rate), max_turn_rate)
    speed2 = c0 * c0 + c1 * c1
    if speed2 > max_speed * max_speed:
        scale = max_speed / math.sqrt(speed2)
        return c0 * scale, c1 * scale
    return c0, c1


@kernel_without_allocation
def planar_velocity(
    d0: float, d1: float, turning: bool, heading: float, h: float
) -> tuple[float, float]:
    """Return the velocity [m/s] in a substep: a twist's arc is driven along its mid-heading."""
    if not turning:
        return d0, d1
    c, s = cos_sin(heading + 0.5 * d1 * h)
    return d0 * c, d0 * s
