"""The twists that a body can execute next, for kernels that steer within its dynamics.

The current twist (v0, w0) is the executed one; a car also has the steering angle of its front
wheels, which it keeps while it stands. See `benchnav.world.dynamics` for the motion.
"""

import math

import numpy as np

from benchnav.arena import Dynamics
from benchnav.arrays import BoolArray, FloatArray
from benchnav.kernels import kernel
from benchnav.navigation import Briefing

# columns of a body's limits
KIND = 0  # Dynamics
TOP = 1  # [m/s] largest speed
TURN = 2  # [rad/s] largest turn rate
SPEED_UP = 3  # [m/s²]
BRAKE = 4  # [m/s²]
TURN_UP = 5  # [rad/s²]
TRACK = 6  # [m] half of the distance between the wheels
WHEEL = 7  # [m/s] largest speed of a wheel
BASE = 8  # [m] between the axles
STEER = 9  # [rad] largest steering angle
STEER_RATE = 10  # [rad/s]
BACKWARDS = 11  # 1 if it can drive backwards
STEP = 12  # [s] between decisions
LIMITS = 13

_WHEELS = float(Dynamics.DIFFERENTIAL_DRIVE)
_CAR = float(Dynamics.ACKERMANN)
_HOLONOMIC = float(Dynamics.HOLONOMIC)


def limits_of(briefing: Briefing) -> FloatArray:
    """Return the limits (A, 13), in the columns of this module."""
    limits = np.empty((len(briefing), LIMITS))
    limits[:, KIND] = briefing.dynamics
    limits[:, TOP] = briefing.max_speed
    limits[:, TURN] = briefing.max_turn_rate
    limits[:, SPEED_UP] = briefing.max_acceleration
    limits[:, BRAKE] = briefing.max_deceleration
    limits[:, TURN_UP] = briefing.max_turn_acceleration
    limits[:, TRACK] = 0.5 * briefing.track_width
    limits[:, WHEEL] = briefing.max_wheel_speed
    limits[:, BASE] = briefing.wheelbase
    limits[:, STEER] = briefing.max_steering_angle
    limits[:, STEER_RATE] = briefing.max_steering_rate
    limits[:, BACKWARDS] = briefing.reverse
    limits[:, STEP] = briefing.dt
    return limits


def has_limits(limits: FloatArray) -> BoolArray:
    """Whether bodies (…, 13) have more limits than speed and turn rate, (…)."""
    limited: BoolArray = (
        (limits[..., KIND] > float(Dynamics.UNICYCLE))
        | np.isfinite(limits[..., SPEED_UP : TURN_UP + 1]).any(axis=-1)
        | (limits[..., BACKWARDS] > 0.0)
    )
    return limited


@kernel
def curvature(limits: FloatArray) -> float:
    """Return the largest curvature [1/m] of a car's path."""
    most: float = math.tan(limits[STEER]) / limits[BASE]
    return most


@kernel
def top_speed(limits: FloatArray) -> float:
    """Return the largest speed [m/s] straight ahead."""
    top: float = min(limits[TOP], limits[WHEEL])
    return top


@kernel
def speed_window(limits: FloatArray, v0: float, w0: float, dt: float) -> tuple[float, float]:
    """Return the lowest and the highest speed [m/s] that a body reaches within ``dt`` [s].

    A body that reverses its direction stops in between. Wheels that must still turn the body leave
    less speed.
    """
    top = top_speed(limits)
    if limits[KIND] == _WHEELS:
        turning = max(abs(w0) - limits[TURN_UP] * dt, 0.0)
        top = min(top, max(limits[WHEEL] - limits[TRACK] * turning, 0.0))
    up, down = limits[SPEED_UP] * dt, limits[BRAKE] * dt
    if v0 > 0.0:
        low, high = max(v0 - down, 0.0), v0 + up
    elif v0 < 0.0:
        low, high = v0 - up, min(v0 + down, 0.0)
    else:
        low, high = -up, up
    bottom = -top if limits[BACKWARDS] > 0.0 else 0.0
    low, high = min(max(low, bottom), top), max(min(high, top), bottom)
    return low, high


@kernel
def turn_window(
    limits: FloatArray, w0: float, steering: float, v: float, dt: float
) -> tuple[float, float]:
    """Return the lowest and the highest turn rate [rad/s] at speed v that a body reaches in dt.

    ``steering`` [rad] is the angle of a car's front wheels.
    """
    low, high = -limits[TURN], limits[TURN]
    if limits[KIND] == _CAR:
        change = limits[STEER_RATE] * dt
        first = max(steering - change, -limits[STEER])
        last = min(steering + change, limits[STEER])
        one, other = v * math.tan(first) / limits[BASE], v * math.tan(last) / limits[BASE]
        return _within(min(one, other), max(one, other), low, high)
    if limits[KIND] == _WHEELS:
        spare = max(limits[WHEEL] - abs(v), 0.0) / limits[TRACK]
        low, high = max(low, -spare), min(high, spare)
    change = limits[TURN_UP] * dt
    return _within(w0 - change, w0 + change, low, high)


@kernel
def _within(first: float, last: float, low: float, high: float) -> tuple[float, float]:
    """Return the part of first … last within low … high, or the nearest limit."""
    return min(max(first, low), high), max(min(last, high), low)


@kernel
def reached(
    limits: FloatArray, v0: float, w0: float, steering: float, v: float, w: float, dt: float
) -> tuple[float, float]:
    """Return the twist nearest to (v, w) that a body reaches within ``dt`` [s], speed first."""
    low, high = speed_window(limits, v0, w0, dt)
    v = min(max(v, low), high)
    low, high = turn_window(limits, w0, steering, v, dt)
    return v, min(max(w, low), high)


@kernel
def reach_in_turn(
    plan: FloatArray, v0: float, w0: float, steering: float, limits: FloatArray, dt: float,
    tick: float,
) -> None:  # fmt: skip
    """Change the twists of a plan (H, 2) to the nearest that a body reaches one after another.

    The first must be reached within ``dt`` [s], each other one within ``tick`` [s].
    """
    for t in range(len(plan)):
        time = dt if t == 0 else tick
        v0, w0 = reached(limits, v0, w0, steering, plan[t, 0], plan[t, 1], time)
        steering = steered(limits, v0, w0, steering)
        plan[t, 0], plan[t, 1] = v0, w0


@kernel
def steered(limits: FloatArray, v: float, w: float, steering: float) -> float:
    """Return the steering angle [rad] of a car that drives (v, w); it keeps it while it stands."""
    if limits[KIND] != _CAR or v == 0.0:
        return steering
    return math.atan(w * limits[BASE] / v)


def steering_after(twist: FloatArray, steering: FloatArray, limits: FloatArray) -> FloatArray:
    """Return the `steered` angles (…) [rad] of bodies (…, 13) that drive twists (…, 2)."""
    v, w = twist[..., 0], twist[..., 1]
    turned = (limits[..., KIND] == _CAR) & (v != 0.0)
    ratio = np.divide(w * limits[..., BASE], v, out=np.zeros_like(v), where=turned)
    return np.where(turned, np.arctan(ratio), steering)


@kernel
def stopping_speed(way: float, brake: float, dt: float) -> float:
    """Return the largest speed [m/s] for a step from which a body stops within ``way`` [m].

    It keeps the speed for ``dt`` [s] and then brakes at ``brake`` [m/s²]: v dt + v² / 2 brake.
    """
    if way <= 0.0:
        return 0.0
    if math.isinf(brake):
        return way / dt if dt > 0.0 else math.inf
    lost = brake * dt
    return math.sqrt(lost * lost + 2.0 * brake * way) - lost
