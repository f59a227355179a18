"""Commands within the limits of bodies that accelerate, and of drives with wheels.

The limits of a decision hold against the command that was executed in the decision before; a
contact changes the motion of a body, but not its command, as wheels slip. A body starts at rest
with its wheels straight.
"""

import math
from typing import Any

import numpy as np

from benchnav.arena.agents import Agents, Dynamics
from benchnav.arrays import AnyArray
from benchnav.geometry.rotation import angle_of, cos_sin
from benchnav.kernels import kernel_without_allocation
from benchnav.world.dynamics import limited
from benchnav.world.records import LIMITS

_HOLONOMIC, _ACKERMANN = int(Dynamics.HOLONOMIC), int(Dynamics.ACKERMANN)
_SAME_NAME = (
    "max_speed", "max_turn_rate", "max_acceleration", "max_deceleration", "max_turn_acceleration",
    "max_wheel_speed", "wheelbase", "max_steering_angle", "max_steering_rate", "dynamics",
    "reverse",
)  # fmt: skip


def limit_records(agents: Agents) -> AnyArray:
    """Return LIMITS records (A,) of agents that have not started."""
    records = np.zeros(len(agents), LIMITS)
    for name in _SAME_NAME:
        records[name] = getattr(agents, name)
    records["half_track"] = 0.5 * agents.track_width
    return records


@kernel_without_allocation
def within_limits(
    c0: float, c1: float, twist: bool, heading: float, d0: float, d1: float, body: Any, dt: float
) -> tuple[float, float]:
    """Return the command within all limits: a planar velocity, or a twist if the body turns.

    (c0, c1) is requested: a planar velocity [m/s] or a twist [m/s, rad/s], of one kind in all
    decisions of an episode. (d0, d1) was executed in the decision before, dt [s] ago. ``body`` is
    a LIMITS record; its steering angle is updated.
    """
    if body.dynamics == _HOLONOMIC and not twist:
        t0, t1 = limited(c0, c1, False, False, heading, body.max_speed, body.max_turn_rate, dt)
        return approached(d0, d1, t0, t1, body.max_acceleration, body.max_deceleration, dt)
    v, w = (c0, c1) if twist else twist_towards(c0, c1, heading, body, dt)
    if not body.reverse:
        v = max(v, 0.0)
    if body.dynamics == _ACKERMANN:
        return _steered(v, w, d0, body, dt)
    return _wheeled(v, w, d0, d1, body, dt)


@kernel_without_allocation
def approached(
    d0: float, d1: float, t0: float, t1: float, acceleration: float, deceleration: float, dt: float
) -> tuple[float, float]:
    """Return the velocity that is reached from (d0, d1) within dt on the way to (t0, t1).

    The velocity moves straight to its target: at ``deceleration`` [m/s²] while the speed falls,
    then at ``acceleration`` [m/s²].
    """
    e0, e1 = t0 - d0, t1 - d1
    length = math.sqrt(e0 * e0 + e1 * e1)
    if length == 0.0:
        return t0, t1
    falling = min(max(-(d0 * e0 + d1 * e1) / length, 0.0), length)  # until nearest to zero
    if falling > deceleration * dt:
        way = deceleration * dt
    else:
        rest = dt - falling / deceleration
        way = falling + (acceleration * rest if rest > 0.0 else 0.0)
    if way >= length:
        return t0, t1
    return d0 + e0 * (way / length), d1 + e1 * (way / length)


@kernel_without_allocation
def twist_towards(
    c0: float, c1: float, heading: float, body: Any, dt: float
) -> tuple[float, float]:
    """Return the twist by which a body tracks the planar velocity u = (c0, c1).

    It turns its front towards u and drives at |u| cos(error); with `reverse`, it turns its rear
    where that is nearer. Ackermann drives at |u| / 2 at least, because it cannot turn on the spot.
    """
    c, s = cos_sin(heading)
    ahead, aside = c * c0 + s * c1, c * c1 - s * c0
    backwards = body.reverse and ahead < 0.0
    if backwards:
        ahead, aside = -ahead, -aside
    v, turn_acceleration = max(0.0, ahead), body.max_turn_acceleration
    if body.dynamics == _ACKERMANN:
        v = max(v, 0.5 * math.sqrt(ahead * ahead + aside * aside))
        # the slowest change of the turn rate at this speed: d tan(angle) ≥ d angle
        turn_acceleration = min(v, body.max_speed) * body.max_steering_rate / body.wheelbase
    w = _turn_rate(angle_of(ahead, aside), turn_acceleration, dt)
    return (-v if backwards else v), w


@kernel_without_allocation
def _turn_rate(error: float, turn_acceleration: float, dt: float) -> float:
    """Return the fastest rate [rad/s] from which the turn can still end after ``error`` [rad].

    A rate w that falls by α dt in each decision turns by w²/(2α) + w dt/2. Without a limit
    the turn ends with this decision.
    """
    if error == 0.0 or turn_acceleration <= 0.0:
        return 0.0
    size, half = abs(error), 0.5 * dt
    stoppable = 2.0 * size / (half + math.sqrt(half * half + 2.0 * size / turn_acceleration))
    return math.copysign(min(size / dt, stoppable), error)


@kernel_without_allocation
def _wheeled(v: float, w: float, d0: float, d1: float, body: Any, dt: float) -> tuple[float, float]:
    """Return the twist of a unicycle or differential drive (without wheels, none limits it).

    The wheels' speeds are v ± w · track_width / 2. A command that needs more is scaled down on
    its curve, as `DifferentialDriveWheelSpeeds.desaturate` of WPILib does. If the limits of
    acceleration would make one of speed and turn rate get ahead of the other, to a pair that the
    wheels cannot make, it waits for the other. (The waiting is this project's choice.)
    """
    v = min(max(v, -body.max_speed), body.max_speed)
    w = min(max(w, -body.max_turn_rate), body.max_turn_rate)
    half, top = body.half_track, body.max_wheel_speed
    wheel = abs(v) + abs(w) * half
    if wheel > top:
        v, w = v * (top / wheel), w * (top / wheel)
    wanted_v, wanted_w, change = v, w, body.max_turn_acceleration * dt
    v, _ = approached(d0, 0.0, v, 0.0, body.max_acceleration, body.max_deceleration, dt)
    w = min(max(w, d1 - change), d1 + change)
    if abs(v) + abs(w) * half > top:
        if abs(v - d0) * abs(wanted_w - d1) > abs(w - d1) * abs(wanted_v - d0):
            v = math.copysign(max(top - abs(w) * half, 0.0), v)
        else:
            w = math.copysign(max(top - abs(v), 0.0) / half, w)
    return v, w


@kernel_without_allocation
def _steered(v: float, w: float, d0: float, body: Any, dt: float) -> tuple[float, float]:
    """Return the twist of an Ackermann body, and turn its steering angle.

    The kinematic bicycle: w = v tan(angle) / wheelbase at the middle of the rear axle. The
    curvature of a command is kept, and a faster turn than `max_turn_rate` lowers the speed. At
    v = 0, the steering angle turns to the side of w, and stays if w is 0.
    """
    before, size, side = body.steering, abs(v), -w if v < 0.0 else w
    wanted = before if v == 0.0 and w == 0.0 else angle_of(size, body.wheelbase * side)
    wanted = min(max(wanted, -body.max_steering_angle), body.max_steering_angle)
    curvature = _curvature(wanted, body.wheelbase)
    top = min(body.max_speed, _per(body.max_turn_rate, abs(curvature)))
    v = min(max(v, -top), top)
    v, _ = approached(d0, 0.0, v, 0.0, body.max_acceleration, body.max_deceleration, dt)
    change = body.max_steering_rate * dt
    angle = min(max(wanted, before - change), before + change)
    if angle != wanted:
        curvature = _curvature(angle, body.wheelbase)
    if abs(v * curvature) > body.max_turn_rate:
        # the speed would rise too early, or fall too late: first the angle waits, then the speed
        least = abs(before) if before * angle > 0.0 else 0.0
        most = max(angle_of(abs(v), body.wheelbase * body.max_turn_rate), least)
        angle = math.copysign(min(abs(angle), most), angle)
        curvature = _curvature(angle, body.wheelbase)
        top = _per(body.max_turn_rate, abs(curvature))
        v = min(max(v, -top), top)
    body.steering = angle
    return v, min(max(v * curvature, -body.max_turn_rate), body.max_turn_rate)


@kernel_without_allocation
def _curvature(angle: float, wheelbase: float) -> float:
    """Return the curvature [1/m] of the way at a steering angle [rad] below a right angle."""
    c, s = cos_sin(angle)
    return s / c / wheelbase


@kernel_without_allocation
def _per(turn_rate: float, curvature: float) -> float:
    """Return the speed at which the turn rate is reached."""
    return turn_rate / curvature if curvature > 0.0 else math.inf
