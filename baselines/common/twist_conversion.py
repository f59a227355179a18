"""Twists converted to planar velocities, for navigators that must give one kind of command."""

from benchnav.arrays import BoolArray, FloatArray
from benchnav.geometry import cos_sin
from benchnav.kernels import kernel

MAX_TURN = 1.5  # [rad] largest turn of a unicycle in a step: it never drives backwards
CREEP = 1e-9  # [m/s] speed of a turn on the spot: a velocity of 0 has no direction


@kernel
def as_velocity(
    active: BoolArray, unicycle: BoolArray, heading: FloatArray, dt: FloatArray,
    twist: FloatArray, velocity: FloatArray,
) -> None:  # fmt: skip
    """Write the velocities that make bodies turn and drive as twists do.

    A unicycle tracks a velocity u by turning towards it within the step and driving at
    |u| cos(turn) (`benchnav.world.dynamics`), so its twists are executed to rounding; a
    holonomic body drives straight in its heading at the end of the step.

    Args:
        active: (B, A) agents whose velocities are written.
        unicycle: (B, A) whether each body is a unicycle.
        heading: (B, A) [rad].
        dt: (B, A) [s] between decisions.
        twist: (B, A, 2) forward speed [m/s] and turn rate [rad/s].
        velocity: (B, A, 2) [m/s].
    """
    for b in range(active.shape[0]):
        for a in range(active.shape[1]):
            if not active[b, a]:
                continue
            turn = min(max(twist[b, a, 1] * dt[b, a], -MAX_TURN), MAX_TURN)
            speed = max(twist[b, a, 0], CREEP)
            if unicycle[b, a]:
                speed /= cos_sin(turn)[0]
            c, s = cos_sin(heading[b, a] + turn)
            velocity[b, a, 0], velocity[b, a, 1] = speed * c, speed * s
